#include "weft/scene/fabric_reader.h"

#include <array>
#include <fstream>
#include <iterator>
#include <span>
#include <system_error>

#include "weft/error.h"
#include "weft/fabric/fabric_ranges.h"
#include "weft/scene/scene_sections.h"

namespace weft::engine {
namespace {

namespace fs = std::filesystem;

FabricSources make_sources(const TomlTable& table, const fs::path& file) {
  const std::string given = "given in " + file.generic_string();
  const auto source = [&](const char* key) { return table.has(key) ? given : "default: not given"; };
  return {.density = given,
          .stretch = given,
          .shear = given,
          .bending = given,
          .damping = source("damping"),
          .thickness = source("thickness"),
          .friction = source("friction")};
}

[[noreturn]] void fail(const fs::path& file, const std::string& message) {
  throw SceneError({{file.generic_string(), 0, 0, message}});
}

/// Points of a stretch curve.
void read_curve(TomlTable& table, const char* key, std::vector<StretchPoint>& curve) {
  constexpr std::string_view kForm = "points of strain and tension in N/m, as in [[0.01, 20], [0.02, 60]]";
  constexpr NumberRule kRule = above_zero();
  Parameter note = make_note(kRule);
  note.kind = ParameterKind::pairs;
  const TomlValue value = table.get(key, std::move(note));
  if (!value) return;
  for (const TomlValue& point : value.elements(kForm)) {
    std::array<double, 2> numbers = {};
    if (point.read(std::span<double>(numbers), kRule, "[0.01, 20]"))
      curve.push_back({numbers[0], numbers[1]});
  }
}

/// Validates the combination of all numbers; each mistake is reported at the number that it names.
/// Unreadable numbers have their defaults here, and have already been reported.
void check_fabric(TomlTable& table, const Fabric& fabric) {
  for (const FabricMistake& mistake : find_mistakes(fabric)) {
    if (const TomlValue value = table.get(mistake.field))
      value.mistake(mistake.reason);
    else if (table.has("base"))
      table.get("base").mistake("its " + mistake.field + ' ' + mistake.reason);
  }
}

}  // namespace

Fabric read_fabric_numbers(TomlTable& table, bool needs_all, const Fabric& base) {
  Fabric f = base;
  // A stiffness in the table replaces the curve of the base.
  if (table.has("c11")) f.stretch_warp.clear();
  if (table.has("c22")) f.stretch_weft.clear();
  const auto read = [&](const char* key, double& target, const NumberRule& rule) {
    if (needs_all) table.require({key}, "a number in " + std::string(rule.unit));
    table.read(key, target, rule);
  };
  read("density", f.density, above_zero("kg/m²"));
  read("c11", f.c11, above_zero("N/m"));
  read("c22", f.c22, above_zero("N/m"));
  read("c12", f.c12, any_number("N/m"));
  read("g", f.g, above_zero("N/m"));
  read("bend_warp", f.bend_warp, not_negative("N·m"));
  read("bend_weft", f.bend_weft, not_negative("N·m"));
  read("bend_bias", f.bend_bias, not_negative("N·m"));
  table.read("bend_hysteresis_warp", f.bend_hysteresis_warp, not_negative("N"));
  table.read("bend_hysteresis_weft", f.bend_hysteresis_weft, not_negative("N"));
  table.read("bend_set", f.bend_set, not_negative("1/m"));
  // check_fabric() refuses numbers out of the range, with its own message.
  const auto read_within = [&](const char* key, double& target, const NumberRule& rule,
                               const FabricRange& range) {
    Parameter note = make_note(target, rule);
    note.min = range.min;
    note.max = range.max;
    note.excludes_min = false;
    if (const TomlValue value = table.get(key, std::move(note))) value.read(target, rule);
  };
  read_within("damping", f.damping, not_negative("s"), kDampingRange);
  read_within("thickness", f.thickness, above_zero("m"), kThicknessRange);
  read_within("friction", f.friction, not_negative(), kFrictionRange);
  read_within("strain_limit", f.strain_limit, not_negative(), kStrainLimitRange);
  table.read("strength", f.strength, not_negative("N/m"));
  read_curve(table, "stretch_warp", f.stretch_warp);
  read_curve(table, "stretch_weft", f.stretch_weft);
  check_fabric(table, f);
  return f;
}

FabricPreset parse_fabric(std::string_view text, const fs::path& file) {
  TomlDocument document(text, file.generic_string());
  TomlTable table(document, &document.root(), "");
  const Fabric fabric = read_fabric_numbers(table, true);
  FabricPreset preset{file.stem().string(), file.generic_string(), fabric, make_sources(table, file)};
  std::vector<Diagnostic> mistakes = document.finish();
  if (!mistakes.empty()) throw SceneError(std::move(mistakes));
  return preset;
}

FabricPreset read_fabric_file(const fs::path& file) {
  std::error_code not_there;
  if (fs::is_directory(file, not_there)) fail(file, "expected a fabric file, found a folder");
  std::ifstream stream(file, std::ios::binary);
  if (!stream) fail(file, "cannot be opened");
  const std::string text{std::istreambuf_iterator<char>(stream), {}};
  if (stream.bad()) fail(file, "cannot be read");
  return parse_fabric(text, file);
}

FabricPreset load_fabric(const std::string& name_or_file, const fs::path& folder) {
  std::error_code not_there;
  const fs::path file = folder / name_or_file;
  const bool is_file = fs::exists(file, not_there) && !fs::is_directory(file, not_there);
  if (is_file || file.extension() == ".toml") return read_fabric_file(file);
  return find_fabric_preset(name_or_file);
}

}  // namespace weft::engine
