#include "weft/pictures/scene_picture.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "weft/mesh/soup.h"
#include "weft/mesh/vertex_normals.h"

namespace weft::engine {
namespace {

constexpr double kCheckSize = 0.025;   // of the checks in cloth [m]
constexpr double kHemRadius = 0.9e-3;  // three layers of thin cloth, half of them [m]
constexpr int kHemLines = 720;         // hems are drawn where they cover four pixels of so many lines [1]
constexpr double kInset = 0.2;         // of bodies below smooth cloth, as a share of its edges [1]
constexpr double kMaxInset = 5e-3;     // limit of that [m]
constexpr std::size_t kSmoothTriangles = 160'000;  // of all cloth, at most, after subdivision
constexpr double kBelow = 0.02;   // depth of the ground below the scene, as a share of its size [1]
constexpr double kLevel = 0.999;  // least y of the normal of a ground plane [1]
constexpr Color kStructural = {0.05, 0.10, 0.25}, kShear = {0.75, 0.22, 0.04}, kBend = {0.10, 0.45, 0.25};
constexpr int kArcPieces = 8;        // lines in the arc of a bending spring
constexpr double kArcHeight = 0.13;  // of the arc, as a share of its length [1]

bool is_level_plane(const AnimatedBody& body, const AnimatedBody::Pose& pose) {
  const Plane* plane = body.shape ? std::get_if<Plane>(&*body.shape) : nullptr;
  return plane && (pose.rotation * plane->normal).y() > kLevel;
}

/// The first level plane, or -1.
int find_level_plane(const Animation& meshes, const AnimationFrame& frame) {
  for (std::size_t b = 0; b < meshes.bodies.size(); ++b) {
    if (is_level_plane(meshes.bodies[b], frame.poses[b])) return static_cast<int>(b);
  }
  return -1;
}

bool is_plane(const AnimatedBody& body) { return body.shape && std::holds_alternative<Plane>(*body.shape); }

Vec3 vertex(const std::vector<float>& positions, std::size_t v) {
  return {positions[3 * v], positions[3 * v + 1], positions[3 * v + 2]};
}

/// Calls visit(point) for everything in a frame except for planes, which are infinite, or only for cloth.
template <class Visit>
void visit_points(const Animation& meshes, const AnimationFrame& frame, Framed framed, const Visit& visit) {
  for (const std::vector<float>& positions : frame.cloths) {
    for (std::size_t v = 0; 3 * v < positions.size(); ++v) visit(vertex(positions, v));
  }
  if (framed == Framed::cloth) return;
  for (std::size_t b = 0; b < meshes.bodies.size(); ++b) {
    const AnimatedBody& body = meshes.bodies[b];
    if (is_plane(body)) continue;
    for (std::size_t v = 0; v < body.mesh.positions.size(); ++v)
      visit(frame.poses[b].rotation * body.vertex(v, frame.body_vertices[b]) + frame.poses[b].translation);
  }
}

/// The look of a preset's fabric; of other cloth checks, which show its deformation.
Look find_look(const AnimatedCloth& cloth) {
  for (const weft::FabricPreset& preset : weft::fabric_presets()) {
    if (preset.name == cloth.fabric) return {Look::Kind::fabric, cloth.color, 0, preset.look};
  }
  return {Look::Kind::fabric, cloth.color, cloth.fabric_coordinates.empty() ? 0 : kCheckSize, {}};
}

/// Adds tubes around the border, with the border's fabric coordinates and values.
void add_hem(const Hem& hem, DrawnMesh& mesh) {
  const int first = static_cast<int>(mesh.positions.size() / 3);
  const std::vector<float> normals = compute_vertex_normals(mesh.triangles, mesh.positions),
                           placed = hem.place(mesh.positions, normals, kHemRadius);
  mesh.positions.insert(mesh.positions.end(), placed.begin(), placed.end());
  const auto repeat = [&](std::vector<float>& values, int width) {
    if (values.empty()) return;
    for (const int center : hem.centers()) {
      for (int k = 0; k < Hem::kSides; ++k) {
        for (int c = 0; c < width; ++c)
          values.push_back(values[static_cast<std::size_t>(width) * center + c]);
      }
    }
  };
  repeat(mesh.fabric_coordinates, 2);
  repeat(mesh.values, 1);
  for (const auto& [a, b, c] : hem.triangles()) mesh.triangles.push_back({first + a, first + b, first + c});
}

/// A body in a frame. Below smooth cloth its surface is moved inwards: such cloth lies a little inside its
/// triangles in places.
DrawnMesh draw_body(const AnimatedBody& body, const AnimatedBody::Pose& pose,
                    const std::vector<float>& deformed, double inset) {
  DrawnMesh mesh{.triangles = body.mesh.triangles, .look = {.color = body.color}};
  const OrientedBox* box = body.shape ? std::get_if<OrientedBox>(&*body.shape) : nullptr;
  for (std::size_t v = 0; v < body.mesh.positions.size(); ++v) {
    Vec3 p = body.vertex(v, deformed);
    if (box) {  // its faces have their own corners, which move together
      const Vec3 local = box->rotation.transpose() * (p - box->center);
      const Vec3 share = (box->half_size.array() - inset).max(0) / box->half_size.array();
      p = box->center + box->rotation * local.cwiseProduct(share);
    }
    for (const double c : Vec3(pose.rotation * p + pose.translation))
      mesh.positions.push_back(static_cast<float>(c));
  }
  if (inset == 0 || box || is_plane(body)) return mesh;
  const std::vector<float> normals = compute_vertex_normals(mesh.triangles, mesh.positions);
  for (std::size_t k = 0; k < mesh.positions.size(); ++k)
    mesh.positions[k] -= static_cast<float>(inset) * normals[k];
  return mesh;
}

/// Mean length of the edges of all cloth at its start [m].
double find_edge_length(const Animation& meshes, const AnimationFrame& start) {
  double sum = 0, count = 0;
  for (std::size_t c = 0; c < meshes.cloths.size(); ++c) {
    for (const Triangle& t : meshes.cloths[c].triangles) {
      for (int k = 0; k < 3; ++k)
        sum += (vertex(start.cloths[c], t[k]) - vertex(start.cloths[c], t[(k + 1) % 3])).norm();
      count += 3;
    }
  }
  return count == 0 ? 0 : sum / count;
}

/// An arc from a to b, bent towards `side` (unit).
void add_arc(const Vec3& a, const Vec3& b, const Vec3& side, std::vector<Vec3>& ends) {
  const double height = kArcHeight * (b - a).norm();
  const auto at = [&](int k) -> Vec3 {
    const double t = static_cast<double>(k) / kArcPieces;
    return a + t * (b - a) + 4 * t * (1 - t) * height * side;
  };
  for (int k = 0; k < kArcPieces; ++k) {
    ends.push_back(at(k));
    ends.push_back(at(k + 1));
  }
}

/// The particles of cloth that an animation shows as a triangle soup.
DrawnMesh join(const DrawnMesh& soup, const ClothTopology& topology) {
  DrawnMesh joined;
  joined.triangles = topology.mesh.triangles;
  joined.positions.resize(3 * topology.mesh.positions.size());
  for (std::size_t t = 0; t < joined.triangles.size(); ++t) {
    for (std::size_t k = 0; k < 3; ++k)
      std::copy_n(&soup.positions[3 * (3 * t + k)], 3, &joined.positions[3 * joined.triangles[t][k]]);
  }
  return joined;
}

void draw_springs(const DrawnMesh& shown, const ClothTopology& topology, Picture& picture) {
  std::optional<DrawnMesh> joined;
  if (is_soup(shown.triangles)) joined = join(shown, topology);
  const DrawnMesh& cloth = joined ? *joined : shown;
  const std::vector<float> normals = compute_vertex_normals(cloth.triangles, cloth.positions);
  DrawnLines structural{.ends = {}, .color = kStructural, .width = 2.2},
      shear{.ends = {}, .color = kShear, .width = 2.2}, bend{.ends = {}, .color = kBend, .width = 1.4};
  for (const Spring& spring : topology.springs) {
    const Vec3 a = vertex(cloth.positions, spring.i), b = vertex(cloth.positions, spring.j);
    if (spring.kind == SpringKind::bend) {
      const Vec3 across = vertex(normals, spring.i).cross(b - a);
      add_arc(a, b, across.normalized(), bend.ends);
      continue;
    }
    DrawnLines& lines = spring.kind == SpringKind::shear ? shear : structural;
    lines.ends.insert(lines.ends.end(), {a, b});
  }
  DrawnDots particles{.positions = {}, .color = kStructural, .diameter = 9};
  for (int i = 0; i < topology.num_particles(); ++i)
    particles.positions.push_back(vertex(cloth.positions, i));
  for (DrawnLines* lines : {&bend, &shear, &structural}) picture.lines.push_back(std::move(*lines));
  picture.dots.push_back(std::move(particles));
}

}  // namespace

ScenePictures::ScenePictures(const Animation& meshes, const AnimationFrame& start, SceneStyle style)
    : meshes_(meshes), style_(std::move(style)) {
  if (!style_.smooth) return;
  if (*style_.smooth > 0) inset_ = std::min(kInset * find_edge_length(meshes, start), kMaxInset);
  for (std::size_t c = 0; c < meshes.cloths.size(); ++c) {
    const AnimatedCloth& cloth = meshes.cloths[c];
    smooth_.push_back(make_smooth(cloth, start.cloths[c]));
  }
}

/// Of a triangle soup: of its triangles that are joined at these positions.
ScenePictures::Smooth ScenePictures::make_smooth(const AnimatedCloth& cloth,
                                                 const std::vector<float>& positions) const {
  const std::vector<Triangle> triangles =
      is_soup(cloth.triangles) ? join_soup(cloth.triangles, positions) : cloth.triangles;
  LoopSubdivision subdivision(triangles, static_cast<int>(positions.size() / 3), *style_.smooth);
  Hem hem(subdivision.triangles(), subdivision.num_vertices());
  std::vector<float> coordinates;
  if (!cloth.fabric_coordinates.empty()) coordinates = subdivision.fit(cloth.fabric_coordinates, 2);
  return {std::move(subdivision), std::move(hem), std::move(coordinates)};
}

DrawnMesh ScenePictures::draw_cloth(int index, const AnimationFrame& frame, const Camera& camera) const {
  const AnimatedCloth& cloth = meshes_.cloths[index];
  DrawnMesh mesh{.triangles = cloth.triangles,
                 .positions = frame.cloths[index],
                 .fabric_coordinates = cloth.fabric_coordinates,
                 .look = find_look(cloth)};
  if (static_cast<std::size_t>(index) < style_.cloth_colors.size())
    mesh.look.color = style_.cloth_colors[index];
  if (!frame.values.empty()) {
    mesh.values = frame.values[index];
    mesh.range = style_.range;
  }
  if (smooth_.empty() || find_springs(index)) return mesh;
  std::optional<Smooth> now;  // of cloth that tears
  if (is_soup(cloth.triangles)) now = make_smooth(cloth, mesh.positions);
  const auto& [subdivision, hem, coordinates] = now ? *now : smooth_[index];
  mesh.triangles = subdivision.triangles();
  mesh.positions = subdivision.fit(mesh.positions, 3);
  mesh.fabric_coordinates = coordinates;
  if (!mesh.values.empty()) mesh.values = subdivision.apply(mesh.values, 1);
  const double pixel = 2 * camera.distance * std::tan(camera.fov_deg * std::numbers::pi / 360) / kHemLines;
  if (2 * pixel < kHemRadius) add_hem(hem, mesh);
  return mesh;
}

Picture ScenePictures::at(const AnimationFrame& frame, const Camera& camera) const {
  Picture picture;
  picture.camera = camera;
  picture.transparent = style_.transparent;
  const int plane = find_level_plane(meshes_, frame);
  picture.ground = plane < 0 ? style_.ground : frame.poses[plane].translation.y();
  for (int c = 0; c < static_cast<int>(meshes_.cloths.size()); ++c) {
    DrawnMesh cloth = draw_cloth(c, frame, camera);
    if (const SpringsToDraw* springs = find_springs(c))
      draw_springs(cloth, *springs->topology, picture);
    else
      picture.meshes.push_back(std::move(cloth));
  }
  for (std::size_t b = 0; b < meshes_.bodies.size(); ++b) {
    const AnimatedBody& body = meshes_.bodies[b];
    if (!is_level_plane(body, frame.poses[b]))
      picture.meshes.push_back(draw_body(body, frame.poses[b], frame.body_vertices[b], inset_));
  }
  return picture;
}

std::vector<int> ScenePictures::shown(const AnimationFrame& frame) const {
  std::vector<int> shown;
  const int num_cloths = static_cast<int>(meshes_.cloths.size()), plane = find_level_plane(meshes_, frame);
  for (int c = 0; c < num_cloths; ++c) {
    if (!find_springs(c)) shown.push_back(c);
  }
  for (int b = 0; b < static_cast<int>(meshes_.bodies.size()); ++b) {
    if (!is_level_plane(meshes_.bodies[b], frame.poses[b])) shown.push_back(num_cloths + b);
  }
  shown.push_back(plane < 0 ? -1 : num_cloths + plane);
  return shown;
}

/// The springs to draw instead of a cloth, or null.
const SpringsToDraw* ScenePictures::find_springs(int cloth) const {
  const auto found = std::find_if(style_.springs.begin(), style_.springs.end(),
                                  [&](const SpringsToDraw& s) { return s.cloth == cloth; });
  return found == style_.springs.end() ? nullptr : &*found;
}

int choose_smoothness(const Animation& animation) {
  std::size_t triangles = 0;
  for (const AnimatedCloth& cloth : animation.cloths) triangles += cloth.triangles.size();
  return 16 * triangles <= kSmoothTriangles ? 2 : 4 * triangles <= kSmoothTriangles ? 1 : 0;
}

std::array<double, 2> find_range(FrameSource& source, const std::vector<int>& frames) {
  std::array<double, 2> range = {0, 0};
  bool is_first = true;
  for (const int frame : frames) {
    for (const std::vector<float>& cloth : source.read(frame).values) {
      for (const double value : cloth) {
        range = is_first ? std::array{value, value}
                         : std::array{std::min(range[0], value), std::max(range[1], value)};
        is_first = false;
      }
    }
  }
  return range;
}

AnimationFrame FramesWithSpeeds::read(int number) {
  AnimationFrame frame = source_.read(number);
  const AnimationFrame before = number > 0 ? source_.read(number - 1) : frame;
  const double rate = meshes().frames_per_second;
  for (std::size_t c = 0; c < frame.cloths.size(); ++c) {
    std::vector<float>& speeds = frame.values.emplace_back();
    for (std::size_t v = 0; 3 * v < frame.cloths[c].size(); ++v) {
      const Vec3 moved = vertex(frame.cloths[c], v) - vertex(before.cloths[c], v);
      speeds.push_back(static_cast<float>(rate * moved.norm()));
    }
  }
  return frame;
}

Camera frame_scene(FrameSource& source, const std::vector<int>& frames, const Camera& like, double aspect,
                   Framed framed) {
  CameraFit fit(like, aspect);
  for (const int frame : frames)
    visit_points(source.meshes(), source.read(frame), framed, [&](const Vec3& p) { fit.add(p); });
  return fit.camera();
}

std::optional<double> find_ground(FrameSource& source) {
  Eigen::AlignedBox3d box;
  const int num_frames = source.num_frames();
  for (int k = 0; k < num_frames; ++k) {
    const AnimationFrame frame = source.read(k);
    if (k == 0 && find_level_plane(source.meshes(), frame) >= 0) return std::nullopt;
    visit_points(source.meshes(), frame, Framed::everything, [&](const Vec3& p) { box.extend(p); });
  }
  if (box.isEmpty()) return std::nullopt;
  return box.min().y() - kBelow * box.diagonal().norm();
}

}  // namespace weft::engine
