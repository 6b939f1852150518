#include "weft/scene/scene_meshes.h"

#include <algorithm>
#include <sstream>

#include "weft/error.h"
#include "weft/face/convert.h"
#include "weft/io.h"
#include "weft/io/mesh_files.h"
#include "weft/mesh/solid.h"
#include "weft/scene/cloth_faces.h"

namespace weft::engine {
namespace {

/// In metres, y up.
Vec3 to_world(const Vec3& p, const MeshSource& source) {
  return engine::to_world(p, source.up_is_z, source.scale);
}

MeshFromFile read_in_metres(const std::filesystem::path& file, const MeshSource& source,
                            const std::string& owner) {
  MeshFromFile obj = read_mesh_of(file, owner);
  for (Vec3& p : obj.mesh.positions) p = to_world(p, source);
  return obj;
}

weft::TriangleMesh read_mesh(const MeshSource& source, const std::string& owner,
                             std::vector<std::string>& warnings) {
  if (source.mesh) {
    weft::TriangleMesh mesh = *source.mesh;
    for (weft::Vec3& p : mesh.positions) p = from_engine(to_world(to_engine(p), source));
    return mesh;
  }
  const MeshFromFile obj = read_in_metres(source.file, source, owner);
  for (const std::string& warning : obj.warnings)
    warnings.push_back(owner + " (" + source.file.filename().string() + "): " + warning);
  return from_engine(obj.mesh, obj.uv);
}

weft::Pose make_pose(const Vec3& position, const Vec3& rotation_deg) {
  return from_engine(Pose{position, rotation_from_angles_deg(rotation_deg)});
}

Springs make_springs(const ClothMaterial& m) {
  return {.density = m.density,
          .structural = m.structural,
          .shear = m.shear,
          .bend = m.bend,
          .damping = m.damping,
          .damping_kind = m.damping_kind,
          .thickness = m.thickness,
          .friction = m.friction};
}

std::string describe(std::size_t vertices, std::size_t triangles) {
  return std::to_string(vertices) + " vertices and " + std::to_string(triangles) + " triangles";
}

std::vector<MeshFrame> read_frames(const PlacedMesh& placed, const weft::TriangleMesh& first,
                                   const std::string& owner) {
  std::vector<MeshFrame> frames;
  for (const std::vector<Vec3>& positions : placed.frame_positions) {
    if (positions.size() != first.positions.size())
      throw InputError(owner + ": frame " + std::to_string(frames.size()) + " has " +
                       std::to_string(positions.size()) + " vertices, the mesh " +
                       std::to_string(first.positions.size()));
    MeshFrame frame{static_cast<double>(frames.size()) / placed.frame_rate, {}};
    for (const Vec3& p : positions) frame.positions.push_back(from_engine(to_world(p, placed.source)));
    frames.push_back(std::move(frame));
  }
  for (std::size_t k = 0; k < placed.frames.size(); ++k) {
    const TriangleMesh mesh = read_in_metres(placed.frames[k], placed.source, owner).mesh;
    if (mesh.positions.size() != first.positions.size() || mesh.triangles != first.triangles) {
      throw InputError(owner + ": frame " + std::to_string(k) + " (" + placed.frames[k].filename().string() +
                       ") has " + describe(mesh.positions.size(), mesh.triangles.size()) + ", the first (" +
                       placed.frames[0].filename().string() + ") " +
                       describe(first.positions.size(), first.triangles.size()) +
                       "; all frames must have the same vertices and triangles, in the same order");
    }
    frames.push_back({static_cast<double>(k) / placed.frame_rate, from_engine(mesh.positions)});
  }
  return frames;
}

/// From the rest pose to the first pose, where the mesh stands still for the rest of `settle` [s].
void prepend_rest(const PlacedMesh& placed, double settle, const weft::TriangleMesh& first,
                  const std::string& owner, std::vector<MeshFrame>& frames) {
  constexpr double kStill = 0.4;  // share of the time, at its end
  const TriangleMesh rest = read_in_metres(placed.rest, placed.source, owner).mesh;
  if (rest.positions.size() != first.positions.size() || rest.triangles != first.triangles)
    throw InputError(owner + ": its rest pose (" + placed.rest.filename().string() + ") has " +
                     describe(rest.positions.size(), rest.triangles.size()) + ", the mesh " +
                     describe(first.positions.size(), first.triangles.size()) +
                     "; both must have the same triangles of the same vertices, in the same order");
  frames.insert(frames.begin(),
                {{-settle, from_engine(rest.positions)}, {-kStill * settle, first.positions}});
}

struct ShapeDescriber {
  double settle;  // SceneDesc::settle [s]
  const std::string& owner;
  std::vector<std::string>& warnings;
  ColliderDesc& desc;

  void operator()(const Sphere& s) const { desc.shape = weft::Sphere{from_engine(s.center), s.radius}; }
  void operator()(const Plane& p) const {
    desc.shape = weft::Plane{from_engine(p.point), from_engine(p.normal)};
  }
  void operator()(const Capsule& c) const {
    desc.shape = weft::Capsule{from_engine(c.a), from_engine(c.b), c.radius};
  }
  void operator()(const PlacedBox& b) const {
    desc.shape = weft::OrientedBox{from_engine(b.center), from_engine(b.half_size),
                                   from_engine(rotation_from_angles_deg(b.rotation_deg))};
  }
  void operator()(const PlacedMesh& placed) const {
    if (is_gltf(placed.source.file)) return describe_gltf(placed);
    weft::TriangleMesh mesh = read_mesh(placed.source, owner, warnings);
    desc.frames = read_frames(placed, mesh, owner);
    if (!placed.rest.empty()) prepend_rest(placed, settle, mesh, owner, desc.frames);
    desc.pose = make_pose(placed.position, placed.rotation_deg);
    desc.source = placed.source.file.filename().string();
    desc.shape = std::move(mesh);
  }

  void describe_gltf(const PlacedMesh& placed) const {
    const std::string file = placed.source.file.filename().string();
    BodyFromFile body = read_gltf(placed);
    for (const std::string& warning : body.warnings) warnings.push_back(owner + ": " + warning);
    desc.deformation_start = placed.start_time.value_or(body.motion.start());
    if (!body.motion.is_empty()) body.mesh.positions = body.motion.positions(desc.deformation_start);
    if (placed.start_time &&
        !(body.motion.start() <= *placed.start_time && *placed.start_time <= body.motion.end()))
      warnings.push_back(owner + " (" + file + "): start_time = " + to_text(*placed.start_time) +
                         " is outside the clip, which lasts from " + to_text(body.motion.start()) + " to " +
                         to_text(body.motion.end()) + " s");
    desc.deformation = std::move(body.motion);
    desc.pose = make_pose(placed.position, placed.rotation_deg);
    desc.source = file;
    desc.shape = std::move(body.mesh);
  }

  BodyFromFile read_gltf(const PlacedMesh& placed) const {
    try {
      return weft::read_gltf(placed.source.file.string(),
                             {.node = placed.node, .clip = placed.clip, .scale = placed.source.scale});
    } catch (const InputError& error) {
      throw InputError(owner + ": " + error.what());
    }
  }

  static std::string to_text(double seconds) {
    std::ostringstream text;
    text << seconds;
    return text.str();
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

std::variant<Fabric, Springs> describe_fabric(const ClothSceneDesc& desc) {
  if (desc.fabric) return desc.fabric->numbers;
  return make_springs(desc.material);
}

ClothDesc describe_cloth(const ClothSceneDesc& desc, bool has_contact, std::vector<std::string>& warnings) {
  ClothDesc cloth{.name = desc.name};
  if (const MeshSource* file = std::get_if<MeshSource>(&desc.shape)) {
    cloth.shape = read_mesh(*file, "cloth \"" + desc.name + '"', warnings);
    cloth.source = file->file.filename().string();
    if (file->weld) cloth.weld = file->weld_distance;
    cloth.sew = file->sew_distance;
  } else {
    cloth.shape = std::get<Grid>(desc.shape);
  }
  cloth.fabric = describe_fabric(desc);
  if (desc.fabric) {
    cloth.fabric_name = desc.fabric->name;
    cloth.membrane = desc.fabric->membrane;
    if (desc.fabric->warp) cloth.warp = from_engine(*desc.fabric->warp);
  }
  cloth.model = desc.model;
  cloth.seams = desc.seams;
  cloth.seam_time = desc.seam_time;
  cloth.seam_stiffness = desc.seam_stiffness;
  cloth.pose = make_pose(desc.position, desc.rotation_deg);
  cloth.velocity = from_engine(desc.velocity);
  cloth.fits_thickness = has_contact && !desc.has_own_thickness;
  return cloth;
}

ColliderDesc describe_collider(const ColliderSceneDesc& desc, double settle,
                               std::vector<std::string>& warnings) {
  ColliderDesc collider{.name = desc.name};
  std::visit(ShapeDescriber{settle, "collider \"" + desc.name + '"', warnings, collider}, desc.shape);
  collider.motion = from_engine(desc.motion.keys());
  collider.friction = desc.friction;
  collider.static_friction = desc.static_friction;
  return collider;
}

int count_inside(const ColliderShape& shape, const std::vector<Vec3>& points) {
  if (const MeshShape* mesh = std::get_if<MeshShape>(&shape)) return count_inside(*mesh, points);
  return static_cast<int>(std::count_if(
      points.begin(), points.end(), [&](const Vec3& p) { return signed_distance(shape, p).distance < 0; }));
}

}  // namespace weft::engine
