#include "weft/pictures/public_camera.h"

#include <cmath>
#include <numbers>

#include "weft/face/convert.h"

namespace weft::engine {
namespace {

constexpr int kMaxSide = 16384;  // texture limit of most OpenGL drivers [pixels]

double to_degrees(double angle) { return angle * 180 / std::numbers::pi; }

void require_valid(const weft::Camera& camera) {
  const Vec3 position = to_engine(camera.position), target = to_engine(camera.target);
  const double distance = (target - position).norm();
  if (!std::isfinite(distance) || distance == 0)
    throw InputError("a camera's position and target: expected two different points");
  if (!(camera.fov_deg > 0 && camera.fov_deg < 180))
    throw InputError("a camera's field of view: expected more than 0 and less than 180 degrees");
  for (const int side : {camera.width, camera.height}) {
    if (side < 1 || side > kMaxSide)
      throw InputError("a camera's width and height: expected 1 to " + std::to_string(kMaxSide) +
                       " pixels, not " + std::to_string(side));
  }
}

}  // namespace

Camera to_engine(const weft::Camera& camera) {
  require_valid(camera);
  const Vec3 target = to_engine(camera.target), back = to_engine(camera.position) - target;
  const double level = std::sqrt(back.x() * back.x() + back.z() * back.z());
  return {.target = target,
          .distance = back.norm(),
          .azimuth_deg = level > 0 ? to_degrees(std::atan2(back.x(), back.z())) : 0,
          .elevation_deg = to_degrees(std::atan2(back.y(), level)),
          .fov_deg = camera.fov_deg};
}

weft::Camera from_engine(const Camera& camera, const weft::Camera& like) {
  return {.position = from_engine(camera.eye()),
          .target = from_engine(camera.target),
          .fov_deg = camera.fov_deg,
          .width = like.width,
          .height = like.height};
}

}  // namespace weft::engine
