/// The springs of any cloth, coloured greedily. Sixteen springs at a time are gathered, computed in parallel,
/// and scattered.

#include <algorithm>
#include <array>

#include "weft/integrators/xpbd_elements.h"
#include "weft/integrators/xpbd_projection.h"

namespace weft::engine {
namespace {

constexpr int kParticleGrain = 4096, kSpringGrain = 2048;  // per chunk of work

struct Ends {
  int i, j;
};

struct MeshPass {
  XpbdParticle* particles;
  const XpbdMotion* motion;
  const Ends* ends;
  const float *stiffness, *damping, *rest_length;
  float step;
  bool is_damped, is_projected;
};

/// W springs of one colour from the s-th on: vectors spring by spring, roots and quotients in SIMD.
template <int W, bool kDamped>
WEFT_ALWAYS_INLINE void project_springs(const MeshPass& pass, int s) {
  using V = Pack<W>;
  using Vector = Pack<4>;
  const auto dot = [](Vector a, Vector b)
                       WEFT_INLINE_LAMBDA { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; };
  Vector d[W], r[W];
  float length_sq[W], approach[W], inv_mass[W];
  for (int l = 0; l < W; ++l) {
    const Ends ends = pass.ends[s + l];
    const XpbdParticle &p = pass.particles[ends.i], &q = pass.particles[ends.j];
    const Vector moved = load<4>(q.c) - load<4>(p.c);
    d[l] = (load<4>(q.y) - load<4>(p.y)) + moved;
    length_sq[l] = dot(d[l], d[l]);
    inv_mass[l] = p.inv_mass() + q.inv_mass();
    if (!kDamped) continue;
    r[l] = (load<4>(pass.motion[ends.j].by) - load<4>(pass.motion[ends.i].by)) + moved;
    approach[l] = dot(d[l], r[l]);
  }
  const SpringPush<V> push = spring_push<kDamped, V>(
      pass.step * pass.step * load<W>(pass.stiffness + s), pass.step * load<W>(pass.damping + s),
      load<W>(pass.rest_length + s), pass.is_projected, load<W>(length_sq), kDamped ? load<W>(approach) : V{},
      load<W>(inv_mass));
  for (int l = 0; l < W; ++l) {
    const Ends ends = pass.ends[s + l];
    XpbdParticle &p = pass.particles[ends.i], &q = pass.particles[ends.j];
    Vector by = push.along_d[l] * d[l];
    if (kDamped) by += push.along_r[l] * r[l];
    store(p.c, load<4>(p.c) + p.inv_mass() * by);
    store(q.c, load<4>(q.c) - q.inv_mass() * by);
  }
}

template <int W, bool kDamped>
WEFT_ALWAYS_INLINE void project_range(const MeshPass& pass, int begin, int end) {
  int s = begin;
  for (; s + W <= end; s += W) project_springs<W, kDamped>(pass, s);
  for (; s < end; ++s) project_springs<1, kDamped>(pass, s);
}

template <int W>
WEFT_ALWAYS_INLINE void project_colour_body(const MeshPass& pass, int begin, int end) {
  if (pass.is_damped) return project_range<W, true>(pass, begin, end);
  project_range<W, false>(pass, begin, end);
}

WEFT_MULTIVERSION_PACKS(project_colour, (const MeshPass& pass, int begin, int end), (pass, begin, end))

class MeshProjection final : public ClothProjection {
 public:
  explicit MeshProjection(const ClothModel& model) : elements_(model) {
    const std::vector<Spring>& springs = model.topology->springs;
    springs_ = colour_items(static_cast<int>(springs.size()), model.num_particles(), [&](int s) {
      return std::array{springs[s].i, springs[s].j};
    });
    for (const int s : springs_.item) {
      ends_.push_back({springs[s].i, springs[s].j});
      rest_length_.push_back(static_cast<float>(springs[s].rest_length));
    }
    particles_.particle.resize(model.num_particles());
    particles_.motion.resize(model.num_particles());
  }

  void set_numbers(const ClothModel& model, const std::vector<int>& pinned) override {
    stiffness_.clear();
    damping_.clear();
    for (const int s : springs_.item) {
      stiffness_.push_back(static_cast<float>(model.stiffness(s)));
      damping_.push_back(static_cast<float>(model.damping(s)));
    }
    const auto is_set = [](float number) { return number > 0; };
    is_damped_ = std::any_of(damping_.begin(), damping_.end(), is_set);
    has_springs_ = is_damped_ || std::any_of(stiffness_.begin(), stiffness_.end(), is_set);
    for (int i = 0; i < particles_.size(); ++i)
      particles_.particle[i].inv_mass() = static_cast<float>(1 / model.mass[i]);
    for (const int i : pinned) particles_.particle[i].inv_mass() = 0;
    elements_.set_numbers(model);
  }

  void predict(const XpbdSubstep& substep, JobSystem& jobs, ClothState& state) override {
    const float* x[] = {state.x.x(), state.x.y(), state.x.z()};
    float* v[] = {state.v.x(), state.v.y(), state.v.z()};
    for_particles(jobs, [&](int i) {
      XpbdParticle& particle = particles_.particle[i];
      XpbdMotion& motion = particles_.motion[i];
      for (int c = 0; c < 3; ++c) {
        v[c][i] = substep.drag_factor * v[c][i] + substep.velocity_gain[c];
        motion.by[c] = substep.step * v[c][i];
        particle.y[c] = x[c][i] + motion.by[c];
      }
      std::fill_n(particle.c, 4, 0.0f);
    });
  }

  void move_to(int particle, const Vec3& y, const Vec3& motion) override {
    for (int c = 0; c < 3; ++c) {
      particles_.particle[particle].y[c] = static_cast<float>(y[c]);
      particles_.motion[particle].by[c] = static_cast<float>(motion[c]);
    }
  }

  void project(const XpbdSubstep& substep, JobSystem& jobs) override {
    if (has_springs_) project_colours(substep, jobs);
    elements_.project(substep, jobs, particles_);
  }

  void finish(const XpbdSubstep& substep, JobSystem& jobs, ClothState& state) override {
    float *x[] = {state.x.x(), state.x.y(), state.x.z()}, *v[] = {state.v.x(), state.v.y(), state.v.z()};
    const float rate = 1 / substep.step;
    for_particles(jobs, [&](int i) {
      for (int c = 0; c < 3; ++c) {
        v[c][i] += rate * particles_.particle[i].c[c];
        x[c][i] += substep.step * v[c][i];
      }
    });
  }

 private:
  void project_colours(const XpbdSubstep& substep, JobSystem& jobs) {
    const MeshPass pass{.particles = particles_.particle.data(),
                        .motion = particles_.motion.data(),
                        .ends = ends_.data(),
                        .stiffness = stiffness_.data(),
                        .damping = damping_.data(),
                        .rest_length = rest_length_.data(),
                        .step = substep.step,
                        .is_damped = is_damped_,
                        .is_projected = substep.is_projected};
    for (std::size_t colour = 0; colour + 1 < springs_.begin.size(); ++colour) {
      const int first = springs_.begin[colour], count = springs_.begin[colour + 1] - first;
      parallel_for(jobs, count, kSpringGrain,
                   [&](int begin, int end) { project_colour(pass, first + begin, first + end); });
    }
  }

  template <class Body>
  void for_particles(JobSystem& jobs, const Body& body) const {
    parallel_for(jobs, particles_.size(), kParticleGrain, [&](int begin, int end) {
      for (int i = begin; i < end; ++i) body(i);
    });
  }

  Colours springs_;
  std::vector<Ends> ends_;  // in the order of springs_.item, as all below
  std::vector<float> rest_length_, stiffness_, damping_;
  bool has_springs_ = false, is_damped_ = false;
  XpbdElements elements_;
  XpbdParticles particles_;
};

}  // namespace

std::unique_ptr<ClothProjection> make_mesh_projection(const ClothModel& model) {
  return std::make_unique<MeshProjection>(model);
}

}  // namespace weft::engine
