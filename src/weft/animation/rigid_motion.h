#pragma once
/// Prescribed motion of pins and colliders by key frames.

#include <optional>
#include <vector>

#include "weft/core/vec.h"

namespace weft::engine {

/// A rigid displacement from the initial pose: p ↦ pivot + R (p − pivot) + translation.
struct Pose {
  Vec3 translation = Vec3::Zero();  // [m]
  Mat3 rotation = Mat3::Identity();
  bool operator==(const Pose&) const = default;
};

/// Rotation by angles about the fixed axes x, then y, then z, in degrees; exact for multiples of 90.
Mat3 rotation_from_angles_deg(const Vec3& angles_deg);

struct KeyFrame {
  double time = 0;                  // [s]
  Vec3 translation = Vec3::Zero();  // from the initial position [m]
  Vec3 angles_deg = Vec3::Zero();   // about fixed x, then y, then z; may exceed a full turn [degrees]
  bool operator==(const KeyFrame&) const = default;
};

/// Key frames by ascending time. Translation and angles are interpolated linearly between them, and constant
/// before the first and after the last. No key frames: no motion.
class RigidMotion {
 public:
  RigidMotion() = default;

  /// Throws InputError if the times do not increase strictly.
  explicit RigidMotion(std::vector<KeyFrame> keys);

  /// Constant pose.
  explicit RigidMotion(const Pose& pose) : RigidMotion(0, pose, 0, pose) {}

  /// From one pose to another, at rest before and after: the translation at constant speed, the rotation the
  /// shorter way about one axis, even to 1 % up to a sixth of a turn.
  RigidMotion(double start, const Pose& from, double end, const Pose& to);

  bool is_still() const;  // no motion at any time
  Pose at(double time) const;

  struct Passage {
    double start = 0, end = 0;  // [s]
    Pose from, to;
    Pose at(double time) const;
    bool operator==(const Passage&) const = default;
  };
  const std::vector<KeyFrame>& keys() const { return keys_; }
  bool operator==(const RigidMotion&) const = default;
  const std::optional<Passage>& passage() const { return passage_; }  // set: replaces key frames

 private:
  std::vector<KeyFrame> keys_;
  std::optional<Passage> passage_;
};

/// Maps p by the pose, which turns about `pivot`.
inline Vec3 apply(const Pose& pose, const Vec3& pivot, const Vec3& p) {
  return pivot + pose.rotation * (p - pivot) + pose.translation;
}

/// Inverse of apply(): the point that the pose maps to p.
inline Vec3 apply_inverse(const Pose& pose, const Vec3& pivot, const Vec3& p) {
  return pivot + pose.rotation.transpose() * (p - pivot - pose.translation);
}

}  // namespace weft::engine
