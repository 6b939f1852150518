#include <charconv>
#include <optional>

#include "weft/scene/scene_sections.h"

namespace weft::engine {
namespace {

/// Valid selections for pins; a shape that could not be read allows all.
struct Pinnable {
  bool has_corners = true;
  bool is_grid = false;  // certainly
  IntegerRule index = {.least = 0};

  explicit Pinnable(const std::variant<Grid, MeshSource>* shape) {
    if (!shape) return;
    const Grid* grid = std::get_if<Grid>(shape);
    has_corners = is_grid = grid != nullptr;
    if (grid) index.most = grid->num_particles() - 1;
  }
};

/// The whole text as a number.
std::optional<int> parse_int(std::string_view text) {
  int number = 0;
  const char* end = text.data() + text.size();
  const auto result = std::from_chars(text.data(), end, number);
  if (result.ec != std::errc() || result.ptr != end) return {};
  return number;
}

/// "corner:I,J"
std::optional<ParticleSelection> parse_corner(std::string_view text) {
  if (text == "0,0") return GridCorner{0, 0};
  if (text == "1,0") return GridCorner{1, 0};
  if (text == "0,1") return GridCorner{0, 1};
  if (text == "1,1") return GridCorner{1, 1};
  return {};
}

std::optional<ParticleSelection> parse_index(std::string_view text, const IntegerRule& rule) {
  const std::optional<int> index = parse_int(text);
  if (!index || *index < rule.least || *index > rule.most) return {};
  return ParticleIndices{{*index}};
}

std::string describe_index(const IntegerRule& rule) {
  const std::string name = "\"index:N\" with N from " + std::to_string(rule.least);
  return name + (rule.most == INT_MAX ? " on" : " to " + std::to_string(rule.most));
}

std::optional<ParticleSelection> read_corner(const TomlValue& value, std::string_view text,
                                             const Pinnable& pinnable) {
  if (!pinnable.has_corners) {
    value.mistake("a mesh has no corners; pin an index, a group, a box or a sphere");
    return {};
  }
  const std::optional<ParticleSelection> selection = parse_corner(text);
  if (!selection) value.expected("\"corner:0,0\", \"corner:1,0\", \"corner:0,1\" or \"corner:1,1\"");
  return selection;
}

std::optional<ParticleSelection> read_group(const TomlValue& value, std::string_view name,
                                            const Pinnable& pinnable) {
  if (pinnable.is_grid) {
    value.mistake("a grid has no groups; pin a corner, an index, a box or a sphere");
    return {};
  }
  if (name.empty()) {
    value.expected("the name of a group of the mesh's file");
    return {};
  }
  return GroupName{std::string(name)};
}

std::optional<ParticleSelection> read_group(const TomlValue& value, const Pinnable& pinnable) {
  std::string name;
  if (!value.read(name)) return {};
  return read_group(value, name, pinnable);
}

std::optional<ParticleSelection> read_name(const TomlValue& value, const Pinnable& pinnable) {
  std::string text;
  if (!value.read(text)) return {};
  std::optional<ParticleSelection> selection;
  if (text.starts_with("corner:")) {
    selection = read_corner(value, std::string_view(text).substr(7), pinnable);
  } else if (text.starts_with("index:")) {
    selection = parse_index(text.substr(6), pinnable.index);
    if (!selection) value.expected(describe_index(pinnable.index));
  } else if (text.starts_with("group:")) {
    selection = read_group(value, std::string_view(text).substr(6), pinnable);
  } else {
    value.expected("\"corner:0,0\", \"index:12\" or \"group:waist\"");
  }
  return selection;
}

std::optional<ParticleSelection> read_box(TomlTable table) {
  Box box;
  table.require({"min"}, "3 numbers in m");
  table.require({"max"}, "3 numbers in m");
  const bool has_min = table.read("min", box.min, any_number("m"));
  const bool has_max = table.read("max", box.max, any_number("m"));
  const bool is_empty = has_min && has_max && (box.min.array() > box.max.array()).any();
  if (is_empty) table.get("max").mistake("must not be below \"min\"");
  return box;
}

std::optional<ParticleSelection> read_ball(TomlTable table) {
  Sphere sphere;
  table.require({"center"}, "3 numbers in m");
  table.require({"radius"}, "a number above 0 in m");
  table.read("center", sphere.center, any_number("m"));
  table.read("radius", sphere.radius, above_zero("m"));
  return sphere;
}

std::optional<ParticleSelection> read_indices(const TomlValue& value, const Pinnable& pinnable) {
  ParticleIndices selection;
  if (!value.read(selection.indices, pinnable.index)) return {};
  if (selection.indices.empty()) value.expected("at least one index");
  return selection;
}

std::optional<ParticleSelection> read_region(TomlTable table, const Pinnable& pinnable) {
  table.require({"index", "group", "box", "sphere"}, "one of them");
  const TomlValue index = table.get("index", make_note(IntegerRule{.least = 0}, 0)),
                  group = table.get("group", {.kind = ParameterKind::text}), box = table.get("box"),
                  sphere = table.get("sphere");
  if (index) return read_indices(index, pinnable);
  if (group) return read_group(group, pinnable);
  if (box) return read_box(table.table("box"));
  if (sphere) return read_ball(table.table("sphere"));
  return {};
}

std::optional<ParticleSelection> read_select(TomlTable& pin, const Pinnable& pinnable) {
  constexpr std::string_view kForms =
      "\"corner:0,0\", \"index:12\", \"group:waist\", { index = [1, 2] }, { group = \"waist\" }, "
      "{ box = … } or { sphere = … }";
  pin.require({"select"}, kForms);
  const TomlValue select = pin.get("select", {.kind = ParameterKind::table});
  if (!select) return {};
  if (select.is_table()) return read_region(pin.table("select"), pinnable);
  if (select.is_string()) return read_name(select, pinnable);
  select.expected(kForms);
  return {};
}

/// The key "select", or its short form "group".
std::optional<ParticleSelection> read_pin_select(TomlTable& pin, const Pinnable& pinnable) {
  const TomlValue group = pin.get("group", {.kind = ParameterKind::text});
  if (!group) return read_select(pin, pinnable);
  pin.refuse("select", "has the same meaning as group; expected one of the two");
  return read_group(group, pinnable);
}

PinDesc read_pin(TomlTable table, const Pinnable& pinnable) {
  PinDesc pin;
  if (const auto selection = read_pin_select(table, pinnable)) pin.select = *selection;
  pin.motion = read_motion(table);
  table.read("pivot", pin.pivot, any_number("m"));
  table.read("follow", pin.follow);
  double stiffness = 0;
  const TomlValue spring = table.get("stiffness", make_note(not_negative("N/m")));
  if (spring && spring.read(stiffness, not_negative("N/m"))) pin.stiffness = stiffness;
  table.read("damping", pin.damping, not_negative("N·s/m"));
  if (pin.damping > 0 && !spring) table.get("damping").mistake("requires stiffness");
  if (pin.motion.empty()) return pin;
  if (spring) spring.mistake("a pin with a motion is held exactly");
  if (!pin.follow.empty())
    table.get("follow").mistake("a pin that follows a collider has no motion of its own");
  return pin;
}

/// The regions of an array of tables, with their numbers by read_numbers(table, region).
template <class Region, class ReadNumbers>
std::vector<Region> read_regions(TomlTable& cloth, const char* key,
                                 const std::variant<Grid, MeshSource>* shape,
                                 const ReadNumbers& read_numbers) {
  const Pinnable pinnable(shape);
  std::vector<Region> regions;
  for (TomlTable& table : cloth.tables(key)) {
    Region& region = regions.emplace_back();
    if (const auto selection = read_select(table, pinnable)) region.select = *selection;
    read_numbers(table, region);
  }
  return regions;
}

}  // namespace

std::vector<PinDesc> read_pins(TomlTable& cloth, const std::variant<Grid, MeshSource>* shape) {
  const Pinnable pinnable(shape);
  std::vector<PinDesc> pins;
  if (const TomlValue names = cloth.get("pins", {.kind = ParameterKind::texts})) {
    constexpr std::string_view kForm =
        "an array of strings or tables, as in [\"corner:0,0\", { group = \"waist\", follow = \"body\" }]";
    for (const TomlValue& name : names.elements(kForm)) {
      if (name.is_table()) {
        pins.push_back(read_pin(cloth.element("pin", name), pinnable));
      } else if (const auto selection = read_name(name, pinnable)) {
        pins.push_back({.select = *selection, .motion = {}});
      }
    }
  }
  for (const TomlTable& table : cloth.tables("pin")) pins.push_back(read_pin(table, pinnable));
  return pins;
}

std::vector<RestScaleDesc> read_rest_scales(TomlTable& cloth, const std::variant<Grid, MeshSource>* shape) {
  return read_regions<RestScaleDesc>(cloth, "rest_scale", shape, [](TomlTable& table, RestScaleDesc& scale) {
    table.read("warp", scale.warp, above_zero());
    table.read("weft", scale.weft, above_zero());
  });
}

std::vector<StiffenDesc> read_stiffened(TomlTable& cloth, const std::variant<Grid, MeshSource>* shape) {
  return read_regions<StiffenDesc>(cloth, "stiffen", shape, [](TomlTable& table, StiffenDesc& part) {
    table.require({"factor"}, "a number not below 0");
    table.read("factor", part.factor, not_negative());
  });
}

}  // namespace weft::engine
