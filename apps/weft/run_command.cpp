#include "run_command.h"

#include <fmt/core.h>

#include <memory>
#include <regex>

#include "apps/common/command_line.h"
#include "apps/common/progress.h"
#include "commands.h"
#include "summary.h"
#include "weft/core/staged_file.h"
#include "weft/run/file_sinks.h"
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

/// Whether a file is a frame that ObjSink wrote: `sheet_0000.obj`.
bool is_obj_frame(const fs::path& file) {
  static const std::regex kName(".+_[0-9]{4,}\\.obj");
  return std::regex_match(file.filename().string(), kName);
}

/// Files for the frames of a run. Those of an earlier run stay until replace().
class FrameFiles {
 public:
  FrameFiles(const fs::path& folder, const RunRequest& request)
      : glb_file_(folder / kAnimationName), obj_(folder / "obj"), obj_part_(folder / ".obj.partial") {
    if (request.glb) glb_ = std::make_unique<Glb>(glb_file_);
    if (!request.obj) return;
    fs::remove_all(obj_part_);
    make_folder(obj_part_);
    obj_sink_.emplace(obj_part_);
  }

  ~FrameFiles() {
    std::error_code ignored;
    if (obj_sink_) fs::remove_all(obj_part_, ignored);
  }

  void add_to(std::vector<FrameSink*>& sinks) {
    if (glb_) sinks.push_back(&glb_->sink);
    if (obj_sink_) sinks.push_back(&*obj_sink_);
  }

  /// Without glb an earlier animation is removed too, because it does not belong to this report.
  void replace() {
    std::error_code ignored;
    glb_ ? glb_->file.replace() : void(fs::remove(glb_file_, ignored));
    if (!obj_sink_) return;
    make_folder(obj_);
    for (const auto& entry : fs::directory_iterator(obj_)) {
      if (is_obj_frame(entry.path())) fs::remove(entry.path(), ignored);
    }
    for (const auto& entry : fs::directory_iterator(obj_part_))
      fs::rename(entry.path(), obj_ / entry.path().filename());
  }

 private:
  struct Glb {
    explicit Glb(const fs::path& path) : file(path) {}
    StagedFile file;
    GlbSink sink{file};
  };

  fs::path glb_file_, obj_, obj_part_;
  std::unique_ptr<Glb> glb_;
  std::optional<ObjSink> obj_sink_;
};

}  // namespace

FinishedRun run_to_files(const RunRequest& request, const std::vector<FrameSink*>& sinks) {
  const SceneDesc scene = read_scene(find_scene(request.scene), request.overrides);
  const fs::path folder = request.out.empty() ? fs::path("out") / scene.name : request.out;
  prepare_folder(folder, request.report);
  const RunOptions options{.frames = request.frames,
                           .threads = choose_threads(request.threads),
                           .audit = request.audit,
                           .check_passages = request.check_passages};
  FrameFiles files(folder, request);
  std::vector<FrameSink*> all = sinks;
  files.add_to(all);
  ProgressBar bar(scene.name);
  catch_interrupts();
  RunReport report = run_scene(scene, options, all, [&](const Progress& progress) {
    bar.update(progress);
    return !interrupted();
  });
  bar.clear();
  StagedFile report_file(folder / kReportName);
  report_file.out() << to_json(report);
  report_file.finish();
  files.replace();
  report_file.replace();
  if (!request.report.empty()) write_report(request.report, report);
  FinishedRun run{.report = std::move(report), .files = {}};
  if (request.glb) run.files.push_back(folder / kAnimationName);
  if (request.obj) run.files.push_back(folder / "obj");
  run.files.push_back(folder / kReportName);
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
  command->add_flag("!--no-glb", request->glb, "Do not write animation.glb");
  command->add_flag("--obj", request->obj, "Also write a folder obj: an OBJ file per cloth and frame");
  command->add_flag("--audit", request->audit,
                    "Also report the work and the unexplained energy of every frame; slower");
  command->add_flag("!--no-passages", request->check_passages, "Do not check for tunnelling within steps");
  add_set_option(*command, request->overrides);
  command->add_flag("--strict", request->strict, "Exit with 1 if the run has problems");
  command->add_option("--report", request->report, "Also write the report to this file")->type_name("FILE");
  command->callback([request, &exit_code] {
    const FinishedRun run = run_to_files(*request);
    fmt::print("{}", summarise(run.report));
    if (run.report.outcome == RunOutcome::interrupted) fmt::print("  interrupted: partial results kept\n");
    for (const fs::path& file : run.files)
      fmt::print("  {:13}{}\n", file == run.files[0] ? "written" : "", file.string());
    fmt::print("{}", describe_problems(run.report));
    exit_code = exit_code_of(run.report.outcome);
    if (request->strict && exit_code == kDone && !run.report.problems.empty()) exit_code = kSimulationFailed;
  });
}

}  // namespace weft::engine::app
