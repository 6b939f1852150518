#include "view_side.h"

#include <algorithm>

namespace weft::engine::app {
namespace {

constexpr double kGroundBelow = 0.1;  // below all expected positions, as a share of their extent [1]
constexpr Color kHand = {0.95, 0.35, 0.02};
constexpr std::size_t kSamples = 600;  // of steps, in plots
constexpr int kSampled = 60;           // frames of a run, evenly spaced, that the first view contains

double find_ground(const std::vector<Vec3>& reach) {
  Eigen::AlignedBox3d box;
  for (const Vec3& p : reach) box.extend(p);
  return box.min().y() - kGroundBelow * box.diagonal().norm();
}

void add_corners(const Eigen::AlignedBox3d& box, std::vector<Vec3>& points) {
  for (int k = 0; k < 8; ++k) points.push_back(box.corner(static_cast<Eigen::AlignedBox3d::CornerType>(k)));
}

/// Corners of boxes around all meshes but planes, in frames over the whole run.
std::vector<Vec3> find_reach(FrameSource& run) {
  std::vector<Vec3> points;
  const Animation& meshes = run.meshes();
  const int last = run.num_frames() - 1, count = std::min(last + 1, kSampled);
  for (int n = 0; n < count; ++n) {
    const AnimationFrame frame = run.read(count == 1 ? 0 : n * last / (count - 1));
    for (const std::vector<float>& cloth : frame.cloths) {
      Eigen::AlignedBox3d box;
      for (std::size_t k = 0; k < cloth.size(); k += 3)
        box.extend(Eigen::Map<const Eigen::Vector3f>(&cloth[k]).cast<double>());
      add_corners(box, points);
    }
    for (std::size_t b = 0; b < meshes.bodies.size(); ++b) {
      const AnimatedBody& body = meshes.bodies[b];
      if (body.shape && std::holds_alternative<Plane>(*body.shape)) continue;
      Eigen::AlignedBox3d box;
      for (std::size_t v = 0; v < body.mesh.positions.size(); ++v)
        box.extend(frame.poses[b].rotation * body.vertex(v, frame.body_vertices[b]) +
                   frame.poses[b].translation);
      add_corners(box, points);
    }
  }
  return points;
}

}  // namespace

Picture ViewSide::draw(const Camera& camera, bool springs, const std::optional<Vec3>& target) const {
  SceneStyle style{.ground = ground_};
  for (int c = 0; springs && c < static_cast<int>(topologies_.size()); ++c)
    style.springs.push_back({c, topologies_[c]});
  Picture picture = ScenePictures(meshes_, frame_, std::move(style)).at(frame_, camera);
  if (status() && status()->held) {
    const Vec3 held = *status()->held;
    picture.dots.push_back({.positions = {held}, .color = kHand, .diameter = 11});
    if (target) picture.lines.push_back({.ends = {held, *target}, .color = kHand, .width = 2.5});
  }
  return picture;
}

std::optional<ViewSide::ClothHit> ViewSide::pick(const Ray& ray) const {
  // Cloths come first among the meshes.
  const Picture picture = ScenePictures(meshes_, frame_, {.ground = ground_}).at(frame_, {});
  const std::optional<Hit> hit = find_first_hit(picture.meshes, ray);
  if (!hit || hit->mesh >= static_cast<int>(meshes_.cloths.size())) return std::nullopt;
  return ClothHit{{hit->mesh, hit->triangle, hit->weights}, hit->point};
}

Vec3 ViewSide::center() const {
  const std::vector<float>& positions = frame_.cloths[0];
  const Eigen::Map<const Eigen::Matrix3Xf> points(positions.data(), 3,
                                                  static_cast<Eigen::Index>(positions.size() / 3));
  return points.cast<double>().rowwise().mean();
}

LiveSide::LiveSide(const SceneDesc& scene, int threads)
    : live_(scene, {.threads = threads, .playing = false}) {
  ground_ = find_ground(live_.reach());
  update();
}

void LiveSide::step_frame(bool backwards) {
  if (!backwards) step(live_.scene().steps_per_frame);
}

bool LiveSide::update() {
  if (!live_.take_newest(newest_)) return false;
  if (start_ != newest_.start) {
    start_ = newest_.start;
    meshes_ = without_frames(*start_);
  }
  frame_ = newest_.meshes;
  for (const LiveSample& sample : newest_.samples) samples_.push_back(sample);
  while (samples_.size() > kSamples) samples_.pop_front();
  newest_.samples.clear();
  topologies_ = newest_.topologies;
  for (std::size_t c = 0; c < topologies_.size(); ++c)
    meshes_.cloths[c].triangles = topologies_[c]->mesh.triangles;
  return true;
}

RunSide::RunSide(const std::filesystem::path& path)
    : frames_(open_frames(path)),
      title_(frames_->meshes().title.empty() ? path.string() : frames_->meshes().title),
      reach_(find_reach(*frames_)),
      head_{.frames_per_second = frames_->meshes().frames_per_second, .is_playing = false} {
  meshes_ = frames_->meshes();
  frame_ = frames_->read(0);
  ground_ = find_ground(reach_);
}

bool RunSide::update() {
  const Clock::time_point now = Clock::now();
  const bool was_playing = head_.is_playing;
  if (updated_) head_.advance(std::chrono::duration<double>(now - *updated_).count(), num_frames());
  updated_ = now;
  if (head_.frame() == number_) return was_playing != head_.is_playing;
  number_ = head_.frame();
  frame_ = frames_->read(number_);
  return true;
}

}  // namespace weft::engine::app
