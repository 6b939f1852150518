#include "weft/core/job_system.h"
#include "weft/scene.h"
#include "weft/scene/scene_library.h"
#include "weft/scene/scene_reader.h"
#include "weft/scene/scene_world.h"

namespace weft {

LoadedScene load_scene(const std::string& file_or_name, const std::vector<std::string>& overrides) {
  const engine::SceneDesc scene = engine::read_scene(engine::find_scene(file_or_name), overrides);
  engine::PublicScene built = engine::build_scene(scene, make_serial_jobs());
  return {.world = std::move(built.world),
          .frames_per_second = scene.fps,
          .steps_per_frame = scene.steps_per_frame,
          .num_frames = scene.num_frames(),
          .warnings = std::move(built.warnings)};
}

}  // namespace weft
