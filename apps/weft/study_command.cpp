#include <fmt/core.h>

#include <algorithm>
#include <fstream>
#include <memory>
#include <nlohmann/json.hpp>

#include "commands.h"
#include "common.h"
#include "painter.h"
#include "weft/core/error.h"
#include "weft/io/obj_reader.h"
#include "weft/lab/studies.h"
#include "weft/render/device.h"
#include "weft/scene/fabric_reader.h"

namespace weft::app {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

struct StudyOptions {
  std::string fabric;
  SpecimenSettings specimen;
  StripDirection direction = StripDirection::warp;
  int threads = num_processors();
  bool json = false, quick = false;
  fs::path out;
};

using Test = std::function<StudyResult(const Fabric&, const StudyOptions&)>;

/// Values under the figures' names; what was expected, and whether that is met, beside.
void add_figures(const StudyResult& result, Json& json) {
  Json units = Json::object(), expected = Json::object();
  for (const Figure& f : result.figures) {
    json[f.name] = f.value;
    units[f.name] = f.unit;
    if (f.expected)
      expected[f.name] = {{"value", *f.expected}, {"tolerance", f.tolerance}, {"met", f.is_as_expected()}};
  }
  json["units"] = units;
  if (!expected.empty()) json["expected"] = expected;
  json["warnings"] = result.warnings;
}

std::string dump(const Json& json) { return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n"; }

void write_text(const fs::path& file, const std::string& text) {
  std::ofstream stream(file);
  stream << text;
  if (!stream.flush()) throw InputError(file.string() + ": cannot be written");
}

void write_shape(const fs::path& file, const AnimatedMesh& mesh) {
  TriangleMesh shape{.positions = {}, .triangles = mesh.triangles};
  const std::vector<float>& x = mesh.frames.at(0);
  for (std::size_t i = 0; i < x.size(); i += 3) shape.positions.emplace_back(x[i], x[i + 1], x[i + 2]);
  write_obj(file, shape);
}

void write_files(const fs::path& folder, const Json& json, const StudyResult& result) {
  write_text(folder / "study.json", dump(json));
  for (const StudyPlot& plot : result.plots) write_text(folder / (plot.file + ".svg"), to_svg(plot));
  for (const auto& [file, animation] : result.pictures) {
    write_shape(folder / (file + ".obj"), animation.cloths.at(0));
    Painter painter(animation, {.view = {.elevation_deg = 30}, .zoom = 0.9}, make_offscreen_device());
    painter.write_pictures(folder / (file + ".png"), {0}, 1);
  }
}

void print_warnings(const StudyResult& result) {
  for (const std::string& warning : result.warnings) fmt::print(stderr, "warning: {}\n", warning);
}

/// With --json one object on standard output, and nothing else; all words go to standard error.
void run_test(const std::string& name, const Test& test, const StudyOptions& options) {
  const FabricPreset preset = load_fabric(options.fabric);
  if (!options.out.empty()) make_folder(options.out);
  const StudyResult result = test(preset.fabric, options);
  Json json = {{"study", name}, {"fabric", preset.name}};
  add_figures(result, json);
  print_warnings(result);
  if (!options.out.empty()) write_files(options.out, json, result);
  if (options.json) {
    fmt::print("{}", dump(json));
    return;
  }
  fmt::print("{} of {}\n", name, preset.name);
  for (const Figure& figure : result.figures)
    fmt::print("  {:<24} {:.5g} {}\n", figure.name, figure.value, figure.unit == "1" ? "" : figure.unit);
}

/// Runs a study of the list, and leaves its figures, tables, plots and pictures in a folder.
Json run_study(const Study& study, const StudyOptions& options, const fs::path& folder) {
  StudySettings settings{.quick = options.quick, .threads = options.threads};
  settings.say = [&](const std::string& words) { fmt::print(stderr, "{}: {}\n", study.name, words); };
  const StudyResult result = study.run(settings);
  Json json = {{"study", study.name}, {"group", study.group}, {"quick", options.quick}};
  add_figures(result, json);
  print_warnings(result);
  const std::string text = to_markdown(study, result);
  if (!folder.empty()) {
    make_folder(folder);
    write_files(folder, json, result);
    write_text(folder / "study.md", text);
  }
  if (!options.json) fmt::print("{}\n", text);
  return json;
}

void run_all(const std::vector<std::string>& only, const StudyOptions& options) {
  Json studies = Json::array();
  for (const Study& study : all_studies()) {
    const bool is_wanted = only.empty() || std::find(only.begin(), only.end(), study.group) != only.end();
    if (!is_wanted) continue;
    studies.push_back(run_study(study, options, options.out.empty() ? "" : options.out / study.name));
  }
  const Json json = {{"studies", studies}};
  if (!options.out.empty()) write_text(options.out / "studies.json", dump(json));
  if (options.json) fmt::print("{}", dump(json));
}

std::vector<std::string> groups() {
  std::vector<std::string> names;
  for (const Study& study : all_studies()) {
    if (std::find(names.begin(), names.end(), study.group) == names.end()) names.push_back(study.group);
  }
  return names;
}

void add_threads_option(CLI::App& command, StudyOptions& options) {
  command.add_option("--threads", options.threads, "Threads of simulations (default: all processors)")
      ->check(CLI::Range(1, 1024));
}

void add_run_options(CLI::App& command, StudyOptions& options) {
  command.add_flag("--quick", options.quick, "Fewer cases on coarser meshes");
  command.add_flag("--json", options.json, "Print one JSON object");
  command.add_option("--out", options.out, "A folder for tables, plots, pictures and study.json")
      ->type_name("DIR");
  add_threads_option(command, options);
}

std::shared_ptr<StudyOptions> make_options() { return std::make_shared<StudyOptions>(); }

/// The studies of the list, each by its name and all together.
void add_studies(CLI::App& studies) {
  const auto options = make_options();
  const auto only = std::make_shared<std::vector<std::string>>();
  CLI::App* all = studies.add_subcommand("all", "Every study below, or those of one group");
  add_run_options(*all, *options);
  all->add_option("--only", *only, "Studies of this group")->check(CLI::IsMember(groups()));
  all->callback([options, only] { run_all(*only, *options); });
  for (const Study& study : all_studies()) {
    const auto own = make_options();
    CLI::App* command = studies.add_subcommand(study.name, study.about);
    add_run_options(*command, *own);
    command->callback([&study, own] {
      const Json json = run_study(study, *own, own->out);
      if (own->json) fmt::print("{}", dump(json));
    });
  }
}

CLI::App* add(CLI::App& studies, const std::string& name, const std::string& about,
              const std::shared_ptr<StudyOptions>& options, const Test& test) {
  CLI::App* command = studies.add_subcommand(name, about);
  command->add_option("--fabric", options->fabric, "A fabric's name (weft fabrics), or a fabric file")
      ->required();
  static const std::map<std::string, SpecimenMesh> meshes = {{"grid", SpecimenMesh::grid},
                                                             {"random", SpecimenMesh::random}};
  command->add_option("--mesh", options->specimen.mesh, "Regular or crooked: grid (default) or random")
      ->transform(CLI::CheckedTransformer(meshes));
  command
      ->add_option("--resolution", options->specimen.resolution,
                   "Cells along the specimen, or rings of a disc")
      ->check(CLI::Range(4, 500));
  command->add_flag("--json", options->json, "Print one JSON object");
  command->add_option("--out", options->out, "A folder for study.json, specimen.obj and specimen.png")
      ->type_name("DIR");
  command->callback([name, test, options] { run_test(name, test, *options); });
  return command;
}

}  // namespace

void add_study_command(CLI::App& app, int&) {
  CLI::App* studies =
      app.add_subcommand("study", "A laboratory's standard tests of a fabric, and studies of Weft itself");
  studies->require_subcommand(1);
  const auto strip = make_options();
  CLI::App* cantilever = add(*studies, "cantilever", "Bending length: a strip sinks under its own weight",
                             strip, [](const Fabric& fabric, const StudyOptions& options) {
                               return study_cantilever(fabric, options.specimen, options.direction);
                             });
  static const std::map<std::string, StripDirection> directions = {
      {"warp", StripDirection::warp}, {"weft", StripDirection::weft}, {"bias", StripDirection::bias}};
  cantilever
      ->add_option("--direction", strip->direction,
                   "Which way the strip is cut: warp (default), weft or bias")
      ->transform(CLI::CheckedTransformer(directions));
  add(*studies, "tensile", "c11, c22 and c12 between clamps that draw apart", make_options(),
      [](const Fabric& fabric, const StudyOptions& options) {
        return study_tensile(fabric, options.specimen);
      });
  add(*studies, "shear", "g between clamps that slide", make_options(),
      [](const Fabric& fabric, const StudyOptions& options) {
        return study_shear(fabric, options.specimen);
      });
  add(*studies, "buckling", "Load at which an upright strip tips over", make_options(),
      [](const Fabric& fabric, const StudyOptions& options) {
        return study_buckling(fabric, options.specimen);
      });
  const auto disc = make_options();
  CLI::App* drape =
      add(*studies, "drape", "Drape coefficient (ISO 9073-9): the shadow of a disc that hangs over plates",
          disc, [](const Fabric& fabric, const StudyOptions& options) {
            return study_drape(fabric, options.specimen, options.threads);
          });
  add_threads_option(*drape, *disc);
  add_studies(*studies);
}

}  // namespace weft::app
