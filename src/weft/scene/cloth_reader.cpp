#include <optional>
#include <system_error>

#include "weft/scene/scene_sections.h"

namespace weft {
namespace {

using Shape = std::variant<Grid, MeshFile>;

void read_model(TomlTable& cloth, SpringModel& model) {
  cloth.read_choice<SpringModel>("model", model,
                                 {{"basic", SpringModel::basic},
                                  {"simplified", SpringModel::simplified},
                                  {"alternating", SpringModel::alternating}});
}

std::optional<Shape> read_grid(TomlTable table) {
  std::array<double, 2> size = {};
  std::array<int, 2> cells = {};
  table.require({"size"}, "2 numbers above 0 in m, as in [1, 1]");
  table.require({"cells"}, "2 whole numbers, as in [32, 32]");
  const bool has_size = table.read("size", std::span<double>(size), above_zero("m"), "[1, 1]");
  const bool has_cells = table.read("cells", cells, IntegerRule{1, 4096});
  if (!has_size || !has_cells) return {};
  return Grid{size[0], size[1], cells[0], cells[1]};
}

void read_weld(TomlTable& cloth, MeshFile& mesh) {
  const TomlValue weld = cloth.get("weld");
  if (!weld) return;
  if (weld.is_boolean()) {
    weld.read(mesh.weld);
  } else if (weld.node().is_number()) {
    mesh.weld = weld.read(mesh.weld_distance, not_negative("m"));
  } else {
    weld.expected("true, false or a distance in m");
  }
}

MeshFile read_mesh(TomlTable& cloth, const std::filesystem::path& folder) {
  MeshFile mesh = read_mesh_file(cloth, "mesh", folder);
  read_weld(cloth, mesh);
  return mesh;
}

/// Keys of the other kind of cloth are refused with the reason, rather than being unknown.
std::optional<Shape> read_shape(TomlTable& cloth, SpringModel& model, const std::filesystem::path& folder) {
  cloth.require({"grid", "mesh"}, "grid = { size = [1, 1], cells = [32, 32] } or mesh = \"file.obj\"");
  const TomlValue grid = cloth.get("grid"), mesh = cloth.get("mesh");
  if (mesh && !grid) {
    cloth.refuse("model", "only a grid has it; a mesh's own edges are its springs");
    return read_mesh(cloth, folder);
  }
  read_model(cloth, model);
  const bool is_grid = grid && !mesh;
  for (const char* key : {"up", "scale", "weld"}) {
    if (is_grid) cloth.refuse(key, "only a mesh has it; a grid is in m, and turned by \"rotation\"");
    if (!is_grid) cloth.get(key);
  }
  if (is_grid) return read_grid(cloth.table("grid"));
  return {};
}

void refuse_si_stiffness(TomlTable& fabric) {
  for (const char* key : {"c11", "c22", "c12", "g", "bend_warp", "bend_weft", "bend_bias"}) {
    fabric.refuse(
        key,
        "SI fabric values are not there yet; give spring_structural, spring_shear and spring_bend in N/m");
  }
}

ClothMaterial read_fabric(TomlTable& cloth) {
  ClothMaterial material;
  if (const TomlValue name = cloth.get("fabric"); name && name.is_string()) {
    name.expected(
        "a table, for named fabrics are not there yet; give spring_structural, spring_shear and spring_bend");
    return material;
  }
  TomlTable fabric = cloth.table("fabric");
  fabric.read("spring_structural", material.structural, not_negative("N/m"));
  fabric.read("spring_shear", material.shear, not_negative("N/m"));
  fabric.read("spring_bend", material.bend, not_negative("N/m"));
  fabric.read("density", material.density, above_zero("kg/m²"));
  fabric.read("damping", material.damping, not_negative("N·s/m"));
  fabric.read_choice<DampingKind>("damping_kind", material.damping_kind,
                                  {{"plain", DampingKind::plain}, {"projected", DampingKind::projected}});
  fabric.read("thickness", material.thickness, not_negative("m"));
  fabric.read("friction", material.friction, not_negative());
  refuse_si_stiffness(fabric);
  return material;
}

}  // namespace

MeshFile read_mesh_file(TomlTable& owner, std::string_view key, const std::filesystem::path& folder) {
  MeshFile mesh;
  std::string name;
  std::error_code unreadable;
  const TomlValue value = owner.get(key);
  if (value && value.read(name)) {
    mesh.file = folder / name;
    const bool exists = std::filesystem::is_regular_file(mesh.file, unreadable);
    if (!exists) value.mistake("there is no file " + quote(mesh.file.generic_string(), 1000));
  }
  owner.read_choice<bool>("up", mesh.up_is_z, {{"y", false}, {"z", true}});
  owner.read("scale", mesh.scale, above_zero("m per unit of the file"));
  return mesh;
}

ClothSceneDesc read_cloth(TomlTable table, int number, const std::filesystem::path& folder) {
  ClothSceneDesc cloth;
  cloth.name = number == 1 ? "cloth" : "cloth " + std::to_string(number);
  table.read("name", cloth.name);
  const std::optional<Shape> shape = read_shape(table, cloth.model, folder);
  if (shape) cloth.shape = *shape;
  cloth.material = read_fabric(table);
  table.read("position", cloth.position, any_number("m"));
  table.read("rotation", cloth.rotation_deg, any_number("degrees"), "[0, 90, 0]");
  table.read("velocity", cloth.velocity, any_number("m/s"));
  const NumberRule share = {.low = NumberRule::Low::zero, .most = 1};
  table.read("color", std::span<double>(cloth.color), share, "[0.7, 0.2, 0.1]");
  cloth.pins = read_pins(table, shape ? &*shape : nullptr);
  return cloth;
}

}  // namespace weft
