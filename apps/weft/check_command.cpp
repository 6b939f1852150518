#include <fmt/core.h>

#include <memory>
#include <optional>

#include "apps/common/command_line.h"
#include "apps/common/progress.h"
#include "commands.h"
#include "weft/error.h"
#include "weft/run/start_check.h"
#include "weft/scene/scene_library.h"
#include "weft/scene/scene_reader.h"
#include "weft/scene/scene_world.h"

namespace weft::engine::app {
namespace {

/// Reads the scene and builds its world, which also checks meshes, pins, sizes and the initial state. Returns
/// whether there is no warning. Throws InputError for a start that a run refuses.
bool check(const std::string& name, const Overrides& overrides) {
  const std::filesystem::path file = find_scene(name);
  const SceneDesc scene = read_scene(file, overrides);
  ProgressBar bar(scene.name);
  const SceneWorld built =
      build_world(scene, make_serial_jobs(), [&bar](const std::string& what) { bar.prepare(what); });
  bar.clear();
  const SizeCheck sizes = check_sizes(scene, built.world);
  for (const std::string& line : sizes.sizes) fmt::print("  {}\n", line);
  for (const std::string& note : built.notes) fmt::print("  {}\n", note);
  std::vector<std::string> warnings = built.warnings;
  const auto add = [&](const std::vector<std::string>& found) {
    warnings.insert(warnings.end(), found.begin(), found.end());
  };
  add(sizes.warnings);
  const std::vector<std::string> crossed =
      scene.contact ? check_start(built.world) : std::vector<std::string>();
  const std::optional<std::string> refusal = refuse_start(scene, crossed);
  if (!refusal) add(crossed);
  for (const std::string& warning : warnings) fmt::print("{}: warning: {}\n", file.string(), warning);
  if (refusal) throw InputError(file.string() + ": " + *refusal);
  if (warnings.empty()) fmt::print("{}: OK\n", file.string());
  return warnings.empty();
}

}  // namespace

void add_check_command(CLI::App& app, int& exit_code) {
  auto scene = std::make_shared<std::string>();
  CLI::App* command = app.add_subcommand("check", "Check a scene file: every mistake, with line and column");
  CLI::Option* file = command->add_option("FILE", *scene, "A scene file, or the name of a shipped scene");
  auto keys = std::make_shared<bool>(false);
  CLI::Option* list = command->add_flag("--keys", *keys, "List all keys of scene files instead");
  file->excludes(list);
  auto overrides = std::make_shared<Overrides>();
  add_set_option(*command, *overrides);
  auto strict = std::make_shared<bool>(false);
  command->add_flag("--strict", *strict, "Exit with 1 if there is a warning");
  command->callback([scene, keys, overrides, strict, &exit_code] {
    if (*keys) return fmt::print("{}", describe_scene_keys());
    if (scene->empty()) throw InputError("FILE is required, or --keys to list the keys of scene files");
    if (!check(*scene, *overrides) && *strict) exit_code = kNotClean;
  });
}

}  // namespace weft::engine::app
