/// The springs of a mesh, coloured greedily: a colour takes every spring, in the mesh's order, that shares no
/// particle with one it has already. Sixteen springs at a time are gathered, computed side by side, and put
/// back.

#include <algorithm>
#include <limits>

#include "weft/integrators/xpbd_projection.h"

namespace weft {
namespace {

constexpr int kParticleGrain = 4096, kSpringGrain = 2048;  // per chunk of work

/// All that a spring needs to know of one end, in half a cache line.
struct alignas(32) Particle {
  float y[4] = {0, 0, 0, 0};  // the last one is 1/m
  float c[4] = {0, 0, 0, 0};  // the last one means nothing

  float& inv_mass() { return y[3]; }
};

struct alignas(16) Motion {
  float by[4] = {0, 0, 0, 0};
};

struct Ends {
  int i, j;
};

struct MeshPass {
  Particle* particles;
  const Motion* motion;
  const Ends* ends;
  const float *stiffness, *rest_length;
  float step, damping;
  bool is_projected;
};

/// W springs of one colour from the s-th on: vectors spring by spring, roots and quotients side by side.
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
    Particle &p = pass.particles[ends.i], &q = pass.particles[ends.j];
    const Vector moved = load<4>(q.c) - load<4>(p.c);
    d[l] = (load<4>(q.y) - load<4>(p.y)) + moved;
    length_sq[l] = dot(d[l], d[l]);
    inv_mass[l] = p.inv_mass() + q.inv_mass();
    if (!kDamped) continue;
    r[l] = (load<4>(pass.motion[ends.j].by) - load<4>(pass.motion[ends.i].by)) + moved;
    approach[l] = dot(d[l], r[l]);
  }
  const SpringPush<V> push = spring_push<kDamped, V>(
      pass.step * pass.step * load<W>(pass.stiffness + s), broadcast<W>(pass.step * pass.damping),
      load<W>(pass.rest_length + s), pass.is_projected, load<W>(length_sq), kDamped ? load<W>(approach) : V{},
      load<W>(inv_mass));
  for (int l = 0; l < W; ++l) {
    const Ends ends = pass.ends[s + l];
    Particle &p = pass.particles[ends.i], &q = pass.particles[ends.j];
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
  if (pass.damping > 0) return project_range<W, true>(pass, begin, end);
  project_range<W, false>(pass, begin, end);
}

WEFT_MULTIVERSION_PACKS(project_colour, (const MeshPass& pass, int begin, int end), (pass, begin, end))

/// Indices of the springs, colour by colour; `colour_begin` gets where each begins, and the end.
std::vector<int> sort_by_colour(const ClothTopology& topology, std::vector<int>& colour_begin) {
  std::vector<int> left(topology.springs.size()), sorted, last_colour(topology.num_particles(), -1);
  for (std::size_t s = 0; s < left.size(); ++s) left[s] = static_cast<int>(s);
  colour_begin = {0};
  for (int colour = 0; !left.empty(); ++colour) {
    const auto is_left = [&](int s) {
      const Spring& spring = topology.springs[s];
      if (last_colour[spring.i] == colour || last_colour[spring.j] == colour) return true;
      last_colour[spring.i] = last_colour[spring.j] = colour;
      sorted.push_back(s);
      return false;
    };
    left.erase(std::stable_partition(left.begin(), left.end(), is_left), left.end());
    colour_begin.push_back(static_cast<int>(sorted.size()));
  }
  return sorted;
}

class MeshProjection final : public SpringProjection {
 public:
  explicit MeshProjection(const ClothTopology& topology)
      : springs_(sort_by_colour(topology, colour_begin_)),
        particles_(topology.num_particles()),
        motion_(topology.num_particles()) {
    for (const int s : springs_) {
      const Spring& spring = topology.springs[s];
      ends_.push_back({spring.i, spring.j});
      rest_length_.push_back(static_cast<float>(spring.rest_length));
    }
  }

  void set_numbers(const ClothModel& model, const std::vector<int>& pinned) override {
    stiffness_.clear();
    for (const int s : springs_) stiffness_.push_back(static_cast<float>(model.stiffness(s)));
    for (std::size_t i = 0; i < particles_.size(); ++i)
      particles_[i].inv_mass() = static_cast<float>(1 / model.mass[i]);
    for (const int i : pinned) particles_[i].inv_mass() = 0;
  }

  void predict(const XpbdSubstep& substep, JobSystem& jobs, ClothState& state) override {
    const float* x[] = {state.x.x(), state.x.y(), state.x.z()};
    float* v[] = {state.v.x(), state.v.y(), state.v.z()};
    for_particles(jobs, [&](int i) {
      for (int c = 0; c < 3; ++c) {
        v[c][i] = substep.keep * v[c][i] + substep.gain[c];
        motion_[i].by[c] = substep.step * v[c][i];
        particles_[i].y[c] = x[c][i] + motion_[i].by[c];
      }
      std::fill_n(particles_[i].c, 4, 0.0f);
    });
  }

  void move_to(int particle, const Vec3& y, const Vec3& motion) override {
    for (int c = 0; c < 3; ++c) {
      particles_[particle].y[c] = static_cast<float>(y[c]);
      motion_[particle].by[c] = static_cast<float>(motion[c]);
    }
  }

  void project(const XpbdSubstep& substep, JobSystem& jobs) override {
    const MeshPass pass{particles_.data(),   motion_.data(), ends_.data(),    stiffness_.data(),
                        rest_length_.data(), substep.step,   substep.damping, substep.is_projected};
    for (std::size_t colour = 0; colour + 1 < colour_begin_.size(); ++colour) {
      const int first = colour_begin_[colour], count = colour_begin_[colour + 1] - first;
      parallel_for(jobs, count, kSpringGrain,
                   [&](int begin, int end) { project_colour(pass, first + begin, first + end); });
    }
  }

  void finish(const XpbdSubstep& substep, JobSystem& jobs, ClothState& state) override {
    float *x[] = {state.x.x(), state.x.y(), state.x.z()}, *v[] = {state.v.x(), state.v.y(), state.v.z()};
    const float rate = 1 / substep.step;
    for_particles(jobs, [&](int i) {
      for (int c = 0; c < 3; ++c) {
        v[c][i] += rate * particles_[i].c[c];
        x[c][i] += substep.step * v[c][i];
      }
    });
  }

 private:
  template <class Body>
  void for_particles(JobSystem& jobs, const Body& body) const {
    parallel_for(jobs, static_cast<int>(particles_.size()), kParticleGrain, [&](int begin, int end) {
      for (int i = begin; i < end; ++i) body(i);
    });
  }

  std::vector<int> colour_begin_;  // (colours + 1)
  std::vector<int> springs_;       // colour by colour
  std::vector<Ends> ends_;         // likewise, as all below
  std::vector<float> rest_length_, stiffness_;
  std::vector<Particle> particles_;
  std::vector<Motion> motion_;
};

}  // namespace

std::unique_ptr<SpringProjection> make_mesh_projection(const ClothTopology& topology) {
  return std::make_unique<MeshProjection>(topology);
}

}  // namespace weft
