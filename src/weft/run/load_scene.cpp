/// Public functions: worlds of scenes.

#include "weft/face/world_impl.h"
#include "weft/run/problems.h"
#include "weft/scene.h"
#include "weft/scene/scene_access.h"
#include "weft/scene/scene_world.h"

namespace weft {
namespace {

/// Warnings of the steps before time 0, the worst of each code and cloth.
std::vector<std::string> describe_settling(const engine::PublicScene& built) {
  engine::ProblemFinder finder(WorldAccess::engine(built.world));
  for (const StepReport& step : built.settling) finder.add_step(step);
  std::vector<std::string> messages;
  for (const engine::RunProblem& problem : finder.problems())
    messages.push_back("before the start: " + problem.message);
  return messages;
}

}  // namespace

LoadedScene build_scene(const Scene& scene, std::shared_ptr<JobSystem> jobs) {
  engine::PublicScene built = engine::build_scene(SceneAccess::desc(scene), std::move(jobs));
  for (std::string& message : describe_settling(built)) built.warnings.push_back(std::move(message));
  return {.world = std::move(built.world),
          .frames_per_second = scene.frames_per_second(),
          .steps_per_frame = scene.steps_per_frame(),
          .num_frames = scene.num_frames(),
          .warnings = std::move(built.warnings)};
}

LoadedScene load_scene(const std::string& file_or_name, const std::vector<std::string>& overrides) {
  return build_scene(Scene::load(file_or_name, overrides));
}

}  // namespace weft
