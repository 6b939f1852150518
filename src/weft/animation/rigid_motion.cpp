#include "weft/animation/rigid_motion.h"

#include <string>

#include "weft/core/angle.h"
#include "weft/core/error.h"

namespace weft {

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
  for (std::size_t k = 1; k < keys_.size(); ++k) {
    if (!(keys_[k].time > keys_[k - 1].time)) {
      throw InputError("key frame " + std::to_string(k) + " is not later than the one before it");
    }
  }
}

Pose RigidMotion::at(double time) const {
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

}  // namespace weft
