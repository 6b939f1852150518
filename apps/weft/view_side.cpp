#include "view_side.h"

#include <algorithm>

#include "weft/run/film.h"

namespace weft::engine::app {
namespace {

constexpr double kGroundBelow = 0.1;  // below all expected positions, as a share of their extent [1]
constexpr Color kPin = {0.02, 0.02, 0.02}, kSeam = {0.02, 0.02, 0.02}, kContact = {0.62, 0.05, 0.02},
                kWarp = {0.0, 0.17, 0.44}, kWeft = {0.80, 0.34, 0.0}, kCrossing = {0.9, 0.0, 0.0};
constexpr double kTowardsEye = 0.003;    // lines on cloth, as a share of their distance from the eye [1]
constexpr double kArrow = 0.12;          // of the longest force, as a share of the camera's distance [1]
constexpr double kYarn = 0.35;           // half of a yarn's line, as a share of the triangle's size [1]
constexpr std::size_t kMaxYarns = 4000;  // triangles whose yarns are drawn [1]
constexpr std::size_t kSamples = 600;    // of steps, in plots
constexpr int kSampled = 60;             // frames of a run, evenly spaced, that the first view contains

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

/// The same pixel, in front of the cloth that the point is on.
Vec3 towards_eye(const Vec3& point, const Camera& camera) {
  return point + kTowardsEye * (camera.eye() - point);
}

}  // namespace

Picture ViewSide::draw(const Camera& camera, const ViewLook& look, const ViewScales& scales,
                       bool best) const {
  SceneStyle style{.ground = ground_, .range = {0, scales.color}};
  for (int c = 0; look.springs && c < static_cast<int>(topologies_.size()); ++c)
    style.springs.push_back({c, topologies_[c]});
  if (best) style.smooth = choose_smoothness(meshes_);
  Picture picture = ScenePictures(meshes_, frame_, std::move(style)).at(frame_, camera);
  if (look.pins) add_pins(picture);
  if (look.seams) add_seams(picture);
  if (look.yarns) add_yarns(picture);
  if (look.contacts) add_contacts(scales, picture);
  if (look.checker) add_crossings(picture);
  return picture;
}

void ViewSide::add_pins(Picture& picture) const {
  if (!measured() || !measured()->pins) return;
  DrawnDots dots{.color = kPin, .diameter = 7};
  const std::vector<LivePins>& pins = *measured()->pins;
  for (std::size_t c = 0; c < pins.size(); ++c) {
    for (const int particle : pins[c].particles)
      dots.positions.push_back(towards_eye(position(static_cast<int>(c), particle), picture.camera));
  }
  picture.dots.push_back(std::move(dots));
}

void ViewSide::add_seams(Picture& picture) const {
  if (!measured() || !measured()->seams) return;
  DrawnLines lines{.color = kSeam, .width = 2};
  const std::vector<SeamEdges>& seams = *measured()->seams;
  for (std::size_t c = 0; c < seams.size(); ++c) {
    for (const auto& edge : seams[c]) {
      for (const int particle : edge)
        lines.ends.push_back(towards_eye(position(static_cast<int>(c), particle), picture.camera));
    }
  }
  picture.lines.push_back(std::move(lines));
}

void ViewSide::add_yarns(Picture& picture) const {
  if (!measured()) return;
  DrawnLines warp{.color = kWarp, .width = 2}, weft{.color = kWeft, .width = 2};
  const std::vector<YarnCross>& yarns = measured()->yarns;
  const std::size_t step = yarns.size() / kMaxYarns + 1;
  for (std::size_t k = 0; k < yarns.size(); k += step) {
    const Vec3 middle = towards_eye(yarns[k].position, picture.camera);
    for (const auto& [lines, yarn] :
         {std::pair(&warp, yarns[k].yarns.warp), std::pair(&weft, yarns[k].yarns.weft)}) {
      for (const double end : {-kYarn, kYarn}) lines->ends.push_back(middle + end * yarns[k].size * yarn);
    }
  }
  picture.lines.push_back(std::move(warp));
  picture.lines.push_back(std::move(weft));
}

void ViewSide::add_contacts(const ViewScales& scales, Picture& picture) const {
  if (!measured()) return;
  DrawnLines arrows{.color = kContact, .width = 2};
  DrawnDots feet{.color = kContact, .diameter = 4};
  const double length = kArrow * picture.camera.distance / scales.force;
  for (const ContactForce& contact : measured()->contacts) {
    const Vec3 foot = towards_eye(contact.position, picture.camera);
    feet.positions.push_back(foot);
    arrows.ends.insert(arrows.ends.end(), {foot, foot + length * contact.force});
  }
  picture.lines.push_back(std::move(arrows));
  picture.dots.push_back(std::move(feet));
}

void ViewSide::add_crossings(Picture& picture) const {
  if (!findings()) return;
  DrawnDots dots{.color = kCrossing, .diameter = 9};
  for (const Vec3& place : findings()->places) dots.positions.push_back(towards_eye(place, picture.camera));
  picture.dots.push_back(std::move(dots));
}

std::optional<ViewHit> ViewSide::pick(const Ray& ray) const {
  const ScenePictures pictures(meshes_, frame_, {.ground = ground_});
  const std::optional<Hit> hit = find_first_hit(pictures.at(frame_, {}).meshes, ray);
  if (!hit) return std::nullopt;
  const int shown = pictures.shown(frame_)[hit->mesh], num_cloths = static_cast<int>(meshes_.cloths.size());
  if (shown < 0) return std::nullopt;
  if (shown < num_cloths)
    return ViewHit{.cloth = ClothPoint{shown, hit->triangle, hit->weights}, .place = hit->point};
  return ViewHit{.body = shown - num_cloths, .place = hit->point};
}

Vec3 ViewSide::position(int cloth, int vertex) const {
  return Eigen::Map<const Eigen::Vector3f>(&frame_.cloths[cloth][3 * static_cast<std::size_t>(vertex)])
      .cast<double>();
}

Eigen::AlignedBox3d ViewSide::box_of_body(int body) const {
  const AnimatedBody& mesh = meshes_.bodies[body];
  Eigen::AlignedBox3d box;
  for (std::size_t v = 0; v < mesh.mesh.positions.size(); ++v)
    box.extend(frame_.poses[body].rotation * mesh.vertex(v, frame_.body_vertices[body]) +
               frame_.poses[body].translation);
  return box;
}

double ViewSide::largest_value() const {
  float largest = 0;
  for (const std::vector<float>& values : frame_.values) {
    for (const float value : values) largest = std::max(largest, value);
  }
  return largest;
}

double ViewSide::largest_force() const {
  double largest = 0;
  if (!measured()) return largest;
  for (const ContactForce& contact : measured()->contacts) largest = std::max(largest, contact.force.norm());
  return largest;
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
  if (!backwards) live_.step_frame();
}

bool LiveSide::update() {
  if (!live_.take_newest(newest_)) return false;
  if (start_ != newest_.start) {
    start_ = newest_.start;
    meshes_ = without_frames(*start_);
    topologies_.clear();
  }
  frame_ = newest_.meshes;
  ++num_updates_;
  for (const LiveSample& sample : newest_.samples) samples_.push_back(sample);
  while (samples_.size() > kSamples) samples_.pop_front();
  newest_.samples.clear();
  for (std::size_t c = 0; c < newest_.topologies.size(); ++c) {
    if (c < topologies_.size() && topologies_[c] == newest_.topologies[c]) continue;
    meshes_.cloths[c].triangles = newest_.topologies[c]->mesh.triangles;
    meshes_.cloths[c].fabric_coordinates =
        make_fabric_coordinates(*newest_.topologies[c]);  // torn cloth has more
  }
  topologies_ = newest_.topologies;
  return true;
}

RunSide::RunSide(const std::filesystem::path& path)
    : run_(open_frames_and_world(path)),
      title_(run_.frames->meshes().title.empty() ? path.string() : run_.frames->meshes().title),
      reach_(find_reach(*run_.frames)),
      head_{.frames_per_second = run_.frames->meshes().frames_per_second, .is_playing = false} {
  meshes_ = run_.frames->meshes();
  ground_ = find_ground(reach_);
  if (run_.world) {
    const World& world = run_.world->world();
    measured_.seams = std::make_shared<const std::vector<SeamEdges>>(find_seams(run_.world->public_world()));
    measured_.pins = std::make_shared<const std::vector<LivePins>>(
        find_pins(run_.world->scene(), run_.world->public_world()));
    for (int c = 0; c < world.num_cloths(); ++c) topologies_.push_back(world.model(world.cloth(c)).topology);
  }
  show(0);
}

bool RunSide::update() {
  const Clock::time_point now = Clock::now();
  const bool was_playing = head_.is_playing;
  if (updated_) head_.advance(std::chrono::duration<double>(now - *updated_).count(), num_frames());
  updated_ = now;
  if (head_.frame() == number_) return was_playing != head_.is_playing;
  show(head_.frame());
  return true;
}

void RunSide::show(int frame) {
  number_ = frame;
  ++num_updates_;
  if (run_.world) return show_world(frame);
  frame_ = instruments_.color == ParticleValue::speed ? FramesWithSpeeds(*run_.frames).read(frame)
                                                      : run_.frames->read(frame);
}

/// The world in the state of the frame, with instruments and a sample.
void RunSide::show_world(int frame) {
  measured_.meshes = run_.world->show(*run_.frames, frame);
  const World& world = run_.world->world();
  LiveInstruments wanted = instruments_;  // forces of contacts are not in a run
  wanted.contacts = false;
  if (wanted.color == ParticleValue::contact) wanted.color.reset();
  read_instruments(world, wanted, *measured_.pins, measured_);
  frame_ = measured_.meshes;
  const auto next = std::ranges::lower_bound(samples_, world.time(), {}, &LiveSample::time);
  if (next != samples_.end() && next->time == world.time()) return;
  const auto count = [&](const std::vector<int>& series) {
    return frame > 0 && std::cmp_less_equal(frame, series.size())
               ? series[static_cast<std::size_t>(frame) - 1]
               : 0;
  };
  LiveSample sample{.time = world.time(),
                    .iterations = count(run_.counts.newton_steps),
                    .linear_iterations = count(run_.counts.cg_iterations),
                    .divisions = count(run_.counts.divisions)};
  measure_world(run_.world->public_world(), sample);
  samples_.insert(next, sample);
}

void RunSide::measure(const LiveInstruments& instruments) {
  if (instruments_ == instruments) return;
  instruments_ = instruments;
  show(number_);
}

std::optional<ProbeReading> RunSide::probe() const {
  if (!instruments_.probe) return std::nullopt;
  if (run_.world) return measured_.probe;
  const ClothPoint& point = *instruments_.probe;
  const Triangle& corners = meshes_.cloths[point.cloth].triangles[point.triangle];
  ProbeReading reading{.cloth = meshes_.cloths[point.cloth].name,
                       .triangle = point.triangle,
                       .particle = corners[point.nearest_corner()]};
  for (int k = 0; k < 3; ++k) reading.point += point.weights[k] * position(point.cloth, corners[k]);
  return reading;
}

std::string RunSide::no_color() const {
  const std::optional<ParticleValue>& color = instruments_.color;
  if (color == ParticleValue::contact) return "a run has no forces of contacts: they require a simulation";
  if (run_.world) return measured_.no_color;
  if (!color || *color == ParticleValue::speed) return "";
  return label_of(*color).name + " requires the run's scene: " + run_.why_not;
}

}  // namespace weft::engine::app
