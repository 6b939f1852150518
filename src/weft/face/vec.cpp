#include "weft/vec.h"

#include <cmath>

#include "weft/core/angle.h"
#include "weft/error.h"
#include "weft/face/convert.h"

namespace weft {

double length(const Vec3& a) { return std::sqrt(dot(a, a)); }

Mat3 rotation_from_quaternion(double w, double x, double y, double z) {
  const double size = std::sqrt(w * w + x * x + y * y + z * z);
  if (!(size > 0) || !std::isfinite(size)) throw InputError("a quaternion must be finite and nonzero");
  return engine::from_engine(
      engine::Mat3(Eigen::Quaterniond(w / size, x / size, y / size, z / size).toRotationMatrix()));
}

Mat3 rotation_about(const Vec3& axis, double angle_deg) {
  const double size = length(axis);
  if (!(size > 0) || !std::isfinite(size)) throw InputError("an axis must be finite and nonzero");
  const auto [sine, cosine] = engine::sin_cos_deg(angle_deg / 2);
  const Vec3 v = (sine / size) * axis;
  return rotation_from_quaternion(cosine, v.x, v.y, v.z);
}

Mat3 rotation_from_angles_deg(const Vec3& angles_deg) {
  return engine::from_engine(engine::rotation_from_angles_deg(engine::to_engine(angles_deg)));
}

}  // namespace weft
