#pragma once
/// A scene, run one frame at a time.
///
///     GlbSink glb(file);
///     SceneRun run(read_scene("flag.toml"), make_jobs(2), {&glb});
///     while (run.next_frame()) print(run.report().kinetic_energy.back());
///     run.finish();

#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include "weft/core/job_system.h"
#include "weft/run/frame_sink.h"
#include "weft/run/stopwatch.h"
#include "weft/scene/scene_world.h"

namespace weft::engine {

class SceneRun {
 public:
  /// Builds the world and shows the start to the sinks, which must outlive this. `num_frames`: instead of the
  /// scene's duration. Throws InputError as build_scene() and the sinks do.
  SceneRun(SceneDesc scene, std::shared_ptr<JobSystem> jobs, std::vector<FrameSink*> sinks = {},
           std::optional<int> num_frames = {});

  SceneRun(const SceneRun&) = delete;
  SceneRun& operator=(const SceneRun&) = delete;

  /// Simulates a frame. False if there was none left, or if it failed: then report() has the outcome.
  bool next_frame();

  /// One step, for programs that change or show the world between the steps of a frame. Wind and gusts are
  /// the scene's. Neither sinks nor the report hear of it.
  StepReport step();

  /// No frame follows.
  void interrupt() { report_.outcome = RunOutcome::interrupted; }

  /// Ends the run, complete or not: the last entries of the report, and the ends of the sinks' files.
  const RunReport& finish();

  /// Calls `observer` with every moment within steps (World::set_observer); its time is not measured.
  void observe(std::function<void(double time)> observer);

  const SceneDesc& scene() const { return scene_; }
  World& world();
  const World& world() const;
  weft::World& public_world() { return built_.world; }
  const SceneNotes& notes() const { return built_; }
  const RunReport& report() const { return report_; }  // so far

  int frame() const { return report_.frames; }     // done
  int num_frames() const { return num_frames_; }   // of
  double seconds_spent() const { return spent_; }  // on simulation, wall time [s]

 private:
  bool simulate_frame();
  void add_work(const StepReport& done);
  void add_contact(const StepReport& done);

  SceneDesc scene_;
  int num_frames_;
  PublicScene built_;
  std::vector<FrameSink*> sinks_;
  RunReport report_;
  Stopwatch stopwatch_;
  double seconds_in_frame_ = 0;  // wall time of its steps [s]
  double spent_ = 0;             // of all frames [s]
  std::vector<double> frame_ms_;
};

struct RunOptions {
  std::optional<int> frames;   // instead of the scene's duration · fps [1]
  int threads = 1;             // >= 1; the result does not depend on it
  bool audit = false;          // see Recorder
  bool check_passages = true;  // see FrameChecker
};

/// Progress of a run.
struct Progress {
  int frame = 0;             // done
  int num_frames = 0;        // of
  double seconds_spent = 0;  // on simulation so far, wall time [s]
  double seconds_left = 0;   // at the present pace [s]
};

/// Called after every frame; false ends the run there, keeping what was done.
using OnFrame = std::function<bool(const Progress&)>;

/// Runs a scene to its end, with a Recorder and a FrameChecker before the other sinks. Throws InputError for
/// bad input; a simulation that fails ends the run, with the reason in `outcome` and `failure`.
RunReport run_scene(const SceneDesc& scene, const RunOptions& options, const std::vector<FrameSink*>& sinks = {},
                    const OnFrame& on_frame = {});

/// Warnings of cloths that are too stiff for the paper's Eq. 16: the stiffer the cloth for its step, the more
/// Eq. 16 reduces gravity.
std::vector<std::string> check_paper(const SceneDesc& scene, const World& world);

}  // namespace weft::engine
