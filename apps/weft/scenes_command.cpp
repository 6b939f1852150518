#include <fmt/core.h>

#include "commands.h"
#include "weft/scene/scene_library.h"
#include "weft/scene/scene_reader.h"

namespace weft::engine::app {

void add_scenes_command(CLI::App& app, int&) {
  CLI::App* command = app.add_subcommand("scenes", "List the scenes that ship with Weft");
  command->callback([] {
    for (const ShippedScene& scene : list_scenes()) {
      fmt::print("{:<28} {}\n", scene.name, read_scene(scene.file).description);
    }
  });
}

}  // namespace weft::engine::app
