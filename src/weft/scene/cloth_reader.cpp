#include <algorithm>
#include <array>
#include <optional>
#include <span>
#include <system_error>

#include "weft/error.h"
#include "weft/fabric/bending_rows.h"
#include "weft/scene/fabric_reader.h"
#include "weft/scene/scene_sections.h"

namespace weft::engine {
namespace {

using Shape = std::variant<Grid, MeshSource>;

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

void read_weld(TomlTable& cloth, MeshSource& mesh) {
  constexpr NumberRule kDistance = not_negative("m");
  Parameter note = make_note(kDistance);
  note.choices = {"true", "false"};
  note.default_value = "false";
  const TomlValue weld = cloth.get("weld", std::move(note));
  if (!weld) return;
  if (weld.is_boolean()) {
    weld.read(mesh.weld);
  } else if (weld.node().is_number()) {
    mesh.weld = weld.read(mesh.weld_distance, kDistance);
  } else {
    weld.expected("true, false or a distance in m");
  }
}

MeshSource read_mesh(TomlTable& cloth, const std::filesystem::path& folder) {
  MeshSource mesh = read_mesh_file(cloth, "mesh", folder);
  read_weld(cloth, mesh);
  cloth.read("sew", mesh.sew_distance, above_zero("m"));
  return mesh;
}

/// "uv", { uv_scale = … } or { mesh = … }.
std::optional<RestDesc> read_rest(TomlTable& cloth, const std::filesystem::path& folder) {
  constexpr std::string_view kForms = "\"uv\", { uv_scale = 0.01 } or { mesh = \"pattern.obj\" }";
  const TomlValue value = cloth.get("rest", {.kind = ParameterKind::table});
  std::string name;
  if (value && value.is_string()) {
    value.read(name);
    if (name != "uv") value.expected(kForms);
    return RestDesc{};
  }
  if (value && !value.is_table()) {
    value.expected(kForms);
    return {};
  }
  TomlTable table = cloth.table("rest");
  const bool has_mesh = table.has("mesh");
  RestDesc rest;
  MeshSource mesh = read_mesh_file(table, "mesh", folder);
  if (has_mesh) {
    rest.mesh = std::move(mesh);
    table.refuse("uv_scale", "is the unit of texture coordinates; a mesh has \"scale\"");
    return rest;
  }
  for (const char* key : {"up", "scale"})
    table.refuse(key, "requires \"mesh\"; texture coordinates have \"uv_scale\"");
  constexpr NumberRule rule = above_zero("m per unit of texture coordinates");
  if (const TomlValue scale = table.get("uv_scale", make_note(rule)))
    scale.read(rest.uv_scale.emplace(), rule);
  return value ? std::optional(rest) : std::nullopt;
}

/// Keys of the other kind of cloth are refused with the reason, not as unknown.
std::optional<Shape> read_shape(TomlTable& cloth, ClothSceneDesc& desc, const std::filesystem::path& folder) {
  cloth.require({"grid", "mesh"}, "grid = { size = [1, 1], cells = [32, 32] } or mesh = \"file.obj\"");
  const TomlValue grid = cloth.get("grid"), mesh = cloth.get("mesh");
  if (mesh && !grid) {
    cloth.refuse("model", "only a grid has it; the springs of a mesh are its edges");
    cloth.set_form("mesh");
    desc.rest = read_rest(cloth, folder);
    cloth.read("stitches", desc.has_stitches);
    return read_mesh(cloth, folder);
  }
  cloth.set_form("grid");
  read_model(cloth, desc.model);
  const bool is_grid = grid && !mesh;
  for (const char* key : {"up", "scale", "weld", "sew", "rest", "stitches"}) {
    if (is_grid) cloth.refuse(key, "only a mesh has it; a grid is in m, rotated by \"rotation\"");
    if (!is_grid) cloth.get(key);
  }
  if (is_grid) return read_grid(cloth.table("grid"));
  return {};
}

constexpr std::array kSpringKeys = {"spring_structural", "spring_shear", "spring_bend", "damping_kind"};
constexpr std::array kSiKeys = {"c11",
                                "c22",
                                "c12",
                                "g",
                                "bend_warp",
                                "bend_weft",
                                "bend_bias",
                                "bend_hysteresis_warp",
                                "bend_hysteresis_weft",
                                "bend_set",
                                "strain_limit",
                                "strength",
                                "stretch_warp",
                                "stretch_weft"};

ClothMaterial read_springs(TomlTable& fabric) {
  ClothMaterial material;
  fabric.read("spring_structural", material.structural, not_negative("N/m"));
  fabric.read("spring_shear", material.shear, not_negative("N/m"));
  fabric.read("spring_bend", material.bend, not_negative("N/m"));
  fabric.read("density", material.density, above_zero("kg/m²"));
  fabric.read("damping", material.damping, not_negative("N·s/m"));
  fabric.read_choice<DampingKind>("damping_kind", material.damping_kind,
                                  {{"plain", DampingKind::plain}, {"projected", DampingKind::projected}});
  fabric.read("thickness", material.thickness, not_negative("m"));
  fabric.read("friction", material.friction, not_negative());
  for (const char* key : kSiKeys) fabric.get(key);
  return material;
}

bool has_any(const TomlTable& table, std::span<const char* const> keys) {
  return std::any_of(keys.begin(), keys.end(), [&](const char* key) { return table.has(key); });
}

std::optional<FabricDesc> read_named_fabric(const TomlValue& value, const std::filesystem::path& folder) {
  std::string name;
  if (!value.read(name)) return {};
  try {
    const FabricPreset preset = load_fabric(name, folder);
    return FabricDesc{.name = preset.name, .numbers = preset.fabric};
  } catch (const InputError& error) {
    value.mistake(error.what());
    return {};
  }
}

/// A fabric by name, file or SI numbers; empty if the cloth has spring stiffnesses instead.
std::optional<FabricDesc> read_fabric(TomlTable& cloth, ClothMaterial& material,
                                      const std::filesystem::path& folder) {
  if (const TomlValue name = cloth.get("fabric"); name && name.is_string())
    return read_named_fabric(name, folder);
  TomlTable table = cloth.table("fabric");
  const TomlValue base = table.get("base");
  const bool has_springs = !base && !has_any(table, kSiKeys);
  table.set_form(has_springs ? "springs" : "fabric");
  if (has_springs) {
    material = read_springs(table);
    return {};
  }
  for (const char* key : kSpringKeys)
    table.refuse(key, "a fabric has either spring stiffnesses or SI values (c11 to bend_bias)");
  FabricDesc fabric{.name = "fabric", .numbers = {}};
  table.note("base", {.kind = ParameterKind::text});
  if (base) fabric = read_named_fabric(base, folder).value_or(fabric);
  table.read("name", fabric.name);
  fabric.numbers = read_fabric_numbers(table, false, fabric.numbers);
  return fabric;
}

void read_warp(TomlTable& cloth, FabricDesc& fabric) {
  constexpr NumberRule kRule = any_number();
  const TomlValue warp = cloth.get("warp", make_note(kRule, 3));
  Vec3 direction;
  if (!warp || !warp.read(direction, kRule, "[1, 0, 0]")) return;
  if (direction.norm() < 1e-6) warp.expected("a direction");
  fabric.warp = direction;
}

/// Keys that require a fabric; material and model that follow from a fabric.
void finish_fabric(TomlTable& cloth, ClothSceneDesc& desc) {
  if (!desc.fabric) {
    for (const char* key : {"membrane", "warp", "rest_scale"})
      cloth.refuse(key, "requires a fabric by name, file or SI values; this one has spring stiffnesses");
    return;
  }
  cloth.read_choice<Membrane>("membrane", desc.fabric->membrane,
                              {{"triangle", Membrane::triangle}, {"springs", Membrane::springs}});
  read_warp(cloth, *desc.fabric);
  const Fabric& f = desc.fabric->numbers;
  desc.material = {.density = f.density,
                   .structural = 0,
                   .shear = 0,
                   .bend = 0,
                   .thickness = f.thickness,
                   .friction = f.friction};
  const bool is_grid = std::holds_alternative<Grid>(desc.shape);
  if (is_grid && !cloth.has("model")) desc.model = SpringModel::alternating;
  if (!is_grid && desc.fabric->membrane == Membrane::springs && f.strain_limit > 0)
    cloth.get("membrane").expected("\"triangle\": springs support a strain_limit on grids only");
  if (desc.fabric->membrane == Membrane::springs && f.strength > 0)
    cloth.get("membrane").expected("\"triangle\": springs do not tear");
  if (f.strength > 0 && has_bending_memory(f))
    cloth.get("fabric").mistake(
        "cloth with hysteresis or set of bending does not tear; set "
        "bend_hysteresis_warp, bend_hysteresis_weft and bend_set to 0, or strength");
}

std::vector<Seam> read_seams(TomlTable& cloth) {
  std::vector<Seam> seams;
  for (TomlTable& table : cloth.tables("seam")) {
    Seam& seam = seams.emplace_back();
    for (const auto& [key, side] : {std::pair("a", &seam.a), std::pair("b", &seam.b)}) {
      table.require({key}, "at least two vertices on a border, as in [0, 24]");
      const TomlValue vertices = table.get(key, make_note(IntegerRule{.least = 0}, 0));
      if (vertices) vertices.read(*side, IntegerRule{.least = 0});
    }
  }
  return seams;
}

}  // namespace

std::filesystem::path read_file_name(TomlTable& owner, std::string_view key,
                                     const std::filesystem::path& folder) {
  std::string name;
  std::error_code unreadable;
  const TomlValue value = owner.get(key, {.kind = ParameterKind::file});
  if (!value || !value.read(name)) return {};
  const std::filesystem::path file = folder / name;
  const bool exists = std::filesystem::is_regular_file(file, unreadable);
  if (!exists) value.mistake("there is no file " + quote(file.generic_string(), 1000));
  return file;
}

MeshSource read_mesh_file(TomlTable& owner, std::string_view key, const std::filesystem::path& folder) {
  MeshSource mesh;
  mesh.file = read_file_name(owner, key, folder);
  owner.read_choice<bool>("up", mesh.up_is_z, {{"y", false}, {"z", true}});
  owner.read("scale", mesh.scale, above_zero("m per unit of the file"));
  return mesh;
}

ClothSceneDesc read_cloth(TomlTable table, int number, const std::filesystem::path& folder) {
  ClothSceneDesc cloth;
  cloth.name = number == 1 ? "cloth" : "cloth " + std::to_string(number);
  table.read("name", cloth.name);
  const std::optional<Shape> shape = read_shape(table, cloth, folder);
  table.set_form("");
  if (shape) cloth.shape = *shape;
  cloth.fabric = read_fabric(table, cloth.material, folder);
  const TomlValue fabric = table.get("fabric");
  cloth.has_own_thickness =
      cloth.fabric || (fabric && fabric.is_table() && fabric.node().as_table()->contains("thickness"));
  finish_fabric(table, cloth);
  table.read("position", cloth.position, any_number("m"));
  table.read("rotation", cloth.rotation_deg, any_number("degrees"), "[0, 90, 0]");
  table.read("velocity", cloth.velocity, any_number("m/s"));
  table.read("pressure", cloth.pressure, any_number("Pa"));
  table.read("sealed", cloth.is_sealed);
  const NumberRule share = {.low = NumberRule::Low::zero, .most = 1};
  table.read("color", std::span<double>(cloth.color), share, "[0.7, 0.2, 0.1]");
  cloth.pins = read_pins(table, shape ? &*shape : nullptr);
  if (cloth.fabric && cloth.fabric->membrane == Membrane::triangle)
    table.refuse("stiffen", "requires springs: set spring stiffnesses, or membrane = \"springs\"");
  cloth.stiffened = read_stiffened(table, shape ? &*shape : nullptr);
  cloth.rest_scales = read_rest_scales(table, shape ? &*shape : nullptr);
  table.read("layer", cloth.layer, IntegerRule{-100, 100});
  cloth.seams = read_seams(table);
  table.read("seam_time", cloth.seam_time, not_negative("s"));
  constexpr NumberRule stiffness = not_negative("N/m²");
  if (const TomlValue given = table.get("seam_stiffness", make_note(stiffness)))
    given.read(cloth.seam_stiffness.emplace(), stiffness);
  return cloth;
}

}  // namespace weft::engine
