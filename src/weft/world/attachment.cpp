#include "weft/world/attachment.h"

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

Attachment make_attachment(const ClothModel& model, const ClothState& state, int triangle,
                           const Vec3& weights, double radius) {
  const TriangleMesh& rest = model.topology->mesh;
  const Triangle& t = rest.triangles.at(static_cast<std::size_t>(triangle));
  Vec3 center = Vec3::Zero(), point = Vec3::Zero();  // at rest, and now
  for (int corner = 0; corner < 3; ++corner) {
    center += weights[corner] * rest.positions[t[corner]];
    point += weights[corner] * state.position(t[corner]);
  }
  Attachment attachment;
  const double reach = std::max(radius, 1.5 * longest_edge(rest, t));
  for (int i = 0; i < model.num_particles(); ++i) {
    const double d = (rest.positions[i] - center).norm() / reach;
    if (d >= 1) continue;
    attachment.particles.push_back(i);
    attachment.shares.push_back((1 - d * d) * (1 - d * d));
    attachment.offsets.push_back(state.position(i) - point);
  }
  const double sum = std::accumulate(attachment.shares.begin(), attachment.shares.end(), 0.0);
  for (double& share : attachment.shares) share /= sum;
  const double mass = std::accumulate(model.mass.begin(), model.mass.end(), 0.0);
  attachment.stiffness = mass * kFollowRate * kFollowRate;
  attachment.damping = 2 * mass * kFollowRate;
  attachment.target = point;
  return attachment;
}

void Attachments::fit(const std::shared_ptr<const ClothModel>& model, double step) {
  if (model_ && original_ == model && step_ == step) return;
  std::vector<double> added(model->mass.size(), 0.0);
  for (const Attachment& attachment : attachments_) {
    for (std::size_t p = 0; p < attachment.particles.size(); ++p)
      added[attachment.particles[p]] +=
          attachment.shares[p] * (step * attachment.damping + step * step * attachment.stiffness);
  }
  model_ = build_heavier_model(*model, added);
  held_.clear();
  for (int i = 0; i < model->num_particles(); ++i) {
    if (added[i] > 0) held_.push_back(i);
  }
  original_ = model;
  step_ = step;
}

const ClothModel& Attachments::begin(const std::shared_ptr<const ClothModel>& model,
                                     const std::vector<char>& is_pinned, const Vec3& gravity, double step,
                                     ClothState& state) {
  if (attachments_.empty()) return *model;
  fit(model, step);
  // Existing momentum …
  for (const int i : held_) {
    if (is_pinned[i]) continue;
    const double share = model->mass[i] / model_->mass[i];
    state.v.set(i, share * (state.v.get(i) + step * gravity) - step * gravity);
  }
  // … and the contribution of each attachment.
  for (const Attachment& attachment : attachments_) {
    for (std::size_t p = 0; p < attachment.particles.size(); ++p) {
      const int i = attachment.particles[p];
      if (is_pinned[i]) continue;
      const Vec3 pull = attachment.target + attachment.offsets[p] - state.position(i);
      state.v.set(
          i, state.v.get(i) + step * attachment.stiffness * attachment.shares[p] / model_->mass[i] * pull);
    }
  }
  return *model_;
}

Vec3 Attachments::impulse(const std::vector<char>& is_pinned, double step, const ClothState& state) const {
  Vec3 sum = Vec3::Zero();
  for (const Attachment& attachment : attachments_) {
    for (std::size_t p = 0; p < attachment.particles.size(); ++p) {
      const int i = attachment.particles[p];
      if (is_pinned[i]) continue;
      const Vec3 pull = attachment.target + attachment.offsets[p] - state.position(i);
      sum +=
          step * attachment.shares[p] * (attachment.stiffness * pull - attachment.damping * state.v.get(i));
    }
  }
  return sum;
}

}  // namespace weft::engine
