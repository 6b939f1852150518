/// Public functions: runs.

#include "weft/run.h"

#include "weft/error.h"
#include "weft/run/run_folder.h"
#include "weft/scene/scene_access.h"

namespace weft {
namespace {

void require_positive(const char* option, int value) {
  if (value < 1)
    throw InputError(std::string("RunOptions::") + option + ": expected 1 or more, found " +
                     std::to_string(value));
}

}  // namespace

RunResult run(const Scene& scene, const RunOptions& options, const OnFrame& on_frame) {
  require_positive("frames", options.frames.value_or(1));
  require_positive("threads", options.threads);
  require_positive("checkpoint_every", options.checkpoint_every.value_or(1));
  if (!(options.checkpoint_seconds >= 0))
    throw InputError("RunOptions::checkpoint_seconds: expected 0 or more");
  const engine::FinishedRun run = engine::run_to_folder(SceneAccess::desc(scene), options, {}, on_frame);
  RunResult result{.outcome = run.report.outcome,
                   .failure = run.report.failure,
                   .report = engine::to_json(run.report),
                   .state_hash = run.report.state_hash};
  for (const engine::RunProblem& problem : run.report.problems) result.problems.push_back(problem.message);
  for (const std::filesystem::path& file : run.files) result.files.push_back(file.string());
  return result;
}

}  // namespace weft
