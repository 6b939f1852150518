#include "weft/pictures/scene_picture.h"

#include <algorithm>
#include <cmath>

#include "weft/mesh/vertex_normals.h"

namespace weft::engine {
namespace {

constexpr double kCheckSize = 0.025;  // of the checks in cloth [m]
constexpr double kBelow = 0.02;       // depth of the ground below the scene, as a share of its size [1]
constexpr double kLevel = 0.999;      // least y of the normal of a ground plane [1]
constexpr Color kStructural = {0.05, 0.10, 0.25}, kShear = {0.75, 0.22, 0.04}, kBend = {0.10, 0.45, 0.25};
constexpr int kArcPieces = 8;        // lines in the arc of a bending spring
constexpr double kArcHeight = 0.13;  // of the arc, as a share of its length [1]

bool is_level_plane(const AnimatedBody& body) {
  const Plane* plane = body.shape ? std::get_if<Plane>(&*body.shape) : nullptr;
  return plane && body.poses.size() == 1 && (body.poses[0].rotation * plane->normal).y() > kLevel;
}

bool is_plane(const AnimatedBody& body) { return body.shape && std::holds_alternative<Plane>(*body.shape); }

const AnimatedBody::Pose& pose_at(const AnimatedBody& body, int frame) {
  return body.poses[std::min<std::size_t>(static_cast<std::size_t>(frame), body.poses.size() - 1)];
}

Vec3 vertex(const std::vector<float>& positions, std::size_t v) {
  return {positions[3 * v], positions[3 * v + 1], positions[3 * v + 2]};
}

/// Everything in a frame except for planes, which are infinite.
void add_points(const Animation& animation, int frame, std::vector<Vec3>& points) {
  for (const AnimatedCloth& cloth : animation.cloths) {
    const std::vector<float>& positions = cloth.frames[frame];
    for (std::size_t v = 0; 3 * v < positions.size(); ++v) points.push_back(vertex(positions, v));
  }
  for (const AnimatedBody& body : animation.bodies) {
    if (is_plane(body)) continue;
    const AnimatedBody::Pose& pose = pose_at(body, frame);
    for (std::size_t v = 0; v < body.mesh.positions.size(); ++v)
      points.push_back(pose.rotation * body.vertex(v, static_cast<std::size_t>(frame)) + pose.translation);
  }
}

DrawnMesh draw_cloth(const AnimatedCloth& cloth, int frame) {
  const double check = cloth.fabric_coordinates.empty() ? 0 : kCheckSize;
  return {.triangles = cloth.triangles,
          .positions = cloth.frames[frame],
          .fabric_coordinates = cloth.fabric_coordinates,
          .look = {Look::Kind::fabric, cloth.color, check}};
}

DrawnMesh draw_body(const AnimatedBody& body, int frame) {
  DrawnMesh mesh{.triangles = body.mesh.triangles, .look = {.color = body.color}};
  const AnimatedBody::Pose& pose = pose_at(body, frame);
  for (std::size_t v = 0; v < body.mesh.positions.size(); ++v) {
    for (const double c :
         Vec3(pose.rotation * body.vertex(v, static_cast<std::size_t>(frame)) + pose.translation))
      mesh.positions.push_back(static_cast<float>(c));
  }
  return mesh;
}

/// Height of a level plane, else the style's ground, by default below the lowest point of the animation.
std::optional<double> find_ground(const Animation& animation, const SceneStyle& style) {
  for (const AnimatedBody& body : animation.bodies) {
    if (is_level_plane(body)) return body.poses[0].translation.y();
  }
  if (style.ground || !style.has_ground) return style.ground;
  Eigen::AlignedBox3d box;
  std::vector<Vec3> points;
  for (int frame = 0; frame < num_frames(animation); ++frame) {
    points.clear();
    add_points(animation, frame, points);
    for (const Vec3& p : points) box.extend(p);
  }
  if (box.isEmpty()) return std::nullopt;
  return box.min().y() - kBelow * box.diagonal().norm();
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

void draw_springs(const DrawnMesh& cloth, const ClothTopology& topology, Picture& picture) {
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

int num_frames(const Animation& animation) {
  return animation.cloths.empty() ? 0 : static_cast<int>(animation.cloths[0].frames.size());
}

ScenePictures::ScenePictures(const Animation& animation, SceneStyle style)
    : animation_(animation), style_(std::move(style)) {
  style_.ground = find_ground(animation, style_);
}

Picture ScenePictures::at(int frame, const Camera& camera) const {
  Picture picture;
  picture.camera = camera;
  picture.transparent = style_.transparent;
  picture.ground = style_.ground;
  for (int c = 0; c < static_cast<int>(animation_.cloths.size()); ++c) {
    DrawnMesh cloth = draw_cloth(animation_.cloths[c], frame);
    if (static_cast<std::size_t>(c) < style_.cloth_colors.size()) cloth.look.color = style_.cloth_colors[c];
    if (const SpringsToDraw* springs = find_springs(c))
      draw_springs(cloth, *springs->topology, picture);
    else
      picture.meshes.push_back(std::move(cloth));
  }
  for (const AnimatedBody& body : animation_.bodies) {
    if (!is_level_plane(body)) picture.meshes.push_back(draw_body(body, frame));
  }
  return picture;
}

std::vector<int> ScenePictures::shown() const {
  std::vector<int> shown;
  int ground = -1;
  const int num_cloths = static_cast<int>(animation_.cloths.size());
  for (int c = 0; c < num_cloths; ++c) {
    if (!find_springs(c)) shown.push_back(c);
  }
  for (int b = 0; b < static_cast<int>(animation_.bodies.size()); ++b) {
    if (!is_level_plane(animation_.bodies[b]))
      shown.push_back(num_cloths + b);
    else if (ground < 0)
      ground = num_cloths + b;
  }
  shown.push_back(ground);
  return shown;
}

/// The springs to draw instead of a cloth, or null.
const SpringsToDraw* ScenePictures::find_springs(int cloth) const {
  const auto found = std::find_if(style_.springs.begin(), style_.springs.end(),
                                  [&](const SpringsToDraw& s) { return s.cloth == cloth; });
  return found == style_.springs.end() ? nullptr : &*found;
}

Camera frame_scene(const Animation& animation, const std::vector<int>& frames, const Camera& like,
                   double aspect) {
  std::vector<Vec3> points;
  for (const int frame : frames) add_points(animation, frame, points);
  return frame_points(like, points, aspect);
}

}  // namespace weft::engine
