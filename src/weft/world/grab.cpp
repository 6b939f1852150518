#include "weft/world/grab.h"

#include <algorithm>
#include <numeric>

namespace weft::engine {
namespace {

constexpr double kFollowRate = 30;  // of the spring with the whole cloth's mass, critically damped [1/s]

double longest_edge(const TriangleMesh& mesh, const Triangle& t) {
  const auto edge = [&](int a, int b) { return (mesh.positions[t[a]] - mesh.positions[t[b]]).norm(); };
  return std::max({edge(0, 1), edge(1, 2), edge(2, 0)});
}

}  // namespace

Grab make_grab(const ClothModel& model, const ClothState& state, int triangle, const Vec3& weights,
               double radius) {
  const TriangleMesh& rest = model.topology->mesh;
  const Triangle& t = rest.triangles.at(static_cast<std::size_t>(triangle));
  Vec3 center = Vec3::Zero(), point = Vec3::Zero();  // at rest, and now
  for (int corner = 0; corner < 3; ++corner) {
    center += weights[corner] * rest.positions[t[corner]];
    point += weights[corner] * state.position(t[corner]);
  }
  Grab grab;
  const double reach = std::max(radius, 1.5 * longest_edge(rest, t));
  for (int i = 0; i < model.num_particles(); ++i) {
    const double d = (rest.positions[i] - center).norm() / reach;
    if (d >= 1) continue;
    grab.particles.push_back(i);
    grab.shares.push_back((1 - d * d) * (1 - d * d));
    grab.offsets.push_back(state.position(i) - point);
  }
  const double sum = std::accumulate(grab.shares.begin(), grab.shares.end(), 0.0);
  for (double& share : grab.shares) share /= sum;
  const double mass = std::accumulate(model.mass.begin(), model.mass.end(), 0.0);
  grab.stiffness = mass * kFollowRate * kFollowRate;
  grab.damping = 2 * mass * kFollowRate;
  grab.target = point;
  return grab;
}

void Hands::fit(const std::shared_ptr<const ClothModel>& model, double step) {
  if (model_ && original_ == model && step_ == step) return;
  std::vector<double> added(model->mass.size(), 0.0);
  for (const Grab& grab : grabs_) {
    for (std::size_t p = 0; p < grab.particles.size(); ++p)
      added[grab.particles[p]] += grab.shares[p] * (step * grab.damping + step * step * grab.stiffness);
  }
  model_ = build_heavier_model(*model, added);
  held_.clear();
  for (int i = 0; i < model->num_particles(); ++i) {
    if (added[i] > 0) held_.push_back(i);
  }
  original_ = model;
  step_ = step;
}

const ClothModel& Hands::begin(const std::shared_ptr<const ClothModel>& model,
                               const std::vector<char>& is_pinned, const Vec3& gravity, double step,
                               ClothState& state) {
  if (grabs_.empty()) return *model;
  fit(model, step);
  // Existing momentum …
  for (const int i : held_) {
    if (is_pinned[i]) continue;
    const double share = model->mass[i] / model_->mass[i];
    state.v.set(i, share * (state.v.get(i) + step * gravity) - step * gravity);
  }
  // … and the contribution of each attachment.
  for (const Grab& grab : grabs_) {
    for (std::size_t p = 0; p < grab.particles.size(); ++p) {
      const int i = grab.particles[p];
      if (is_pinned[i]) continue;
      const Vec3 pull = grab.target + grab.offsets[p] - state.position(i);
      state.v.set(i, state.v.get(i) + step * grab.stiffness * grab.shares[p] / model_->mass[i] * pull);
    }
  }
  return *model_;
}

Vec3 Hands::impulse(const std::vector<char>& is_pinned, double step, const ClothState& state) const {
  Vec3 sum = Vec3::Zero();
  for (const Grab& grab : grabs_) {
    for (std::size_t p = 0; p < grab.particles.size(); ++p) {
      const int i = grab.particles[p];
      if (is_pinned[i]) continue;
      const Vec3 pull = grab.target + grab.offsets[p] - state.position(i);
      sum += step * grab.shares[p] * (grab.stiffness * pull - grab.damping * state.v.get(i));
    }
  }
  return sum;
}

}  // namespace weft::engine
