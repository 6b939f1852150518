#include "weft/render/camera.h"

#include <algorithm>
#include <cmath>

#include "weft/core/angle.h"

namespace weft::engine {
namespace {

constexpr double kMaxElevation = 89;  // looking straight down, up is undefined [degrees]
constexpr double kMargin = 1.06;      // margin of the picture around the framed points [1]

double half_height(double fov_deg) {
  const SinCos half = sin_cos_deg(fov_deg / 2);
  return half.sin / half.cos;
}

/// The point in the camera's own axes: right, up, and away from the eye.
Vec3 in_view(const Camera& camera, const Vec3& p) {
  const Vec3 d = p - camera.eye();
  return {d.dot(camera.right()), d.dot(camera.up()), d.dot(camera.forward())};
}

}  // namespace

Vec3 Camera::forward() const {
  const SinCos a = sin_cos_deg(azimuth_deg), e = sin_cos_deg(elevation_deg);
  return {-a.sin * e.cos, -e.sin, -a.cos * e.cos};
}

Vec3 Camera::right() const {
  const SinCos a = sin_cos_deg(azimuth_deg);
  return {a.cos, 0, -a.sin};
}

Vec3 Camera::up() const { return right().cross(forward()); }
Vec3 Camera::eye() const { return target - distance * forward(); }

Mat4 Camera::view() const {
  Mat3 axes;
  axes << right().transpose(), up().transpose(), -forward().transpose();
  Mat4 result = Mat4::Identity();
  result.topLeftCorner<3, 3>() = axes;
  result.topRightCorner<3, 1>() = -axes * eye();
  return result;
}

Mat4 Camera::projection(double fov_deg, double aspect, double near, double far) {
  const double f = 1 / half_height(fov_deg);
  Mat4 result = Mat4::Zero();
  result(0, 0) = f / aspect;
  result(1, 1) = f;
  result(2, 2) = (far + near) / (near - far);
  result(2, 3) = 2 * far * near / (near - far);
  result(3, 2) = -1;
  return result;
}

Ray Camera::ray(double x, double y, PictureSize size) const {
  const double half = half_height(fov_deg);
  const double across = (2 * x / size.width - 1) * half * size.aspect(),
               upwards = (1 - 2 * y / size.height) * half;
  return {eye(), (forward() + across * right() + upwards * up()).normalized()};
}

void Camera::orbit(double azimuth, double elevation) {
  azimuth_deg = std::remainder(azimuth_deg + azimuth, 360);
  elevation_deg = std::clamp(elevation_deg + elevation, -kMaxElevation, kMaxElevation);
}

void Camera::pan(double right_share, double up_share) {
  const double height = 2 * distance * half_height(fov_deg);
  target += height * (right_share * right() + up_share * up());
}

void Camera::zoom(double factor) { distance *= factor; }

Camera frame_points(const Camera& like, const std::vector<Vec3>& points, double aspect) {
  Camera camera = like;
  if (points.empty()) return camera;
  const double half_y = half_height(like.fov_deg) / kMargin, half_x = half_y * aspect;
  // In the camera's axes each point bounds four planes of the view pyramid: the eye is at the intersection of
  // opposite bounds.
  camera.target = Vec3::Zero();
  camera.distance = 0;
  double left = -1e30, right = -1e30, below = -1e30, above = -1e30;
  for (const Vec3& p : points) {
    const Vec3 v = in_view(camera, p);
    right = std::max(right, v.x() / half_x - v.z());
    left = std::max(left, -v.x() / half_x - v.z());
    above = std::max(above, v.y() / half_y - v.z());
    below = std::max(below, -v.y() / half_y - v.z());
  }
  const double x = half_x * (right - left) / 2, y = half_y * (above - below) / 2;
  const double back = std::max(right + left, above + below) / 2;  // distance of the eye from the origin
  double depth = 0;
  for (const Vec3& p : points) depth += in_view(camera, p).z() / static_cast<double>(points.size());
  camera.distance = std::max(back + depth, 1e-3);
  camera.target = x * like.right() + y * like.up() + depth * like.forward();
  return camera;
}

}  // namespace weft::engine
