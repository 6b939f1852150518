#include "weft/run/start_check.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <optional>
#include <utility>
#include <variant>

#include "weft/run/frame_checks.h"

namespace weft::engine {
namespace {

constexpr int kMaxDescribed = 100000;    // maximum number of crossing triangle pairs grouped by surfaces
constexpr double kInsideAtStart = 1e-6;  // depth of cloth inside a collider that is reported [m]

constexpr double kTooLarge = 20;      // for a garment or its wearer, in metres: probably centimetres [m]
constexpr double kMillimetres = 500;  // too large for centimetres: probably millimetres [m]
constexpr double kMaxRatio = 30;      // of the sizes of collider and cloth, either way …
constexpr double kMaxGarment = 3;     // … and of cloth that is no sheet, over the largest collider
constexpr double kLying = 2;          // a lying mesh: least depth, as a multiple of its height
constexpr double kFlat = 0.1;         // a sheet: its least size, as a share of the largest

std::string format(const char* text, double number) {
  char result[96];
  std::snprintf(result, sizeof result, text, number);
  return result;
}

/// A cloth or a mesh collider.
struct MeshBody {
  std::string name;  // `cloth "shirt"`
  Eigen::AlignedBox3d box;
  int num_triangles = 0;
  const MeshSource* file = nullptr;  // null: it has none
  bool is_turned = false;            // by the scene
  Vec3 position = Vec3::Zero();      // where the scene moves the file's origin
  Vec3 size() const { return box.isEmpty() ? Vec3(Vec3::Zero()) : Vec3(box.sizes()); }
  double largest() const { return size().maxCoeff(); }
  bool is_sheet() const { return size().minCoeff() <= kFlat * largest(); }
};

Eigen::AlignedBox3d box_of(const std::vector<Vec3>& positions) {
  Eigen::AlignedBox3d box;
  for (const Vec3& p : positions) box.extend(p);
  return box;
}

/// All cloths, then the mesh colliders.
std::vector<MeshBody> list_bodies(const SceneDesc& scene, const World& world) {
  std::vector<MeshBody> bodies;
  for (int c = 0; c < world.num_cloths(); ++c) {
    bodies.push_back(
        {"cloth \"" + world.name(world.cloth(c)) + '"', box_of(positions_of(world.state(world.cloth(c)))),
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
    bodies.push_back({"collider \"" + world.colliders()[c].name + '"', box_of(positions),
                      mesh->mesh->num_triangles(), placed ? &placed->source : nullptr,
                      placed && !placed->rotation_deg.isZero(),
                      placed ? placed->position : Vec3(Vec3::Zero())});
  }
  return bodies;
}

std::string describe_size(const MeshBody& body) {
  const Vec3 size = body.size();
  return body.name + format(": %.3g m wide, ", size.x()) + format("%.3g m high, ", size.y()) +
         format("%.3g m deep, ", size.z()) + std::to_string(body.num_triangles) + " triangles";
}

bool is_in_another_unit(const MeshBody& body) { return body.file && body.largest() > kTooLarge; }

std::optional<std::string> check_unit(const MeshBody& body) {
  if (!is_in_another_unit(body)) return {};
  const bool is_millimetres = body.largest() > kMillimetres;
  return body.name + format(" is %.3g m large; is its file in ", body.largest()) +
         (is_millimetres ? "millimetres" : "centimetres") +
         format("? scale = %g", body.file->scale * (is_millimetres ? 1e-3 : 1e-2));
}

/// The unit [m], and its name, that accounts for a ratio of sizes.
std::pair<double, const char*> nearest_unit(double ratio) {
  constexpr std::pair<double, const char*> kUnits[] = {
      {1e-3, "millimetres"}, {1e-2, "centimetres"}, {0.0254, "inches"}, {0.3048, "feet"}};
  return *std::ranges::min_element(kUnits, {},
                                   [&](const auto& unit) { return std::abs(std::log(unit.first * ratio)); });
}

/// Whether the size of a is farther from a metre than that of b, as a ratio.
bool is_less_human(const MeshBody& a, const MeshBody& b) {
  return std::abs(std::log(a.largest())) > std::abs(std::log(b.largest()));
}

/// `may_wear`: the collider is the largest.
std::optional<std::string> check_ratio(const MeshBody& cloth, const MeshBody& collider, bool may_wear) {
  if (!cloth.file || !collider.file || is_in_another_unit(cloth) || is_in_another_unit(collider)) return {};
  const double ratio = cloth.largest() / collider.largest(),
               most = may_wear && !cloth.is_sheet() ? kMaxGarment : kMaxRatio;
  if (ratio <= most && ratio >= 1 / kMaxRatio) return {};
  const auto [unit, name] = nearest_unit(std::max(ratio, 1 / ratio));
  const bool is_cloth = is_less_human(cloth, collider);
  const MeshBody& suspect = is_cloth ? cloth : collider;
  const std::string sizes = cloth.name + format(" is %.3g m large and ", cloth.largest()) + collider.name +
                            format(" %.3g m; is ", collider.largest());
  if (is_cloth == (ratio > 1))
    return sizes + "the file of " + suspect.name + " in " + name +
           format("? scale = %g", suspect.file->scale * unit);
  return sizes + suspect.name + format(" too small? scale = %g", suspect.file->scale / unit);
}

/// Whether it has the orientation of a body on its back that should stand.
bool lies(const Vec3& size) { return size.z() > kLying * size.y() && size.y() > kFlat * size.z(); }

/// The box of a body with z up instead of y, as it would stand.
Eigen::AlignedBox3d turned(const MeshBody& body) {
  const Eigen::AlignedBox3d box = body.box.translated(-body.position);
  return Eigen::AlignedBox3d(Vec3(box.min().x(), box.min().z(), -box.max().y()),
                             Vec3(box.max().x(), box.max().z(), -box.min().y()))
      .translated(body.position);
}

/// Warns of cloth that lies on its back beside a standing collider, and of a collider that does so beside
/// cloth that it would wear if it stood. Sheets may lie, and what is worn is where it belongs.
std::optional<std::string> check_up(const MeshBody& cloth, const MeshBody& collider) {
  const auto warn = [](const MeshBody& lying, const MeshBody& standing) {
    return lying.name + " lies on its back beside " + standing.name +
           ", which stands; does z point up in its file? up = \"z\"";
  };
  const auto may_turn = [](const MeshBody& body) {
    return body.file && !body.file->up_is_z && !body.is_turned && lies(body.size());
  };
  if (collider.box.contains(cloth.box.center())) return {};
  if (may_turn(cloth) && collider.size().y() > kLying * collider.size().z()) return warn(cloth, collider);
  if (may_turn(collider) && cloth.file && cloth.size().y() > cloth.size().z() &&
      turned(collider).contains(cloth.box.center()))
    return warn(collider, cloth);
  return {};
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

std::optional<std::string> refuse_start(const SceneDesc& scene, const std::vector<std::string>& found) {
  if (found.empty() || !scene.contact || scene.crossed_start == CrossedStart::allow) return {};
  std::string all = scene.untangle
                        ? "intersections at the start could not be repaired:"
                        : "intersections at the start, which solver.untangle = false does not repair:";
  for (const std::string& message : found) all += "\n  " + message;
  return all + "\nmove them apart, or set solver.crossed_start = \"allow\" to run anyway";
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
  double largest = 0;
  for (std::size_t other = num_cloths; other < bodies.size(); ++other)
    largest = std::max(largest, bodies[other].largest());
  for (std::size_t cloth = 0; cloth < num_cloths; ++cloth) {
    for (std::size_t other = num_cloths; other < bodies.size(); ++other) {
      warn(check_ratio(bodies[cloth], bodies[other], bodies[other].largest() == largest));
      warn(check_up(bodies[cloth], bodies[other]));
    }
  }
  return check;
}

}  // namespace weft::engine
