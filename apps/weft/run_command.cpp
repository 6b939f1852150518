#include "run_command.h"

#include <fmt/core.h>

#include <memory>

#include "apps/common/command_line.h"
#include "apps/common/progress.h"
#include "commands.h"
#include "summary.h"
#include "weft/core/make_folder.h"
#include "weft/core/staged_file.h"
#include "weft/scene/scene_library.h"

namespace weft::engine::app {

namespace fs = std::filesystem;

namespace {

/// The scene of the request; of a resumed run without one its own, and its options.
SceneDesc find_request(RunRequest& request) {
  if (!request.scene.empty()) return read_scene(find_scene(request.scene), request.overrides);
  const RunOptions given = request.options;
  UnfinishedRun unfinished = read_unfinished_run(given.folder);
  request.options = unfinished.options;
  request.options.threads = given.threads;
  request.options.checkpoint_every = given.checkpoint_every;
  return unfinished.scene;
}

}  // namespace

FinishedRun run_to_files(RunRequest request, const std::vector<FrameSink*>& sinks) {
  const SceneDesc scene = find_request(request);
  RunOptions& options = request.options;
  if (options.folder.empty()) options.folder = (fs::path("out") / scene.name).string();
  options.threads = choose_threads(options.threads);
  options.keep_going = [] { return !interrupted(); };
  make_folder(options.folder);  // the report may be in it
  if (!request.report.empty()) require_writable(request.report);
  ProgressBar bar(scene.name);
  options.on_preparation = [&bar](const std::string& what) { bar.prepare(what); };
  catch_interrupts();
  FinishedRun run = run_to_folder(scene, options, sinks, [&](const Progress& progress) {
    bar.update(progress);
    return !interrupted();
  });
  bar.clear();
  if (!request.report.empty()) write_report(request.report, run.report);
  return run;
}

int exit_code_of(RunOutcome outcome) {
  switch (outcome) {
    case RunOutcome::done:
      return kDone;
    case RunOutcome::interrupted:
      return kInterrupted;
    case RunOutcome::failed:
      break;
  }
  return kSimulationFailed;
}

void add_run_command(CLI::App& app, int& exit_code) {
  auto request = std::make_shared<RunRequest>();
  CLI::App* command = app.add_subcommand("run", "Simulate a scene; write its frames and a report");
  CLI::Option* scene = command->add_option(
      "SCENE", request->scene,
      "A scene file, or the name of a shipped scene (see: weft scenes); of --resume the run's own");
  command->add_option("--out", request->options.folder, "Folder for the results (default: out/SCENE)")
      ->type_name("DIR");
  command
      ->add_option("--frames", request->options.frames,
                   "Frames to simulate, instead of the scene's own duration")
      ->check(CLI::Range(1, 1000000))
      ->type_name("N");
  command
      ->add_option("--threads", request->options.threads,
                   "Threads (default: all processors); never changes the result")
      ->check(CLI::Range(1, 1024))
      ->type_name("T");
  command->add_flag("!--no-glb", request->options.glb, "Do not write animation.glb");
  command->add_flag("!--no-pc2", request->options.pc2, "Do not write point caches, a .pc2 file per cloth");
  command->add_flag("--obj", request->options.obj,
                    "Also write a folder obj: an OBJ file per cloth and frame");
  command->add_flag("--audit", request->options.audit,
                    "Also report the work and the unexplained energy of every frame; slower");
  command->add_flag("!--no-passages", request->options.check_passages,
                    "Do not check for tunnelling within steps");
  command
      ->add_option(
          "--start-from", request->options.start_from,
          "Begin with the cloths of a frame of an earlier run, by their names (FRAME: a number or last)")
      ->type_name("DIR@FRAME");
  CLI::Option* resume = command->add_option(
      "--resume", request->resume, "Continue the unfinished run in this folder from its last checkpoint");
  resume->type_name("DIR")->excludes("--out");
  command->add_flag("--fresh", request->fresh, "Discard an unfinished run in the folder")->excludes(resume);
  command
      ->add_option("--checkpoint-every", request->options.checkpoint_every,
                   "Frames between checkpoints (default: as many as take 30 s)")
      ->check(CLI::Range(1, 1000000))
      ->type_name("N");
  add_set_option(*command, request->overrides);
  command->add_flag("--strict", request->strict, "Exit with 1 if the run has problems");
  command->add_option("--report", request->report, "Also write the report to this file")->type_name("FILE");
  // A resumed run has its own; with a scene they are compared with these.
  for (const char* option :
       {"--frames", "--no-glb", "--no-pc2", "--obj", "--audit", "--no-passages", "--start-from", "--set"})
    command->get_option(option)->needs(scene);
  command->callback([request, scene, &exit_code] {
    if (scene->empty() && request->resume.empty()) throw CLI::RequiredError("SCENE");
    if (request->fresh) request->options.unfinished = Unfinished::discard;
    if (!request->resume.empty()) {
      request->options.folder = request->resume;
      request->options.unfinished = Unfinished::resume;
    }
    const FinishedRun run = run_to_files(*request);
    fmt::print("{}", summarise(run.report));
    if (run.report.outcome == RunOutcome::interrupted)
      fmt::print("  interrupted: partial results kept; weft run --resume {} continues it\n",
                 run.files[0].parent_path().string());
    for (const fs::path& file : run.files)
      fmt::print("  {:13}{}\n", file == run.files[0] ? "written" : "", file.string());
    fmt::print("{}", describe_problems(run.report));
    exit_code = exit_code_of(run.report.outcome);
    if (request->strict && exit_code == kDone && !run.report.problems.empty()) exit_code = kSimulationFailed;
  });
}

}  // namespace weft::engine::app
