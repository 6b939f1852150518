#include <algorithm>
#include <cmath>
#include <system_error>

#include "weft/io/mesh_files.h"
#include "weft/scene/scene_sections.h"

namespace weft::engine {
namespace {

using Shape = decltype(ColliderSceneDesc::shape);

constexpr double kUnit = 1e-15;  // deviation of |n|² from 1 at which the direction counts as normalised

/// Keys of a mesh on any other shape: refused with the reason, not as unknown.
void refuse_mesh_keys(TomlTable& collider, const std::string& shape_has, bool has_rotation = false) {
  for (const std::string_view key : {"file", "node", "clip", "start_time", "frames", "frame_rate", "rest",
                                     "solid", "up", "scale", "position", "rotation"}) {
    const bool is_own = has_rotation && key == "rotation";
    if (!is_own) collider.refuse(key, "only a mesh has it; " + shape_has + ", in m with y up");
  }
}

Sphere read_sphere(TomlTable& collider) {
  Sphere sphere;
  collider.require({"radius"}, "a number above 0 in m");
  collider.read("center", sphere.center, any_number("m"));
  collider.read("radius", sphere.radius, above_zero("m"));
  refuse_mesh_keys(collider, "a sphere has center and radius");
  return sphere;
}

Plane read_plane(TomlTable& collider) {
  Plane plane;
  collider.read("point", plane.point, any_number("m"));
  if (collider.read("normal", plane.normal, any_number())) {
    if (plane.normal.norm() < 1e-12) {
      collider.get("normal").mistake("expected a direction, found a zero vector");
    } else if (std::abs(plane.normal.squaredNorm() - 1) > kUnit) {
      plane.normal.normalize();
    }
  }
  refuse_mesh_keys(collider, "a plane has point and normal");
  return plane;
}

Capsule read_capsule(TomlTable& collider) {
  Capsule capsule;
  collider.require({"a"}, "3 numbers in m, one end of the axis");
  collider.require({"b"}, "3 numbers in m, the other end of the axis");
  collider.require({"radius"}, "a number above 0 in m");
  collider.read("a", capsule.a, any_number("m"));
  collider.read("b", capsule.b, any_number("m"));
  collider.read("radius", capsule.radius, above_zero("m"));
  refuse_mesh_keys(collider, "a capsule has a, b and radius");
  return capsule;
}

PlacedBox read_box(TomlTable& collider) {
  PlacedBox box;
  collider.require({"half_size"}, "3 numbers above 0 in m");
  collider.read("center", box.center, any_number("m"));
  collider.read("half_size", box.half_size, above_zero("m"), "[0.5, 0.5, 0.5]");
  collider.read("rotation", box.rotation_deg, any_number("degrees"), "[0, 90, 0]");
  refuse_mesh_keys(collider, "a box has center, half_size and rotation", true);
  return box;
}

void read_frames(TomlTable& collider, const std::filesystem::path& folder, PlacedMesh& mesh) {
  std::string name;
  collider.read("frame_rate", mesh.frame_rate, above_zero("frames per second"));
  const TomlValue frames = collider.get("frames", {.kind = ParameterKind::file});
  if (!frames.read(name)) return;
  const std::filesystem::path pattern = folder / name;
  if (std::count(name.begin(), name.end(), '*') != 1 ||
      pattern.filename().string().find('*') == std::string::npos)
    return frames.expected("file names with one star, as in \"walk/body_*.obj\"");
  mesh.frames = find_frame_files(pattern);
  if (mesh.frames.empty())
    return frames.mistake("there are no files " + quote(pattern.generic_string(), 1000));
  mesh.source.file = mesh.frames[0];
}

void read_gltf_keys(TomlTable& collider, PlacedMesh& mesh) {
  if (is_gltf(mesh.source.file)) {
    constexpr const char* kWhy = "a glTF file moves by its clip";
    collider.read("node", mesh.node);
    collider.read("clip", mesh.clip);
    double start = 0;
    const TomlValue time = collider.get("start_time", make_note(any_number("s")));
    if (time && time.read(start, any_number("s"))) mesh.start_time = start;
    collider.refuse("rest", kWhy);
    collider.refuse("frames", kWhy);
    collider.refuse("up", "a glTF file has its y axis up");
  } else {
    for (const std::string_view key : {"node", "clip", "start_time"})
      collider.refuse(key, "only a glTF file (.glb, .gltf) has it");
  }
}

PlacedMesh read_mesh(TomlTable& collider, const std::filesystem::path& folder) {
  PlacedMesh mesh;
  collider.require(
      {"file", "frames"},
      "a mesh file, as in \"body.obj\", or the frames of one that deforms, as in \"body_*.obj\"");
  mesh.source = read_mesh_file(collider, "file", folder);
  if (collider.has("frames")) {
    read_frames(collider, folder, mesh);
  } else {
    collider.refuse("frame_rate", "only a mesh with \"frames\" has it");
  }
  read_gltf_keys(collider, mesh);
  mesh.rest = read_file_name(collider, "rest", folder);
  if (const TomlValue solid = collider.get("solid", {.kind = ParameterKind::flag}))
    solid.read(mesh.solid.emplace());
  mesh.source.weld = true;
  mesh.source.weld_distance = 0;
  collider.refuse("weld", "a collider has no seams; its vertices are always sewn where they coincide");
  collider.refuse("sew", "a collider has no seams; its vertices are always sewn where they coincide");
  collider.read("position", mesh.position, any_number("m"));
  collider.read("rotation", mesh.rotation_deg, any_number("degrees"), "[0, 90, 0]");
  return mesh;
}

/// If "shape" cannot be read, other keys are not checked, because the valid ones are unknown.
Shape read_shape(TomlTable& collider, const std::filesystem::path& folder) {
  const std::vector<std::string> names = {"sphere", "plane", "capsule", "box", "mesh"};
  collider.require({"shape"}, "\"sphere\", \"plane\", \"capsule\", \"box\" or \"mesh\"");
  const int index = collider.find_choice("shape", names);
  if (index >= 0) collider.set_form(names[index]);
  switch (index) {
    case 0:
      return read_sphere(collider);
    case 1:
      return read_plane(collider);
    case 2:
      return read_capsule(collider);
    case 3:
      return read_box(collider);
    case 4:
      return read_mesh(collider, folder);
    default:
      collider.allow_any_keys();
      return Sphere();
  }
}

}  // namespace

std::vector<std::filesystem::path> find_frame_files(const std::filesystem::path& pattern) {
  const std::string name = pattern.filename().string();
  const std::size_t star = name.find('*');
  const std::string begin = name.substr(0, star), end = name.substr(star + 1);
  std::vector<std::filesystem::path> files;
  std::error_code unreadable;
  const std::filesystem::path folder = pattern.has_parent_path() ? pattern.parent_path() : ".";
  for (const auto& entry : std::filesystem::directory_iterator(folder, unreadable)) {
    const std::string candidate = entry.path().filename().string();
    if (candidate.size() >= begin.size() + end.size() && candidate.starts_with(begin) &&
        candidate.ends_with(end))
      files.push_back(entry.path());
  }
  std::sort(files.begin(), files.end());
  return files;
}

std::vector<KeyFrame> read_motion(TomlTable& owner) {
  std::vector<KeyFrame> frames;
  for (TomlTable& table : owner.tables("motion")) {
    KeyFrame frame;
    const bool is_in_order = read_time(table, frames, frame);
    table.read("position", frame.translation, any_number("m"));
    table.read("rotation", frame.angles_deg, any_number("degrees"), "[0, 90, 0]");
    if (is_in_order) frames.push_back(frame);
  }
  return frames;
}

void read_static_friction(TomlTable& table, double friction, double& static_friction) {
  constexpr NumberRule kRule = not_negative();
  const TomlValue value = table.get("static_friction", make_note(kRule));
  if (value && value.read(static_friction, kRule) && static_friction < friction)
    value.mistake("must not be below friction, " + std::to_string(friction));
}

ColliderSceneDesc read_collider(TomlTable table, int number, const std::filesystem::path& folder) {
  ColliderSceneDesc collider;
  collider.name = number == 1 ? "collider" : "collider " + std::to_string(number);
  collider.shape = read_shape(table, folder);
  table.set_form("");
  table.read("name", collider.name);
  table.read("friction", collider.friction, not_negative());
  read_static_friction(table, collider.friction, collider.static_friction);
  collider.motion = RigidMotion(read_motion(table));
  return collider;
}

}  // namespace weft::engine
