#include "weft/face/build_collider.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <memory>
#include <optional>

#include "weft/animation/mesh_sequence.h"
#include "weft/error.h"
#include "weft/face/convert.h"
#include "weft/face/vertex_motion.h"
#include "weft/mesh/clean.h"
#include "weft/mesh/holes.h"
#include "weft/mesh/solid.h"
#include "weft/world/world_input.h"

namespace weft::engine {
namespace {

std::string count_of(int count, const std::string& what) {
  return std::to_string(count) + " " + what + (count == 1 ? "" : "s");
}

std::string to_millimetres(double length) {
  char text[32];
  std::snprintf(text, sizeof text, "%.3g mm", 1000 * length);
  return text;
}

/// Makes shells solid where possible: orients triangles, fills holes, flips inside-out shells. Warns of the
/// changes, and of shells that remain open. `solid` as in ColliderDesc.
void make_solid(TriangleMesh& mesh, std::optional<bool> solid, std::vector<std::string>& warnings) {
  constexpr double kMaxShare = 0.05;  // of a shell's area in holes, by default
  const auto they_were = [](int count) { return std::string(count == 1 ? "it was " : "they were "); };
  const SurfaceEdges given = count_surface_edges(mesh);
  if (given.non_manifold > 0)
    warnings.push_back(count_of(given.non_manifold, "edge") +
                       " of more than two triangles (non-manifold): inside and outside may be wrong there");
  if (const int flipped = orient_triangles(mesh); flipped > 0)
    warnings.push_back(count_of(flipped, "triangle") + " faced another way than most around; " +
                       they_were(flipped) + "flipped");
  if (solid.value_or(true)) {
    const FilledHoles filled = fill_holes(mesh, solid ? std::numeric_limits<double>::infinity() : kMaxShare);
    if (filled.count > 0)
      warnings.push_back("has " + count_of(filled.count, "hole") + ", up to " +
                         to_millimetres(filled.largest) + " wide; " + they_were(filled.count) + "filled" +
                         (solid ? "" : " (solid = false leaves them open)"));
  }
  const SurfaceEdges edges = count_surface_edges(mesh);
  if (edges.twisted > 0)
    warnings.push_back(count_of(edges.twisted, "edge") +
                       " between triangles of opposite orientation: a surface with one side has no inside");
  if (edges.border > 0)
    warnings.push_back("has a border of " + count_of(edges.border, "edge") +
                       ": cloth collides with both sides there" +
                       (solid ? "" : "; solid = true fills holes"));
  const TurnedShells shells = turn_shells_outwards(mesh);
  if (shells.turned == 0) return;
  warnings.push_back((shells.count == 1
                          ? "is inside out (its triangles face inwards); "
                          : std::to_string(shells.turned) + " of its " + std::to_string(shells.count) +
                                " shells are inside out (their triangles face inwards); ") +
                     they_were(shells.turned) + "flipped");
}

/// A motion of the vertices that were given, for those of the cleaned mesh.
class CleanedVertices final : public VertexSource {
 public:
  /// `start`: time of the source at time 0 and before [s].
  CleanedVertices(std::shared_ptr<const VertexSource> source, const std::vector<int>& vertex_of_source,
                  int num_vertices, double start)
      : source_(std::move(source)), source_of_vertex_(static_cast<std::size_t>(num_vertices)), start_(start) {
    for (std::size_t v = 0; v < vertex_of_source.size(); ++v) {
      if (vertex_of_source[v] >= 0) source_of_vertex_[vertex_of_source[v]] = v;
    }
  }

  int num_vertices() const override { return static_cast<int>(source_of_vertex_.size()); }
  bool is_still() const override { return source_->is_still(); }
  void evaluate(double time, std::vector<Vec3>& positions) const override {
    std::vector<Vec3> given;
    source_->evaluate(start_ + std::max(time, 0.0), given);
    positions.resize(source_of_vertex_.size());
    for (std::size_t v = 0; v < positions.size(); ++v) positions[v] = given[source_of_vertex_[v]];
  }

 private:
  std::shared_ptr<const VertexSource> source_;
  std::vector<std::size_t> source_of_vertex_;  // (num_vertices)
  double start_ = 0;                           // [s]
};

/// Shapes transformed by the pose.
struct ShapeBuilder {
  const ColliderDesc& desc;
  const std::string& who;
  BuiltCollider& built;
  std::optional<Pose> pose;  // none: in its own coordinates, whose numbers stay as they are

  Vec3 turn(const weft::Vec3& v) const { return pose ? Vec3(pose->rotation * to_engine(v)) : to_engine(v); }
  Vec3 place(const weft::Vec3& p) const { return pose ? Vec3(turn(p) + pose->translation) : to_engine(p); }

  ColliderShape operator()(const weft::Sphere& s) const { return Sphere{place(s.center), s.radius}; }
  ColliderShape operator()(const weft::Plane& p) const { return Plane{place(p.point), turn(p.normal)}; }
  ColliderShape operator()(const weft::Capsule& c) const { return Capsule{place(c.a), place(c.b), c.radius}; }
  ColliderShape operator()(const weft::OrientedBox& b) const {
    const Mat3 own = to_engine(b.rotation);
    return OrientedBox{place(b.center), to_engine(b.half_size), pose ? Mat3(pose->rotation * own) : own};
  }

  ColliderShape operator()(const weft::TriangleMesh& given) const {
    CleanMesh clean = clean_mesh(to_engine(given), {.weld_distance = 0, .is_cloth = false});
    built.warnings = std::move(clean.warnings);
    built.vertex_of_source = std::move(clean.vertex_of_source);
    make_solid(clean.mesh, desc.solid, built.warnings);
    MeshShape shape{.mesh = std::make_shared<const TriangleMesh>(std::move(clean.mesh)),
                    .rotation = pose->rotation,
                    .translation = pose->translation};
    if (!desc.frames.empty()) shape.source = make_sequence(shape.mesh->num_vertices());
    if (!desc.deformation.is_empty())
      shape.source = make_deformation(given.num_vertices(), shape.mesh->num_vertices());
    return shape;
  }

  std::shared_ptr<const VertexSource> make_deformation(int num_given, int num_vertices) const {
    const VertexMotion& motion = desc.deformation;
    if (!desc.frames.empty()) throw InputError("has both frames and a deformation; expected one of them");
    if (motion.num_vertices() != num_given)
      throw InputError("its deformation has " + std::to_string(motion.num_vertices()) +
                       " vertices, the mesh " + std::to_string(num_given));
    if (!std::isfinite(desc.deformation_start))
      throw InputError("the start of its deformation is not finite");
    auto source = std::make_shared<const CleanedVertices>(
        VertexMotionAccess::source(motion), built.vertex_of_source, num_vertices, desc.deformation_start);
    std::vector<Vec3> start;
    source->evaluate(0, start);
    if (!std::ranges::all_of(start, [](const Vec3& p) { return p.allFinite(); }))
      throw InputError("its deformation has a vertex that is not finite at the start");
    return source;
  }

  std::shared_ptr<const VertexSource> make_sequence(int num_vertices) const {
    std::vector<MeshSequence::Key> keys;
    for (const MeshFrame& frame : desc.frames) {
      keys.push_back({frame.time, {}});
      keys.back().positions.resize(static_cast<std::size_t>(num_vertices));
      place_vertices(frame.positions, built, keys.back().positions);
    }
    return std::make_shared<const MeshSequence>(std::move(keys));
  }

  static void place_vertices(const std::vector<weft::Vec3>& given, const BuiltCollider& built,
                             std::vector<Vec3>& positions) {
    const std::vector<int>& map = built.vertex_of_source;
    if (given.size() != map.size())
      throw InputError("expected " + std::to_string(map.size()) + " vertices, got " +
                       std::to_string(given.size()));
    for (std::size_t v = 0; v < map.size(); ++v) {
      if (map[v] >= 0) positions[map[v]] = to_engine(given[v]);
    }
  }
};

}  // namespace

BuiltCollider build_collider(const ColliderDesc& desc, const std::string& who) {
  BuiltCollider built;
  require_valid(to_engine(desc.pose), who);
  if (!std::holds_alternative<weft::TriangleMesh>(desc.shape)) {
    const ColliderShape as_given = std::visit(ShapeBuilder{desc, who, built, {}}, desc.shape);
    require_valid(Collider{.name = desc.name, .shape = as_given});
  }
  const std::string mesh_who =
      desc.source.empty() ? who : who.substr(0, who.size() - 2) + " (" + desc.source + "): ";
  if (!(desc.frames.empty() && desc.deformation.is_empty()) &&
      !std::holds_alternative<weft::TriangleMesh>(desc.shape))
    throw InputError(who + "only a mesh can have frames or a deformation");
  try {
    built.collider.shape = std::visit(ShapeBuilder{desc, who, built, to_engine(desc.pose)}, desc.shape);
  } catch (const InputError& error) {
    throw InputError(mesh_who + error.what());
  }
  for (std::string& warning : built.warnings) warning = mesh_who + warning;
  built.collider.name = desc.name;
  built.collider.friction = desc.friction;
  built.collider.static_friction = desc.static_friction;
  built.collider.motion = to_engine(desc.motion, who);
  return built;
}

std::vector<Vec3> select_vertices(const std::vector<weft::Vec3>& given, const BuiltCollider& built) {
  const std::string who = "collider \"" + built.collider.name + "\": ";
  const MeshShape* shape = std::get_if<MeshShape>(&built.collider.shape);
  if (shape == nullptr) throw InputError(who + "it is not a mesh and has no vertices");
  std::vector<Vec3> positions(shape->mesh->positions.size());
  try {
    ShapeBuilder::place_vertices(given, built, positions);
  } catch (const InputError& error) {
    throw InputError(who + error.what());
  }
  return positions;
}

// With R0, T0 of desc.pose and R, T of the pose, the displacement is R R0ᵀ about the pivot p and (T − R R0ᵀ
// T0) + (R R0ᵀ p − p): free of rounding errors without rotation and with T0 = 0.

Pose to_displacement(const weft::Pose& pose, const ColliderDesc& desc, const Vec3& pivot) {
  const Pose to = to_engine(pose), from = to_engine(desc.pose);
  Pose result;
  if (to.rotation != from.rotation) result.rotation = to.rotation * from.rotation.transpose();
  result.translation =
      (to.translation - result.rotation * from.translation) + (result.rotation * pivot - pivot);
  return result;
}

weft::Pose from_displacement(const Pose& displacement, const ColliderDesc& desc, const Vec3& pivot) {
  const Pose from = to_engine(desc.pose);
  const Mat3& r = displacement.rotation;
  return from_engine(
      Pose{displacement.translation - (r * pivot - pivot) + r * from.translation, r * from.rotation});
}

}  // namespace weft::engine
