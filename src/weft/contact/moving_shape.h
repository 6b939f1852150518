#pragma once
/// A collider during one step.

#include "weft/contact/collider.h"

namespace weft::engine {

struct MovingShape {
  const Collider* collider = nullptr;
  ColliderShape before, after;  // at the start and the end of the step
  Pose pose_before, pose_after;
  Vec3 pivot = Vec3::Zero();

  bool is_still() const { return collider->motion.is_still(); }
  bool is_mesh() const { return std::holds_alternative<MeshShape>(after); }

  /// The start position of a point that moves with the shape and ends at p; and the reverse.
  Vec3 at_start(const Vec3& p) const {
    return is_still() ? p : apply(pose_before, pivot, apply_inverse(pose_after, pivot, p));
  }
  Vec3 at_end(const Vec3& p) const {
    return is_still() ? p : apply(pose_after, pivot, apply_inverse(pose_before, pivot, p));
  }

  /// Rotates a direction from the start to the end of the step; and the reverse.
  Vec3 turned(const Vec3& direction) const {
    return pose_after.rotation * pose_before.rotation.transpose() * direction;
  }
  Vec3 turned_back(const Vec3& direction) const {
    return pose_before.rotation * pose_after.rotation.transpose() * direction;
  }

  /// Mean velocity during the step of the shape's point that ends at p [m/s].
  Vec3 velocity_at(const Vec3& p, double step) const {
    if (is_still()) return Vec3::Zero();
    return (p - at_start(p)) / step;
  }
};

}  // namespace weft::engine
