#include <fmt/core.h>

#include <memory>
#include <nlohmann/json.hpp>

#include "commands.h"
#include "weft/scene/fabric_reader.h"

namespace weft::engine::app {
namespace {

/// One displayed number of a fabric.
struct Row {
  const char* key;
  double value;
  const char* unit;
  const std::string* source;
};

std::vector<Row> rows(const FabricPreset& preset) {
  const Fabric& f = preset.fabric;
  const FabricSources& s = preset.sources;
  std::vector<Row> rows = {{"density", f.density, "kg/m²", &s.density},
                           {"c11", f.c11, "N/m", &s.stretch},
                           {"c22", f.c22, "N/m", &s.stretch},
                           {"c12", f.c12, "N/m", &s.stretch},
                           {"g", f.g, "N/m", &s.shear},
                           {"bend_warp", f.bend_warp, "N·m", &s.bending},
                           {"bend_weft", f.bend_weft, "N·m", &s.bending},
                           {"bend_bias", f.bend_bias, "N·m", &s.bending},
                           {"damping", f.damping, "s", &s.damping},
                           {"thickness", f.thickness, "m", &s.thickness},
                           {"friction", f.friction, "1", &s.friction}};
  if (f.bend_hysteresis_warp > 0)
    rows.push_back({"bend_hysteresis_warp", f.bend_hysteresis_warp, "N", &s.bending});
  if (f.bend_hysteresis_weft > 0)
    rows.push_back({"bend_hysteresis_weft", f.bend_hysteresis_weft, "N", &s.bending});
  if (f.bend_set > 0) rows.push_back({"bend_set", f.bend_set, "1/m", &s.bending});
  if (f.strength > 0) rows.push_back({"strength", f.strength, "N/m", &s.stretch});
  if (f.strain_limit > 0) rows.push_back({"strain_limit", f.strain_limit, "1", &s.stretch});
  return rows;
}

using Curves = std::vector<std::pair<const char*, const std::vector<StretchPoint>*>>;

/// The fabric's stretch curves.
Curves curves(const Fabric& f) {
  Curves all = {{"stretch_warp", &f.stretch_warp}, {"stretch_weft", &f.stretch_weft}};
  std::erase_if(all, [](const auto& curve) { return curve.second->empty(); });
  return all;
}

void print(const FabricPreset& preset) {
  fmt::print("# {}: {}\n", preset.name, preset.title);
  for (const Row& row : rows(preset)) {
    fmt::print("{:<9} = {:<10.10g} # [{}] {}\n", row.key, row.value, row.unit, *row.source);
  }
  for (const auto& [key, points] : curves(preset.fabric)) {
    std::string text;
    for (const StretchPoint& p : *points)
      text += fmt::format("{}[{:g}, {:g}]", text.empty() ? "" : ", ", p.strain, p.tension);
    fmt::print("{} = [{}] # [1, N/m] {}\n", key, text, preset.sources.stretch);
  }
}

nlohmann::ordered_json to_json(const FabricPreset& preset) {
  nlohmann::ordered_json json = {{"name", preset.name}, {"title", preset.title}};
  nlohmann::ordered_json units, sources;
  for (const Row& row : rows(preset)) {
    json[row.key] = row.value;
    units[row.key] = row.unit;
    sources[row.key] = *row.source;
  }
  for (const auto& [key, points] : curves(preset.fabric)) {
    for (const StretchPoint& p : *points) json[key].push_back({p.strain, p.tension});
    units[key] = {"1", "N/m"};
    sources[key] = preset.sources.stretch;
  }
  json["units"] = units;
  json["sources"] = sources;
  return json;
}

void print_json(const nlohmann::ordered_json& json) {
  fmt::print("{}\n", json.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace));
}

void list(bool json) {
  if (json) {
    nlohmann::ordered_json fabrics = nlohmann::ordered_json::array();
    for (const FabricPreset& preset : fabric_presets()) fabrics.push_back(to_json(preset));
    return print_json({{"fabrics", fabrics}});
  }
  for (const FabricPreset& preset : fabric_presets()) fmt::print("{:<20} {}\n", preset.name, preset.title);
}

void show(const std::string& name_or_file, bool json) {
  const FabricPreset preset = load_fabric(name_or_file);
  if (json) return print_json(to_json(preset));
  print(preset);
}

}  // namespace

void add_fabrics_command(CLI::App& app, int&) {
  auto name = std::make_shared<std::string>();
  auto json = std::make_shared<bool>(false);
  CLI::App* command = app.add_subcommand("fabrics", "List the named fabrics, or show one");
  command->add_option("FABRIC", *name, "A name, or a fabric file; omit it to list the names");
  command->add_flag("--json", *json, "Print JSON");
  command->footer("The output for one fabric is a valid fabric file.");
  command->callback([name, json] { name->empty() ? list(*json) : show(*name, *json); });
}

}  // namespace weft::engine::app
