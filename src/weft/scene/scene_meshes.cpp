#include "weft/scene/scene_meshes.h"

#include <algorithm>
#include <limits>
#include <set>
#include <sstream>

#include "weft/error.h"
#include "weft/face/convert.h"
#include "weft/io.h"
#include "weft/io/mesh_files.h"
#include "weft/mesh/holes.h"
#include "weft/mesh/solid.h"
#include "weft/scene/cloth_faces.h"

namespace weft::engine {
namespace {

/// In metres, y up.
Vec3 to_world(const Vec3& p, const MeshSource& source) {
  return engine::to_world(p, source.up_is_z, source.scale);
}

MeshFromFile read_in_metres(const MeshSource& source, const std::string& owner) {
  MeshFromFile mesh;
  if (source.mesh) {
    mesh = {.mesh = to_engine(*source.mesh), .uv = to_engine(source.mesh->uv)};
    mesh.faces = make_faces(mesh.mesh.triangles);
  } else {
    mesh = read_mesh_of(source.file, owner);
  }
  for (Vec3& p : mesh.mesh.positions) p = to_world(p, source);
  return mesh;
}

/// The vertices of another file with the faces of `first`.
std::vector<weft::Vec3> read_vertices_in_metres(const std::filesystem::path& file, const MeshSource& source,
                                                const MeshFromFile& first) {
  std::vector<weft::Vec3> positions;
  for (const Vec3& p : read_vertices(file, first)) positions.push_back(from_engine(to_world(p, source)));
  return positions;
}

void add_warnings(const MeshFromFile& mesh, const MeshSource& source, const std::string& owner,
                  std::vector<std::string>& warnings) {
  for (const std::string& warning : mesh.warnings)
    warnings.push_back(owner + " (" + source.file.filename().string() + "): " + warning);
}

/// The triangles of another mesh with the faces of `first`.
std::vector<weft::TriangleCorners> read_rest_mesh(const MeshSource& source, const MeshFromFile& first,
                                                  const std::string& owner) {
  try {
    const std::vector<weft::Vec3> positions = source.mesh
                                                  ? from_engine(read_in_metres(source, owner).mesh.positions)
                                                  : read_vertices_in_metres(source.file, source, first);
    if (positions.size() != first.mesh.positions.size())
      throw InputError("it has " + std::to_string(positions.size()) + " vertices, the mesh " +
                       std::to_string(first.mesh.positions.size()));
    std::vector<weft::TriangleCorners> rest;
    for (const auto& [i, j, k] : first.mesh.triangles)
      rest.push_back({positions[i], positions[j], positions[k]});
    return rest;
  } catch (const InputError& error) {
    throw InputError(owner + ": its rest shape: " + error.what());
  }
}

/// Lines of a file between vertices of faces that no edge joins, each once.
std::vector<std::array<int, 2>> find_stitches(const MeshFromFile& read) {
  if (read.faces.lines.empty()) return {};
  std::set<std::pair<int, int>> joined;
  std::vector<char> has_face(read.mesh.positions.size(), 0);
  for (const Edge& e : build_edges(read.mesh)) {
    joined.insert({e.a, e.b});
    has_face[e.a] = has_face[e.b] = 1;
  }
  std::vector<std::array<int, 2>> stitches;
  for (const auto& [a, b] : read.faces.lines) {
    if (has_face[a] && has_face[b] && joined.insert(std::minmax(a, b)).second) stitches.push_back({a, b});
  }
  return stitches;
}

/// The shape, the rest shape and the stitches of a cloth.
void describe_mesh(const MeshSource& source, const ClothSceneDesc& desc, ClothDesc& cloth,
                   std::vector<std::string>& warnings) {
  const std::string owner = "cloth \"" + desc.name + '"';
  const std::optional<RestDesc>& rest = desc.rest;
  const MeshFromFile read = read_in_metres(source, owner);
  add_warnings(read, source, owner, warnings);
  const weft::TriangleMesh mesh = from_engine(read.mesh, read.uv);
  if (rest) {
    try {
      cloth.rest = rest->mesh ? read_rest_mesh(*rest->mesh, read, owner) : rest_from_uv(mesh, rest->uv_scale);
    } catch (const InputError& error) {
      throw InputError(rest->mesh ? error.what() : owner + ": " + error.what());
    }
  }
  const std::vector<std::array<int, 2>> stitches = find_stitches(read);
  if (desc.has_stitches) {
    if (stitches.empty())
      throw InputError(owner + ": stitches are the lines of its file, l of an OBJ file, but it has none");
    cloth.stitches = stitches;
  } else if (!stitches.empty()) {
    warnings.push_back(owner + ": its file has " + std::to_string(stitches.size()) +
                       (stitches.size() == 1 ? " line" : " lines") +
                       " between vertices, as Blender's sewing; stitches = true draws them together");
  }
  cloth.shape = mesh;
  cloth.source = source.file.filename().string();
  if (source.weld) cloth.weld = source.weld_distance;
  cloth.sew = source.sew_distance;
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

std::vector<MeshFrame> copy_frames(const PlacedMesh& placed, std::size_t num_vertices,
                                   const std::string& owner) {
  std::vector<MeshFrame> frames;
  for (const std::vector<Vec3>& positions : placed.frame_positions) {
    if (positions.size() != num_vertices)
      throw InputError(owner + ": frame " + std::to_string(frames.size()) + " has " +
                       std::to_string(positions.size()) + " vertices, the mesh " +
                       std::to_string(num_vertices));
    MeshFrame frame{static_cast<double>(frames.size()) / placed.frame_rate, {}};
    for (const Vec3& p : positions) frame.positions.push_back(from_engine(to_world(p, placed.source)));
    frames.push_back(std::move(frame));
  }
  return frames;
}

/// `first` is read from the first of the frames' files.
std::vector<MeshFrame> read_frames(const PlacedMesh& placed, const MeshFromFile& first,
                                   const std::string& owner, const OnPreparation& on_preparation) {
  std::vector<MeshFrame> frames;
  for (std::size_t k = 0; k < placed.frames.size(); ++k) {
    if (on_preparation)
      on_preparation("reading frame " + std::to_string(k + 1) + " of " +
                     std::to_string(placed.frames.size()) + " of " + owner);
    try {
      frames.push_back({static_cast<double>(k) / placed.frame_rate,
                        k == 0 ? from_engine(first.mesh.positions)
                               : read_vertices_in_metres(placed.frames[k], placed.source, first)});
    } catch (const InputError& error) {
      throw InputError(owner + ": frame " + std::to_string(k) + ": " + error.what());
    }
  }
  return frames;
}

/// From the rest pose to the first pose, where the mesh stands still for the rest of `settle` [s].
void prepend_rest(const PlacedMesh& placed, double settle, const MeshFromFile& first,
                  const std::string& owner, std::vector<MeshFrame>& frames) {
  constexpr double kStill = 0.4;  // share of the time, at its end
  try {
    frames.insert(frames.begin(), {{-settle, read_vertices_in_metres(placed.rest, placed.source, first)},
                                   {-kStill * settle, from_engine(first.mesh.positions)}});
  } catch (const InputError& error) {
    throw InputError(owner + ": its rest pose: " + error.what());
  }
}

struct ShapeDescriber {
  double settle;  // SceneDesc::settle [s]
  const std::string& owner;
  std::vector<std::string>& warnings;
  const OnPreparation& on_preparation;
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
    desc.solid = placed.solid;
    if (is_gltf(placed.source.file)) return describe_gltf(placed);
    desc.pose = make_pose(placed.position, placed.rotation_deg);
    desc.source = placed.source.file.filename().string();
    const MeshFromFile mesh = read_in_metres(placed.source, owner);
    add_warnings(mesh, placed.source, owner, warnings);
    desc.frames = placed.frames.empty() ? copy_frames(placed, mesh.mesh.positions.size(), owner)
                                        : read_frames(placed, mesh, owner, on_preparation);
    if (!placed.rest.empty()) prepend_rest(placed, settle, mesh, owner, desc.frames);
    desc.shape = from_engine(mesh.mesh, mesh.uv);
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

TriangleMesh at_pose(const MeshShape& shape) {
  TriangleMesh mesh = *shape.mesh;
  for (int v = 0; v < mesh.num_vertices(); ++v) mesh.positions[v] = shape.vertex(v);
  return mesh;
}

}  // namespace

std::variant<Fabric, Springs> describe_fabric(const ClothSceneDesc& desc) {
  if (desc.fabric) return desc.fabric->numbers;
  return make_springs(desc.material);
}

ClothDesc describe_cloth(const ClothSceneDesc& desc, bool has_contact, std::vector<std::string>& warnings) {
  ClothDesc cloth{.name = desc.name};
  if (const MeshSource* file = std::get_if<MeshSource>(&desc.shape)) {
    describe_mesh(*file, desc, cloth, warnings);
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
  cloth.layer = desc.layer;
  cloth.seams = desc.seams;
  cloth.seam_time = desc.seam_time;
  cloth.seam_stiffness = desc.seam_stiffness;
  cloth.pose = make_pose(desc.position, desc.rotation_deg);
  cloth.velocity = from_engine(desc.velocity);
  cloth.fits_thickness = has_contact && !desc.has_own_thickness;
  return cloth;
}

ColliderDesc describe_collider(const ColliderSceneDesc& desc, double settle,
                               std::vector<std::string>& warnings, const OnPreparation& on_preparation) {
  ColliderDesc collider{.name = desc.name};
  std::visit(ShapeDescriber{settle, "collider \"" + desc.name + '"', warnings, on_preparation, collider},
             desc.shape);
  collider.motion = from_engine(desc.motion.keys());
  collider.friction = desc.friction;
  collider.static_friction = desc.static_friction;
  return collider;
}

int count_inside(const ColliderShape& shape, const std::vector<Vec3>& points) {
  if (const MeshShape* mesh = std::get_if<MeshShape>(&shape))
    return count_inside(find_solid_part(at_pose(*mesh)), points);
  return static_cast<int>(std::count_if(
      points.begin(), points.end(), [&](const Vec3& p) { return signed_distance(shape, p).distance < 0; }));
}

TriangleMesh fill_open_shells(const MeshShape& shape) {
  TriangleMesh open = find_open_part(at_pose(shape));
  fill_holes(open, std::numeric_limits<double>::infinity());
  return find_solid_part(open);
}

int count_inside(const TriangleMesh& closed, const std::vector<Vec3>& points) {
  const std::vector<int> winding = compute_winding_numbers(closed, points);
  return static_cast<int>(winding.size() - std::count(winding.begin(), winding.end(), 0));
}

}  // namespace weft::engine
