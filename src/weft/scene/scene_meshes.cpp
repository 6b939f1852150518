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
  } else if (compute_signed_volume(mesh) < 0) {
    turn_inside_out(mesh);
    warn("is inside out (its triangles face inwards); it was turned right side out");
  }
}

struct ShapeMaker {
  const std::string& owner;
  std::vector<std::string>& warnings;

  template <class Shape>
  ColliderShape operator()(const Shape& shape) const {
    return shape;
  }

  ColliderShape operator()(const PlacedMesh& placed) const {
    TriangleMesh mesh = load_mesh(placed.source, MeshUse::collider, owner, warnings).mesh;
    judge_as_solid(mesh, name_with_file(owner, placed.source), warnings);
    return MeshShape{std::make_shared<const TriangleMesh>(std::move(mesh)),
                     rotation_from_angles_deg(placed.rotation_deg), placed.position};
  }
};

int count_inside(const MeshShape& shape, const std::vector<Vec3>& points) {
  const TriangleMesh& mesh = *shape.mesh;
  if (count_surface_edges(mesh).border > 0) return 0;
  std::vector<Vec3> local;  // in the mesh's own coordinates
  local.reserve(points.size());
  for (const Vec3& p : points) local.push_back(shape.rotation.transpose() * (p - shape.translation));
  const std::vector<int> winding = compute_winding_numbers(mesh, local);
  return static_cast<int>(winding.size() - std::count(winding.begin(), winding.end(), 0));
}

}  // namespace

CleanMesh load_mesh(const MeshFile& source, MeshUse use, const std::string& owner,
                    std::vector<std::string>& warnings, std::vector<CornerUv>* uv) {
  const std::string who = name_with_file(owner, source);
  ObjMesh obj = read(source.file, owner);
  for (Vec3& p : obj.mesh.positions) {
    if (source.up_is_z) p = {p.x(), p.z(), -p.y()};
    p *= source.scale;
  }
  try {
    CleanMesh clean = clean_mesh(obj.mesh, {.weld_distance = source.weld ? source.weld_distance : -1,
                                            .is_cloth = use == MeshUse::cloth});
    for (const auto* list : {&obj.warnings, &clean.warnings}) {
      for (const std::string& warning : *list) warnings.push_back(who + warning);
    }
    if (uv != nullptr && !obj.uv.empty()) {
      for (const int t : clean.source_triangle) uv->push_back(obj.uv[t]);
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
          .motion = desc.motion};
}

int count_inside(const ColliderShape& shape, const std::vector<Vec3>& points) {
  if (const MeshShape* mesh = std::get_if<MeshShape>(&shape)) return count_inside(*mesh, points);
  return static_cast<int>(std::count_if(
      points.begin(), points.end(), [&](const Vec3& p) { return signed_distance(shape, p).distance < 0; }));
}

}  // namespace weft
