#include "weft/animation/rigid_motion.h"

#include <Eigen/Geometry>
#include <cmath>
#include <string>

#include "weft/core/angle.h"
#include "weft/error.h"

namespace weft::engine {

Mat3 rotation_from_angles_deg(const Vec3& angles_deg) {
  const SinCos a = sin_cos_deg(angles_deg.x()), b = sin_cos_deg(angles_deg.y()),
               c = sin_cos_deg(angles_deg.z());
  Mat3 x, y, z;
  x << 1, 0, 0, 0, a.cos, -a.sin, 0, a.sin, a.cos;
  y << b.cos, 0, b.sin, 0, 1, 0, -b.sin, 0, b.cos;
  z << c.cos, -c.sin, 0, c.sin, c.cos, 0, 0, 0, 1;
  return z * y * x;
}

RigidMotion::RigidMotion(std::vector<KeyFrame> keys) : keys_(std::move(keys)) {
  for (std::size_t k = 0; k < keys_.size(); ++k) {
    if (!std::isfinite(keys_[k].time) || !keys_[k].translation.allFinite() ||
        !keys_[k].angles_deg.allFinite())
      throw InputError("key frame " + std::to_string(k) + " has a non-finite number");
  }
  for (std::size_t k = 1; k < keys_.size(); ++k) {
    if (!(keys_[k].time > keys_[k - 1].time)) {
      throw InputError("key frame " + std::to_string(k) + " is not later than the previous one");
    }
  }
}

RigidMotion::RigidMotion(double start, const Pose& from, double end, const Pose& to)
    : passage_({start, end, from, to}) {}

bool RigidMotion::is_still() const {
  if (!passage_) return keys_.empty();
  return passage_->from.translation == passage_->to.translation &&
         passage_->from.rotation == passage_->to.rotation;
}

/// Rotations by linear interpolation of unit quaternions (nlerp).
Pose RigidMotion::Passage::at(double time) const {
  if (time <= start || time >= end) return time < end ? from : to;
  const double s = (time - start) / (end - start);
  Pose pose{from.translation + s * (to.translation - from.translation), from.rotation};
  if (from.rotation == to.rotation) return pose;
  const Eigen::Quaterniond a(from.rotation), b(to.rotation);
  const double way = a.dot(b) < 0 ? -s : s;
  pose.rotation = Eigen::Quaterniond((1 - s) * a.coeffs() + way * b.coeffs()).normalized().toRotationMatrix();
  return pose;
}

Pose RigidMotion::at(double time) const {
  if (passage_) return passage_->at(time);
  if (keys_.empty()) return {};
  std::size_t next = 0;
  while (next < keys_.size() && keys_[next].time <= time) ++next;
  const KeyFrame& a = keys_[next == 0 ? 0 : next - 1];
  const KeyFrame& b = keys_[next == keys_.size() ? next - 1 : next];
  const double span = b.time - a.time;
  const double s = span > 0 ? (time - a.time) / span : 0.0;
  return {a.translation + s * (b.translation - a.translation),
          rotation_from_angles_deg(a.angles_deg + s * (b.angles_deg - a.angles_deg))};
}

}  // namespace weft::engine
