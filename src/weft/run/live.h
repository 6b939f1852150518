#pragma once
/// A scene that runs in real time on its own thread, with display and interaction from another thread.
///
///     caller's thread                          simulation's thread
///     play, pause, grab, set_wind, … ──queue──>  between two steps
///     newest() <──one lock for a swap of vectors──  after each frame of the scene
///
/// Neither thread waits for the other. Steps are those of SceneRun: the same scene, with the same commands
/// before the same steps, gives the same bits, independent of reads and pauses. A scene that is too heavy for
/// real time runs in slow motion; steps are neither skipped nor queued.

#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <deque>
#include <functional>
#include <mutex>
#include <optional>
#include <thread>
#include <vector>

#include "weft/run/film.h"
#include "weft/run/live_history.h"
#include "weft/run/live_instruments.h"
#include "weft/run/live_values.h"
#include "weft/run/scene_run.h"

namespace weft::engine {

class LiveSimulation {
 public:
  /// Throws InputError as build_scene does.
  explicit LiveSimulation(SceneDesc scene, const LiveSettings& settings = {});
  ~LiveSimulation();

  LiveSimulation(const LiveSimulation&) = delete;
  LiveSimulation& operator=(const LiveSimulation&) = delete;

  /// Names, triangles, colours, shapes, with the start as the only frame, of the scene that was given.
  const Animation& start() const { return start_; }
  const SceneDesc& scene() const { return start_scene_; }
  const std::vector<std::string>& warnings() const { return warnings_; }
  const std::vector<Vec3>& reach() const { return reach_; }  // see find_reach

  /// All of these return immediately, and take effect before the next step.
  void play();
  void pause();
  void step(int count = 1);  // pauses, then makes `count` steps without pacing
  void step_frame();         // likewise, to the end of the frame of the scene
  void reset();              // restarts with all changes; releases the grab
  /// Throws InputError for an unknown name. An integrator that does not support the scene is refused, with a
  /// warning.
  void set_integrator(const std::string& name);
  void set_model(SpringModel model);  // of cloths that are grids; positions are kept
  /// Takes what another scene changes (scene_changes.h); the rest waits for reset(), see
  /// LiveStatus::keys_for_restart. A scene with invalid numbers is refused, with a failure. Displaced colliders
  /// glide to their places, see glide_colliders().
  void change(SceneDesc wanted);
  void set_speed(double speed);  // of play, as a share of real time, in (0, 1] [1]

  /// Shows the state after so many steps, of the last ten seconds, and pauses: the same bits as then. Steps
  /// from there take the newest change(), and those after it are forgotten.
  void seek(std::int64_t steps);
  void measure(const LiveInstruments& instruments);
  void grab(const ClothPoint& point);  // replaces the current grab
  void move_grab(const Vec3& target);  // sets the target of the grab [m]
  void release();

  /// The newest frame, if there is a new one since the last call; the memory of `frame` is reused.
  bool take_newest(LiveFrame& frame);

  /// Hash of the state between two steps; waits for the current step.
  std::uint64_t state_hash();

 private:
  using Clock = std::chrono::steady_clock;

  /// A sample of progress, for the pace.
  struct Milestone {
    Clock::time_point wall;
    std::int64_t steps;
    double time;
  };

  const SceneDesc& scene_now() const { return run_->scene(); }
  World& world() { return run_->world(); }
  const World& world() const { return run_->world(); }
  void post(std::function<void()> command);
  void post_change(std::function<void()> change);
  void apply(const SceneDesc& wanted);
  void rebuild(SceneDesc scene, bool keeps_state);
  void show_past(std::int64_t steps);
  void leave_past();
  void remember();
  void sample(const StepReport& report);
  void show_world();
  void find_pins();
  void clear_problems();
  void measure_frame();
  bool run_commands();
  void run();
  bool is_between_frames() const;
  bool take_step();
  StepReport make_step();
  void report_step(const StepReport& report);
  void start_pace();
  void end_frame();
  void check_solver();
  void hold();
  void publish();
  LiveStatus measure() const;

  // Constant after construction.
  SceneDesc start_scene_;
  Animation start_;
  std::vector<std::string> warnings_;
  std::vector<Vec3> reach_;

  // Used by the simulation's thread only.
  std::shared_ptr<JobSystem> jobs_;
  std::unique_ptr<SceneRun> run_;
  SceneDesc wanted_;         // with all changes
  SceneDesc built_;          // that the world was built from
  weft::Snapshot snapshot_;  // of the start
  LiveHistory history_;
  std::int64_t last_step_ = 0;  // made; more than status_.steps while the past is shown
  LiveInstruments instruments_;
  std::optional<ProblemFinder> problems_;
  std::shared_ptr<const Animation> meshes_;
  std::shared_ptr<const std::vector<SeamEdges>> seams_;
  std::vector<std::vector<PinDesc>> found_pins_;  // (num_cloths) of pins_
  std::shared_ptr<const std::vector<LivePins>> pins_;
  std::shared_ptr<const SceneDesc> moment_scene_;  // of the last moment
  LiveStatus status_;
  int steps_to_make_ = 0;
  std::optional<ClothPoint> held_;
  bool is_paced_ = false;  // due_ and milestones_ are valid
  Clock::time_point due_;  // of the next frame
  std::deque<Milestone> milestones_;
  std::deque<double> step_ms_;
  LiveFrame next_;

  // Shared by both threads.
  std::mutex commands_mutex_, frame_mutex_;
  std::condition_variable wake_;
  std::vector<std::function<void()>> commands_;
  bool is_ending_ = false;
  LiveFrame frame_;
  bool is_fresh_ = false;

  std::thread thread_;
};

}  // namespace weft::engine
