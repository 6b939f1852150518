#include "weft/integrators/contact_preconditioner.h"

namespace weft::engine {
namespace {

/// Normals that differ by less than this from a particle's earlier normals are not stored separately [1].
constexpr double kNewDirection = 0.3;

}  // namespace

void ContactPreconditioner::clear() {
  for (const Held& h : held_) index_[h.at] = -1;
  held_.clear();
}

void ContactPreconditioner::add_normal(int at, const Vec3& normal, std::size_t size) {
  if (index_.size() != size) index_.assign(size, -1);
  if (index_[at] < 0) {
    index_[at] = static_cast<int>(held_.size());
    held_.push_back({.at = at});
  }
  Held& h = held_[index_[at]];
  Vec3 rest = normal;
  for (int n = 0; n < h.num_normals; ++n) rest -= rest.dot(h.normal[n]) * h.normal[n];
  const double length = rest.norm();
  if (h.num_normals == 3 || length < kNewDirection) return;
  h.normal[h.num_normals++] = rest / length;
}

void ContactPreconditioner::remove_normal_components(Vec3Array& field) const {
  for (const Held& h : held_) {
    Vec3 left = field.get(h.at);
    for (int n = 0; n < h.num_normals; ++n) left -= h.normal[n].dot(left) * h.normal[n];
    field.set(h.at, left);
  }
}

void ContactPreconditioner::add_slid(Vec3Array& z) const {
  const auto add = [&](float* sum, const float* more) {
    for (std::size_t i = 0; i < z.size(); ++i) sum[i] += more[i];
  };
  add(z.x(), slid_.x());
  add(z.y(), slid_.y());
  add(z.z(), slid_.z());
}

}  // namespace weft::engine
