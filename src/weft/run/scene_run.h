#pragma once
/// Runs a scene frame by frame.
///
///     GlbSink glb("flag.glb", "flag.frames");
///     SceneRun run(read_scene("flag.toml"), make_jobs(2), {&glb});
///     while (run.next_frame()) print(run.report().kinetic_energy.back());
///     run.finish();

#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "weft/core/job_system.h"
#include "weft/run.h"
#include "weft/run/frame_sink.h"
#include "weft/run/stopwatch.h"
#include "weft/scene/scene_world.h"

namespace weft::engine {

class SceneRun {
 public:
  /// Builds the world and passes the start to the sinks, which must outlive this. `num_frames` overrides the
  /// scene's duration; `start` and `on_preparation` as in build_scene(). Throws InputError like build_scene()
  /// and the sinks.
  SceneRun(SceneDesc scene, std::shared_ptr<JobSystem> jobs, std::vector<FrameSink*> sinks = {},
           std::optional<int> num_frames = {}, const SceneStart* start = nullptr,
           const OnPreparation& on_preparation = {});

  /// Continues a run of the same scene, number of frames and kinds of sinks from what its save() returned: it
  /// ends with the same bits. Throws InputError for other bytes.
  SceneRun(SceneDesc scene, std::shared_ptr<JobSystem> jobs, std::vector<FrameSink*> sinks, int num_frames,
           std::span<const std::byte> saved);

  SceneRun(const SceneRun&) = delete;
  SceneRun& operator=(const SceneRun&) = delete;

  /// Simulates a frame. False if no frame is left, or if it failed: then report() has the outcome.
  /// `keep_going` is asked between its steps; false interrupts the run within the frame.
  bool next_frame(const std::function<bool()>& keep_going = {});

  /// One step, for programs that change or show the world between the steps of a frame. Wind and gusts are
  /// the scene's. Sinks and report do not include it.
  StepReport step();

  /// Takes the changeable part of another scene between two steps (scene_changes.h). Throws InputError for invalid
  /// numbers, without changing anything.
  void change(const SceneDesc& wanted);

  /// Sets the outcome of a run that ends early.
  void interrupt() { report_.outcome = RunOutcome::interrupted; }

  /// State of world, report and sinks after a frame. Calls sync() of the sinks first.
  std::vector<std::byte> save();

  /// Ends the run, complete or not: adds the last entries of the report and finishes the sinks.
  const RunReport& finish();

  /// Calls `observer` at every time within steps (World::set_observer); its run time is not measured.
  void observe(std::function<void(double time)> observer);

  const SceneDesc& scene() const { return scene_; }
  World& world();
  const World& world() const;
  weft::World& public_world() { return built_.world; }
  const weft::World& public_world() const { return built_.world; }
  const SceneNotes& notes() const { return built_; }
  const RunReport& report() const { return report_; }  // so far

  int frame() const { return report_.frames; }     // done
  int num_frames() const { return num_frames_; }   // of
  double seconds_spent() const { return spent_; }  // on simulation, wall time [s]

 private:
  bool simulate_frame(const std::function<bool()>& keep_going);
  void add_work(const StepReport& done);
  void add_contact(const StepReport& done);
  void end_series();

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

/// The world in what SceneRun::save() returned.
weft::World load_world(std::span<const std::byte> saved);

/// Simulates frame by frame until the end, a failure, or an interruption by the caller (RunOptions::keep_going,
/// `on_frame`), and finishes the run.
const RunReport& play(SceneRun& run, const RunOptions& options, const OnFrame& on_frame = {});

/// Runs a scene to its end, with a Recorder and a FrameChecker before the other sinks. Throws InputError for
/// bad input. A failed step ends the run, with `outcome` and `failure` in the report. The options of files are
/// run_to_folder's (run_folder.h).
RunReport run_scene(const SceneDesc& scene, const RunOptions& options,
                    const std::vector<FrameSink*>& sinks = {}, const OnFrame& on_frame = {});

/// Warnings for cloths that are too stiff for the paper's Eq. 16, which reduces gravity by a factor that
/// grows with stiffness and step.
std::vector<std::string> check_paper(const IntegratorSettings& solver, double step, const World& world);

}  // namespace weft::engine
