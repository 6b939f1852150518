#include "weft/run/start_check.h"

#include <Eigen/Geometry>
#include <cstdio>
#include <optional>
#include <variant>

#include "weft/run/frame_checks.h"

namespace weft::engine {
namespace {

constexpr int kMaxDescribed = 100000;    // maximum number of crossing triangle pairs grouped by surfaces
constexpr double kInsideAtStart = 1e-6;  // depth of cloth inside a collider that is reported [m]

constexpr double kTooLarge = 20;      // for a garment or its wearer, in metres: probably centimetres [m]
constexpr double kMillimetres = 500;  // too large for centimetres: probably millimetres [m]
constexpr double kMaxRatio = 30;      // of the sizes of collider and cloth, either way
constexpr double kLying = 2;          // a lying mesh: least depth, as a multiple of its height
constexpr double kFlat = 0.1;         // a sheet: maximum height, as a share of its depth

std::string format(const char* text, double number) {
  char result[96];
  std::snprintf(result, sizeof result, text, number);
  return result;
}

/// A cloth or a mesh collider.
struct MeshBody {
  std::string name;  // `cloth "shirt"`
  Vec3 size = Vec3::Zero();
  int num_triangles = 0;
  const MeshSource* file = nullptr;  // null: it has none
  bool is_turned = false;            // by the scene
  double largest() const { return size.maxCoeff(); }
};

Vec3 size_of(const std::vector<Vec3>& positions) {
  Eigen::AlignedBox3d box;
  for (const Vec3& p : positions) box.extend(p);
  return box.isEmpty() ? Vec3(Vec3::Zero()) : Vec3(box.sizes());
}

/// All cloths, then the mesh colliders.
std::vector<MeshBody> list_bodies(const SceneDesc& scene, const World& world) {
  std::vector<MeshBody> bodies;
  for (int c = 0; c < world.num_cloths(); ++c) {
    bodies.push_back(
        {"cloth \"" + world.name(world.cloth(c)) + '"', size_of(positions_of(world.state(world.cloth(c)))),
         world.model(world.cloth(c)).topology->mesh.num_triangles(),
         std::get_if<MeshSource>(&scene.cloths[c].shape), !scene.cloths[c].rotation_deg.isZero()});
  }
  for (std::size_t c = 0; c < world.colliders().size(); ++c) {
    const ColliderShape shape = shape_at(world.colliders()[c], 0);
    const MeshShape* mesh = std::get_if<MeshShape>(&shape);
    if (!mesh) continue;
    std::vector<Vec3> positions;
    for (int v = 0; v < mesh->mesh->num_vertices(); ++v) positions.push_back(mesh->vertex(v));
    const PlacedMesh* placed = std::get_if<PlacedMesh>(&scene.colliders[c].shape);
    bodies.push_back({"collider \"" + world.colliders()[c].name + '"', size_of(positions),
                      mesh->mesh->num_triangles(), placed ? &placed->source : nullptr});
  }
  return bodies;
}

std::string describe_size(const MeshBody& body) {
  return body.name + format(": %.3g m wide, ", body.size.x()) + format("%.3g m high, ", body.size.y()) +
         format("%.3g m deep, ", body.size.z()) + std::to_string(body.num_triangles) + " triangles";
}

bool is_in_another_unit(const MeshBody& body) { return body.file && body.largest() > kTooLarge; }

std::optional<std::string> check_unit(const MeshBody& body) {
  if (!is_in_another_unit(body)) return {};
  const bool is_millimetres = body.largest() > kMillimetres;
  return body.name + format(" is %.3g m large; is its file in ", body.largest()) +
         (is_millimetres ? "millimetres" : "centimetres") +
         format("? scale = %g", body.file->scale * (is_millimetres ? 1e-3 : 1e-2));
}

std::optional<std::string> check_ratio(const MeshBody& cloth, const MeshBody& collider) {
  if (!cloth.file || !collider.file || is_in_another_unit(cloth) || is_in_another_unit(collider)) return {};
  const double ratio = collider.largest() / cloth.largest();
  if (ratio < kMaxRatio && ratio > 1 / kMaxRatio) return {};
  return cloth.name + format(" is %.3g m large and ", cloth.largest()) + collider.name +
         format(" %.3g m; are both files in the same unit? scale multiplies a file's", collider.largest());
}

/// Warns of a cloth that lies on its back beside a standing collider. Sheets may lie.
std::optional<std::string> check_up(const MeshBody& cloth, const MeshBody& collider) {
  const bool lies = cloth.size.z() > kLying * cloth.size.y() && cloth.size.y() > kFlat * cloth.size.z(),
             stands = collider.size.y() > kLying * collider.size.z();
  if (!cloth.file || cloth.file->up_is_z || cloth.is_turned || !lies || !stands) return {};
  return cloth.name + " lies on its back beside " + collider.name +
         ", which stands; does z point up in its file? up = \"z\"";
}

}  // namespace

std::vector<std::string> check_start(const World& world) {
  const WorldFrames frames(world);
  const FrameToCheck start = frames.now();
  const verify::FrameCheck check = verify::check_frame(start.frame, kMaxDescribed);
  std::vector<std::string> found = verify::describe_by_surfaces(start.frame, check.first);
  for (std::string& message : found) message.insert(0, "at the start ");
  if (check.penetration() > kInsideAtStart)
    found.push_back("at the start " + verify::describe(start.frame, *check.deepest) +
                    format(" is %.3g mm deep", 1000 * check.penetration()));
  return found;
}

SizeCheck check_sizes(const SceneDesc& scene, const World& world) {
  SizeCheck check;
  const auto warn = [&](std::optional<std::string> message) {
    if (message) check.warnings.push_back(std::move(*message));
  };
  const std::vector<MeshBody> bodies = list_bodies(scene, world);
  const std::size_t num_cloths = scene.cloths.size();
  for (const MeshBody& body : bodies) {
    check.sizes.push_back(describe_size(body));
    warn(check_unit(body));
  }
  for (std::size_t cloth = 0; cloth < num_cloths; ++cloth) {
    for (std::size_t other = num_cloths; other < bodies.size(); ++other) {
      warn(check_ratio(bodies[cloth], bodies[other]));
      warn(check_up(bodies[cloth], bodies[other]));
    }
  }
  return check;
}

}  // namespace weft::engine
