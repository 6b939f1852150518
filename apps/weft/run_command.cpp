#include "run_command.h"

#include <fmt/core.h>

#include <memory>

#include "commands.h"
#include "common.h"
#include "progress.h"
#include "summary.h"
#include "weft/core/staged_file.h"
#include "weft/scene/scene_library.h"

namespace weft::engine::app {
namespace {

namespace fs = std::filesystem;

constexpr const char* kAnimationName = "animation.glb";
constexpr const char* kReportName = "report.json";

/// Creates the folder and checks that all files are writable, or throws InputError. Earlier results stay.
void prepare_folder(const fs::path& folder, const fs::path& report) {
  make_folder(folder);
  for (const char* name : {kAnimationName, kReportName}) require_writable(folder / name);
  if (!report.empty()) require_writable(report);
}

/// Both are complete before either replaces that of an earlier run.
void write_results(const fs::path& folder, const RunResult& result) {
  StagedFile animation(folder / kAnimationName), report(folder / kReportName);
  write_glb(animation, result.animation);
  report.out() << to_json(result.report);
  report.finish();
  animation.replace();
  report.replace();
}

}  // namespace

FinishedRun run_to_files(const RunRequest& request) {
  const SceneDesc scene = read_scene(find_scene(request.scene), request.overrides);
  const fs::path folder = request.out.empty() ? fs::path("out") / scene.name : request.out;
  prepare_folder(folder, request.report);
  const RunOptions options{.frames = request.frames,
                           .threads = choose_threads(request.threads),
                           .audit = request.audit,
                           .check_passages = request.check_passages};
  ProgressBar bar(scene.name);
  catch_interrupts();
  RunResult result = run_scene(scene, options, [&](const Progress& progress) {
    bar.update(progress);
    return !interrupted();
  });
  bar.clear();
  write_results(folder, result);
  if (!request.report.empty()) write_report(request.report, result.report);
  return {std::move(result.report), std::move(result.animation), folder / kAnimationName,
          folder / kReportName};
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
  CLI::App* command = app.add_subcommand("run", "Simulate a scene; write animation.glb and report.json");
  command
      ->add_option("SCENE", request->scene, "A scene file, or the name of a shipped scene (see: weft scenes)")
      ->required();
  command->add_option("--out", request->out, "Folder for the results (default: out/SCENE)")->type_name("DIR");
  command->add_option("--frames", request->frames, "Frames to simulate, instead of the scene's own duration")
      ->check(CLI::Range(1, 1000000))
      ->type_name("N");
  command
      ->add_option("--threads", request->threads,
                   "Threads (default: all processors); never changes the result")
      ->check(CLI::Range(1, 1024))
      ->type_name("T");
  command->add_flag("--audit", request->audit,
                    "Also report the work done in every frame, and the energy it leaves over; slower");
  command->add_flag("!--no-passages", request->check_passages,
                    "Do not check what goes through what within steps");
  add_set_option(*command, request->overrides);
  command->add_flag("--strict", request->strict, "Exit with 1 if the last lines say that something is wrong");
  command->add_option("--report", request->report, "Also write the report to this file")->type_name("FILE");
  command->callback([request, &exit_code] {
    const FinishedRun run = run_to_files(*request);
    fmt::print("{}", summarise(run.report));
    if (run.report.outcome == RunOutcome::interrupted) fmt::print("  interrupted: what was done is kept\n");
    fmt::print("  written      {}\n               {}\n", run.animation_file.string(),
               run.report_file.string());
    fmt::print("{}", describe_problems(run.report));
    exit_code = exit_code_of(run.report.outcome);
    if (request->strict && exit_code == kDone && !run.report.problems.empty()) exit_code = kSimulationFailed;
  });
}

}  // namespace weft::engine::app
