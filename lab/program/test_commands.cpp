#include <fmt/core.h>

#include <memory>
#include <nlohmann/json.hpp>

#include "apps/common/command_line.h"
#include "lab/program/commands.h"
#include "lab/textile/laboratory_tests.h"
#include "weft/core/make_folder.h"
#include "weft/core/staged_file.h"
#include "weft/error.h"
#include "weft/io/obj_reader.h"
#include "weft/pictures/painter.h"
#include "weft/render/device.h"
#include "weft/scene/fabric_reader.h"

namespace weft::engine::lab {
namespace {

using namespace app;

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

struct StudyOptions {
  std::string fabric;
  SpecimenSettings specimen;
  StripDirection direction = StripDirection::warp;
  int threads = 0;  // 0: all processors
  bool json = false;
  fs::path out;
};

using Test = std::function<Findings(const Fabric&, const StudyOptions&)>;

/// Values by name of the metric, with the expected value and whether it is met.
void add_metrics(const Findings& result, Json& json) {
  Json units = Json::object(), expected = Json::object();
  for (const Metric& f : result.metrics) {
    json[f.name] = f.value;
    units[f.name] = f.unit;
    if (f.expected)
      expected[f.name] = {{"value", *f.expected}, {"tolerance", f.allowed}, {"met", f.is_as_expected()}};
  }
  json["units"] = units;
  if (!expected.empty()) json["expected"] = expected;
  json["warnings"] = result.warnings;
}

std::string dump(const Json& json) { return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n"; }

void write_shape(const fs::path& file, const AnimatedCloth& mesh) {
  TriangleMesh shape{.positions = {}, .triangles = mesh.triangles};
  const std::vector<float>& x = mesh.frames.at(0);
  for (std::size_t i = 0; i < x.size(); i += 3) shape.positions.emplace_back(x[i], x[i + 1], x[i + 2]);
  write_obj(file, shape);
}

void write_files(const fs::path& folder, const Json& json, const Findings& result) {
  write_file(folder / "study.json", dump(json));
  for (const ReportPicture& picture : result.pictures) {
    if (!picture.svg.empty()) write_file(folder / picture.file, picture.svg);
    if (!picture.animation) continue;
    const std::string& file = picture.file;
    write_shape(folder / (file + ".obj"), picture.animation->cloths.at(0));
    FramesInMemory source(*picture.animation);
    Painter painter(source, {.view = {.elevation_deg = 30}, .zoom = 0.9}, make_offscreen_device());
    painter.write_pictures(folder / (file + ".png"), {0}, 1);
  }
}

void print_warnings(const Findings& result) {
  for (const std::string& warning : result.warnings) say("warning: " + warning);
}

/// With --json only one object on standard output; all text goes to standard error.
void run_test(const std::string& name, const Test& test, const StudyOptions& options) {
  const FabricPreset preset = load_fabric(options.fabric);
  if (!options.out.empty()) make_folder(options.out);
  const Findings result = test(preset.fabric, options);
  Json json = {{"study", name}, {"fabric", preset.name}};
  add_metrics(result, json);
  print_warnings(result);
  if (!options.out.empty()) write_files(options.out, json, result);
  if (options.json) {
    fmt::print("{}", dump(json));
    return;
  }
  fmt::print("{} of {}\n", name, preset.name);
  for (const Metric& metric : result.metrics)
    fmt::print("  {:<24} {:.5g} {}\n", metric.name, metric.value, metric.unit == "1" ? "" : metric.unit);
}

void add_threads_option(CLI::App& command, StudyOptions& options) {
  command.add_option("--threads", options.threads, "Threads of simulations (default: all processors)")
      ->check(CLI::Range(1, 1024));
}

void add_membrane_option(CLI::App& command, StudyOptions& options) {
  static const std::map<std::string, SpecimenMembrane> membranes = {{"triangle", SpecimenMembrane::triangle},
                                                                    {"springs", SpecimenMembrane::springs}};
  command
      .add_option("--membrane", options.specimen.membrane,
                  "Elements, or springs that approximate them: triangle (default) or springs")
      ->transform(CLI::CheckedTransformer(membranes));
}

void add_direction_option(CLI::App& command, StudyOptions& options) {
  static const std::map<std::string, StripDirection> directions = {
      {"warp", StripDirection::warp}, {"weft", StripDirection::weft}, {"bias", StripDirection::bias}};
  command
      .add_option("--direction", options.direction,
                  "Direction in which the strip is cut: warp (default), weft or bias")
      ->transform(CLI::CheckedTransformer(directions));
}

std::shared_ptr<StudyOptions> make_options() { return std::make_shared<StudyOptions>(); }

CLI::App* add(CLI::App& studies, const std::string& name, const std::string& about,
              const std::shared_ptr<StudyOptions>& options, const Test& test) {
  CLI::App* command = studies.add_subcommand(name, about);
  command->add_option("--fabric", options->fabric, "A fabric's name (weft fabrics), or a fabric file")
      ->required();
  static const std::map<std::string, SpecimenMesh> meshes = {{"grid", SpecimenMesh::grid},
                                                             {"random", SpecimenMesh::random}};
  command->add_option("--mesh", options->specimen.mesh, "Regular or irregular: grid (default) or random")
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

void add_study_command(CLI::App& app) {
  CLI::App* studies =
      app.add_subcommand("study", "A laboratory's standard tests of a fabric, and studies of Weft itself");
  studies->require_subcommand(1);
  add_section_commands(*studies);
  const auto strip = make_options(), bent = make_options();
  CLI::App* cantilever = add(*studies, "cantilever", "Bending length: a strip bends under its own weight",
                             strip, [](const Fabric& fabric, const StudyOptions& options) {
                               return test_cantilever(fabric, options.specimen, options.direction);
                             });
  add_direction_option(*cantilever, *strip);
  CLI::App* bending = add(*studies, "bending", "B and 2HB of KES-F: a strip is bent to an arc and back", bent,
                          [](const Fabric& fabric, const StudyOptions& options) {
                            return test_bending(fabric, options.specimen, options.direction);
                          });
  add_direction_option(*bending, *bent);
  const auto pulled = make_options(), sheared = make_options();
  CLI::App* tensile = add(*studies, "tensile", "c11, c22 and c12: stretching between clamps", pulled,
                          [](const Fabric& fabric, const StudyOptions& options) {
                            return test_tensile(fabric, options.specimen);
                          });
  add_membrane_option(*tensile, *pulled);
  CLI::App* shear = add(
      *studies, "shear", "g: simple shear between clamps", sheared,
      [](const Fabric& fabric, const StudyOptions& options) { return test_shear(fabric, options.specimen); });
  add_membrane_option(*shear, *sheared);
  add(*studies, "buckling", "Load at which an upright strip tips over", make_options(),
      [](const Fabric& fabric, const StudyOptions& options) {
        return test_buckling(fabric, options.specimen);
      });
  const auto disc = make_options();
  CLI::App* drape =
      add(*studies, "drape", "Drape coefficient (ISO 9073-9): the shadow of a disc that hangs over plates",
          disc, [](const Fabric& fabric, const StudyOptions& options) {
            return test_drape(fabric, options.specimen, choose_threads(options.threads));
          });
  add_threads_option(*drape, *disc);
}

}  // namespace weft::engine::lab
