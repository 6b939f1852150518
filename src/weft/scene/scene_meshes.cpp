#include "weft/scene/scene_meshes.h"

#include <algorithm>
#include <utility>

#include "weft/core/error.h"
#include "weft/io/obj_reader.h"
#include "weft/mesh/solid.h"

namespace weft {
namespace {

std::string name_with_file(const std::string& owner, const MeshFile& source) {
  return owner + " (" + source.file.filename().string() + "): ";
}

ObjMesh read(const std::filesystem::path& file, const std::string& owner) {
  try {
    return read_obj(file);
  } catch (const InputError& error) {  // names the file and the line
    throw InputError(owner + ": " + error.what());
  }
}

/// In metres, y up.
Vec3 to_world(const Vec3& p, const MeshFile& source) {
  return source.scale * (source.up_is_z ? Vec3(p.x(), p.z(), -p.y()) : p);
}

std::string count_edges(int count) { return std::to_string(count) + (count == 1 ? " edge" : " edges"); }

/// Turns the mesh right side out if it needs that, and says what else is wrong with it as a solid.
void judge_as_solid(TriangleMesh& mesh, const std::string& who, std::vector<std::string>& warnings) {
  const SurfaceEdges edges = count_surface_edges(mesh);
  const auto warn = [&](const std::string& sentence) { warnings.push_back(who + sentence); };
  if (edges.non_manifold > 0) {
    warn(count_edges(edges.non_manifold) +
         " of more than two triangles (non-manifold): inside and outside may be " + "mistaken there");
  }
  if (edges.twisted > 0) {
    warn(count_edges(edges.twisted) +
         " between triangles that face opposite ways: inside and outside may be " +
         "mistaken; recalculate the mesh's normals to face outwards");
  }
  if (edges.border > 0) {
    warn("has a border of " + count_edges(edges.border) +
         ": cloth is held off on both sides, inside is not defined");
    return;
  }
  const Shells shells = turn_shells_outwards(mesh);
  if (shells.turned == 0) return;
  const std::string turned = std::to_string(shells.turned) + " of its " + std::to_string(shells.count);
  warn((shells.count == 1 ? "is inside out (its triangles face inwards); it was"
                          : turned + " shells are inside out (their triangles face inwards); they were") +
       std::string(" turned right side out"));
}

struct ShapeMaker {
  const std::string& owner;
  std::vector<std::string>& warnings;

  template <class Shape>
  ColliderShape operator()(const Shape& shape) const {
    return shape;
  }

  ColliderShape operator()(const PlacedMesh& placed) const {
    CleanMesh clean = load_mesh(placed.source, MeshUse::collider, owner, warnings);
    judge_as_solid(clean.mesh, name_with_file(owner, placed.source), warnings);
    MeshShape shape{.mesh = std::make_shared<const TriangleMesh>(std::move(clean.mesh)),
                    .rotation = rotation_from_angles_deg(placed.rotation_deg),
                    .translation = placed.position};
    if (!placed.frames.empty())
      shape.sequence = load_sequence(placed, clean.vertex_of_source, shape.mesh->num_vertices());
    return shape;
  }

  /// What cleaning made of the first frame's vertices it makes of every frame's.
  std::shared_ptr<const MeshSequence> load_sequence(const PlacedMesh& placed,
                                                    const std::vector<int>& vertex_of_source,
                                                    int num_vertices) const {
    const std::vector<Triangle> triangles = read(placed.frames[0], owner).mesh.triangles;
    std::vector<MeshSequence::Key> keys;
    for (std::size_t k = 0; k < placed.frames.size(); ++k) {
      const TriangleMesh frame = read_frame(placed.frames[k], placed.source);
      if (frame.positions.size() != vertex_of_source.size() || frame.triangles != triangles) {
        throw InputError(
            owner + ": frame " + std::to_string(k) + " (" + placed.frames[k].filename().string() + ") has " +
            describe(frame) + ", the first one (" + placed.frames[0].filename().string() + ") " +
            std::to_string(vertex_of_source.size()) + " vertices and " + std::to_string(triangles.size()) +
            " triangles; all frames must have the same triangles of the same vertices, in the "
            "same order");
      }
      MeshSequence::Key key{static_cast<double>(k) / placed.frame_rate, {}};
      key.positions.resize(static_cast<std::size_t>(num_vertices));
      for (std::size_t v = 0; v < vertex_of_source.size(); ++v) {
        if (vertex_of_source[v] >= 0) key.positions[vertex_of_source[v]] = frame.positions[v];
      }
      keys.push_back(std::move(key));
    }
    return std::make_shared<const MeshSequence>(std::move(keys));
  }

  TriangleMesh read_frame(const std::filesystem::path& file, const MeshFile& source) const {
    TriangleMesh mesh = read(file, owner).mesh;
    for (Vec3& p : mesh.positions) p = to_world(p, source);
    return mesh;
  }

  static std::string describe(const TriangleMesh& mesh) {
    return std::to_string(mesh.positions.size()) + " vertices and " + std::to_string(mesh.triangles.size()) +
           " triangles";
  }
};

int count_inside(const MeshShape& shape, const std::vector<Vec3>& points) {
  TriangleMesh mesh = *shape.mesh;
  if (count_surface_edges(mesh).border > 0) return 0;
  for (int v = 0; v < mesh.num_vertices(); ++v) mesh.positions[v] = shape.vertex(v);
  const std::vector<int> winding = compute_winding_numbers(mesh, points);
  return static_cast<int>(winding.size() - std::count(winding.begin(), winding.end(), 0));
}

}  // namespace

CleanMesh load_mesh(const MeshFile& source, MeshUse use, const std::string& owner,
                    std::vector<std::string>& warnings, std::vector<CornerUv>* uv) {
  const std::string who = name_with_file(owner, source);
  ObjMesh obj = read(source.file, owner);
  for (Vec3& p : obj.mesh.positions) p = to_world(p, source);
  try {
    CleanMesh clean = clean_mesh(obj.mesh, {.weld_distance = source.weld ? source.weld_distance : -1,
                                            .sew_distance = source.sew_distance,
                                            .is_cloth = use == MeshUse::cloth});
    for (std::string& note : clean.notes) note = who + note;
    for (const auto* list : {&obj.warnings, &clean.warnings}) {
      for (const std::string& warning : *list) warnings.push_back(who + warning);
    }
    if (uv != nullptr && !obj.uv.empty()) {
      for (std::size_t t = 0; t < clean.source_triangle.size(); ++t)
        uv->push_back(interpolate(obj.uv[clean.source_triangle[t]], clean.corner_weights[t]));
    }
    return clean;
  } catch (const InputError& error) {
    throw InputError(who + error.what());
  }
}

Collider make_collider(const ColliderSceneDesc& desc, std::vector<std::string>& warnings) {
  const std::string owner = "collider \"" + desc.name + "\"";
  return {.name = desc.name,
          .shape = std::visit(ShapeMaker{owner, warnings}, desc.shape),
          .friction = desc.friction,
          .motion = desc.motion,
          .static_friction = desc.static_friction};
}

int count_inside(const ColliderShape& shape, const std::vector<Vec3>& points) {
  if (const MeshShape* mesh = std::get_if<MeshShape>(&shape)) return count_inside(*mesh, points);
  return static_cast<int>(std::count_if(
      points.begin(), points.end(), [&](const Vec3& p) { return signed_distance(shape, p).distance < 0; }));
}

}  // namespace weft
