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
#include "weft/run/scene_run.h"

namespace weft::engine {

struct LiveSettings {
  int threads = 1;      // of the simulation, >= 1
  bool playing = true;  // from the start
};

/// A point on a cloth: of a triangle, by the weights of its corners (sum 1).
struct ClothPoint {
  int cloth = 0, triangle = 0;
  Vec3 weights = Vec3::Constant(1.0 / 3);  // [1]
};

/// Status of a live simulation.
struct LiveStatus {
  bool playing = false;
  std::int64_t steps = 0;   // since the start or the last reset [1]
  std::int64_t frames = 0;  // of the scene, likewise [1]
  double time = 0;          // simulated [s]
  std::string integrator;
  std::string model;  // of the cloths' springs
  Wind wind;
  int substeps = 0, iterations = 0, divisions = 1;  // of the last step [1]

  double ms_per_step = 0;           // median over the last steps, wall time [ms]
  double ms_per_step_p95 = 0;       // 95th percentile, likewise [ms]
  double steps_per_second = 0;      // over the last second of play, wall time [1/s]
  double simulated_per_second = 0;  // likewise; 1: real time [1]
  bool too_heavy = false;           // for real time: slow motion

  std::vector<std::string> warnings;       // of integrator and springs that do not fit each other
  std::string failure;                     // of the last step, as text; empty: none. A failed step pauses
  std::vector<std::string> step_warnings;  // warnings of the last steps, as text
  std::optional<Vec3> held;                // position of the grabbed point [m]
};

/// Status and meshes at one time.
struct LiveFrame {
  LiveStatus status;
  AnimationFrame meshes;
  std::vector<std::shared_ptr<const ClothTopology>> topologies;  // (num_cloths)
};

class LiveSimulation {
 public:
  /// Throws InputError as build_scene does.
  explicit LiveSimulation(SceneDesc scene, const LiveSettings& settings = {});
  ~LiveSimulation();

  LiveSimulation(const LiveSimulation&) = delete;
  LiveSimulation& operator=(const LiveSimulation&) = delete;

  /// The constant parts: names, triangles, colours, shapes; with the start as the only frame.
  const Animation& start() const { return start_; }
  const SceneDesc& scene() const { return start_scene_; }
  const std::vector<std::string>& warnings() const { return warnings_; }
  const std::vector<Vec3>& reach() const { return reach_; }  // see find_reach

  /// All of these return immediately, and take effect before the next step.
  void play();
  void pause();
  void step(int count = 1);  // pauses, then makes `count` steps without pacing
  void reset();              // restarts with the current integrator, springs and wind; releases the grab
  /// Throws InputError for an unknown name. An integrator that supports springs only is refused, with a
  /// warning, if a cloth has a fabric.
  void set_integrator(const std::string& name);
  void set_model(SpringModel model);            // of cloths that are grids; positions are kept
  void set_wind(std::optional<Vec3> velocity);  // uniform and constant; empty: the scene's [m/s]
  void grab(const ClothPoint& point);           // replaces the current grab
  void move_grab(const Vec3& target);           // sets the target of the grab [m]
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
  bool run_commands();
  void run();
  bool is_between_frames() const;
  bool take_step();
  void report_step(const StepReport& report);
  void start_pace();
  void end_frame();
  void apply_wind();
  void change_model(SpringModel model);
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
  IntegratorSettings solver_;
  World::Snapshot snapshot_;  // of the start
  LiveStatus status_;
  int steps_to_make_ = 0;
  std::optional<Vec3> wind_;
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
