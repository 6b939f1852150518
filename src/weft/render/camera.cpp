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

std::optional<Eigen::Vector2d> Camera::pixel(const Vec3& point, PictureSize size) const {
  const Vec3 from_eye = point - eye();
  const double depth = from_eye.dot(forward()), half = half_height(fov_deg);
  if (!(depth > 1e-6 * distance)) return std::nullopt;
  const double across = from_eye.dot(right()) / (depth * half * size.aspect()),
               upwards = from_eye.dot(up()) / (depth * half);
  return Eigen::Vector2d((1 + across) / 2 * size.width, (1 - upwards) / 2 * size.height);
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

CameraFit::CameraFit(const Camera& like, double aspect)
    : like_(like),
      x_axis_(like.right()),
      y_axis_(like.up()),
      z_axis_(like.forward()),
      half_y_(half_height(like.fov_deg) / kMargin),
      half_x_(half_y_ * aspect) {}

void CameraFit::add(const Vec3& p) {
  // In the camera's axes each point bounds four planes of the view pyramid: the eye is at the intersection of
  // opposite bounds.
  const Vec3 v(p.dot(x_axis_), p.dot(y_axis_), p.dot(z_axis_));
  right_ = std::max(right_, v.x() / half_x_ - v.z());
  left_ = std::max(left_, -v.x() / half_x_ - v.z());
  above_ = std::max(above_, v.y() / half_y_ - v.z());
  below_ = std::max(below_, -v.y() / half_y_ - v.z());
  depths_ += v.z();
  ++count_;
}

Camera CameraFit::camera() const {
  if (count_ == 0) return like_;
  const double x = half_x_ * (right_ - left_) / 2, y = half_y_ * (above_ - below_) / 2;
  const double back = std::max(right_ + left_, above_ + below_) / 2;  // distance of the eye from the origin
  const double depth = depths_ / static_cast<double>(count_);
  Camera camera = like_;
  camera.distance = std::max(back + depth, 1e-3);
  camera.target = x * x_axis_ + y * y_axis_ + depth * z_axis_;
  return camera;
}

Camera frame_points(const Camera& like, const std::vector<Vec3>& points, double aspect) {
  CameraFit fit(like, aspect);
  for (const Vec3& p : points) fit.add(p);
  return fit.camera();
}

}  // namespace weft::engine
