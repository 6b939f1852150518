#include "weft/scene/fabric_reader.h"

#include <fstream>
#include <iterator>
#include <system_error>

#include "weft/core/error.h"
#include "weft/scene/toml_table.h"

namespace weft {
namespace {

namespace fs = std::filesystem;

/// A key that has no default.
void read_required(TomlTable& table, const char* key, double& target, const NumberRule& rule) {
  table.require({key}, "a number in " + std::string(rule.unit));
  table.read(key, target, rule);
}

Fabric read_numbers(TomlTable& table) {
  Fabric f;
  read_required(table, "density", f.density, above_zero("kg/m²"));
  read_required(table, "c11", f.c11, above_zero("N/m"));
  read_required(table, "c22", f.c22, above_zero("N/m"));
  read_required(table, "c12", f.c12, any_number("N/m"));
  read_required(table, "g", f.g, above_zero("N/m"));
  read_required(table, "bend_warp", f.bend_warp, not_negative("N·m"));
  read_required(table, "bend_weft", f.bend_weft, not_negative("N·m"));
  read_required(table, "bend_bias", f.bend_bias, not_negative("N·m"));
  table.read("damping", f.damping, not_negative("s"));
  table.read("thickness", f.thickness, above_zero("m"));
  table.read("friction", f.friction, not_negative());
  table.read("strain_limit", f.strain_limit, not_negative());
  return f;
}

FabricSources make_sources(const TomlTable& table, const fs::path& file) {
  const std::string given = "given in " + file.generic_string();
  const auto source = [&](const char* key) { return table.has(key) ? given : "default: left out"; };
  return {.density = given,
          .stretch = given,
          .shear = given,
          .bending = given,
          .damping = source("damping"),
          .thickness = source("thickness"),
          .friction = source("friction")};
}

/// Mistakes that only all numbers together show, each at the number that is named. A number that could not be
/// read has its default, and was reported.
void judge_together(TomlTable& table, const Fabric& fabric) {
  for (const FabricMistake& mistake : find_mistakes(fabric)) {
    if (const TomlValue value = table.get(mistake.field)) value.mistake(mistake.reason);
  }
}

[[noreturn]] void fail(const fs::path& file, const std::string& message) {
  throw SceneError({{file.generic_string(), 0, 0, message}});
}

}  // namespace

FabricPreset parse_fabric(std::string_view text, const fs::path& file) {
  TomlDocument document(text, file.generic_string());
  TomlTable table(document, &document.root(), "");
  const Fabric fabric = read_numbers(table);
  judge_together(table, fabric);
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

FabricPreset load_fabric(const std::string& name_or_file) {
  std::error_code not_there;
  const fs::path file = name_or_file;
  const bool is_file = fs::exists(file, not_there) && !fs::is_directory(file, not_there);
  if (is_file || file.extension() == ".toml") return read_fabric_file(file);
  return find_fabric(name_or_file);
}

}  // namespace weft
