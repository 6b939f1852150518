#pragma once
/// A collider during one step.

#include "weft/contact/collider.h"

namespace weft::engine {

struct MovingShape {
  const Collider* collider = nullptr;
  ColliderShape before, after;  // where the step begins and ends
  Pose pose_before, pose_after;
  Vec3 pivot = Vec3::Zero();

  bool is_still() const { return collider->motion.is_still(); }
  bool is_mesh() const { return std::holds_alternative<MeshShape>(after); }

  /// Where a point that moves with the shape was at the start of the step, if it is at p at its end; and the
  /// other way round.
  Vec3 at_start(const Vec3& p) const {
    return is_still() ? p : apply(pose_before, pivot, apply_inverse(pose_after, pivot, p));
  }
  Vec3 at_end(const Vec3& p) const {
    return is_still() ? p : apply(pose_after, pivot, apply_inverse(pose_before, pivot, p));
  }

  /// Where a direction has turned that moves with the shape; and whence.
  Vec3 turned(const Vec3& direction) const {
    return pose_after.rotation * pose_before.rotation.transpose() * direction;
  }
  Vec3 turned_back(const Vec3& direction) const {
    return pose_before.rotation * pose_after.rotation.transpose() * direction;
  }

  /// Mean velocity during the step of what is at p at its end [m/s].
  Vec3 velocity_at(const Vec3& p, double step) const {
    if (is_still()) return Vec3::Zero();
    return (p - at_start(p)) / step;
  }
};

}  // namespace weft::engine
