#include <fmt/core.h>

#include <memory>

#include "commands.h"
#include "common.h"
#include "weft/core/error.h"
#include "weft/scene/scene_library.h"
#include "weft/scene/scene_reader.h"
#include "weft/scene/scene_world.h"

namespace weft::app {
namespace {

/// Reads the scene and builds its world: meshes and pins are judged too.
int check(const std::string& scene, const Overrides& overrides) {
  const std::filesystem::path file = find_scene(scene);
  const SceneWorld built = build_world(read_scene(file, overrides), make_serial_jobs());
  for (const std::string& warning : built.warnings) fmt::print("{}: warning: {}\n", file.string(), warning);
  fmt::print("{}: good\n", file.string());
  return kDone;
}

}  // namespace

void add_check_command(CLI::App& app, int& exit_code) {
  auto scene = std::make_shared<std::string>();
  CLI::App* command = app.add_subcommand("check", "Judge a scene file: every mistake, with its place");
  CLI::Option* file = command->add_option("FILE", *scene, "A scene file, or the name of a shipped scene");
  auto keys = std::make_shared<bool>(false);
  CLI::Option* list = command->add_flag("--keys", *keys, "Instead, list every key that scene files may have");
  file->excludes(list);
  auto overrides = std::make_shared<Overrides>();
  add_set_option(*command, *overrides);
  command->callback([scene, keys, overrides, &exit_code] {
    if (*keys) return fmt::print("{}", describe_scene_keys());
    if (scene->empty()) throw InputError("FILE is required; or --keys, to list the keys of scene files");
    exit_code = check(*scene, *overrides);
  });
}

}  // namespace weft::app
