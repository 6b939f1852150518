#include "view_side.h"

#include <algorithm>

namespace weft::engine::app {
namespace {

constexpr double kGroundBelow = 0.1;  // below all expected positions, as a share of their extent [1]
constexpr Color kHand = {0.95, 0.35, 0.02};

double find_ground(const std::vector<Vec3>& reach) {
  Eigen::AlignedBox3d box;
  for (const Vec3& p : reach) box.extend(p);
  return box.min().y() - kGroundBelow * box.diagonal().norm();
}

}  // namespace

ViewSide::ViewSide(const SceneDesc& scene, int threads)
    : live_(scene, {.threads = threads, .playing = false}),
      animation_(live_.start()),
      ground_(find_ground(live_.reach())) {
  update();
}

bool ViewSide::update() {
  if (!live_.take_newest(frame_)) return false;
  replace_frames(frame_.meshes, animation_);
  for (std::size_t c = 0; c < frame_.topologies.size(); ++c)
    animation_.cloths[c].triangles = frame_.topologies[c]->mesh.triangles;
  return true;
}

Picture ViewSide::draw(const Camera& camera, bool springs, const std::optional<Vec3>& target) const {
  SceneStyle style{.ground = ground_};
  for (int c = 0; springs && c < static_cast<int>(frame_.topologies.size()); ++c)
    style.springs.push_back({c, frame_.topologies[c]});
  Picture picture = ScenePictures(animation_, std::move(style)).at(0, camera);
  if (const std::optional<Vec3>& held = status().held) {
    picture.dots.push_back({.positions = {*held}, .color = kHand, .diameter = 11});
    if (target) picture.lines.push_back({.ends = {*held, *target}, .color = kHand, .width = 2.5});
  }
  return picture;
}

std::optional<ViewSide::ClothHit> ViewSide::pick(const Ray& ray) const {
  // Cloths come first among the meshes.
  const Picture picture = ScenePictures(animation_, {.ground = ground_}).at(0, {});
  const std::optional<Hit> hit = find_first_hit(picture.meshes, ray);
  if (!hit || hit->mesh >= static_cast<int>(frame_.meshes.cloths.size())) return std::nullopt;
  return ClothHit{{hit->mesh, hit->triangle, hit->weights}, hit->point};
}

Vec3 ViewSide::center() const {
  const std::vector<float>& positions = frame_.meshes.cloths[0];
  const Eigen::Map<const Eigen::Matrix3Xf> points(positions.data(), 3,
                                                  static_cast<Eigen::Index>(positions.size() / 3));
  return points.cast<double>().rowwise().mean();
}

}  // namespace weft::engine::app
