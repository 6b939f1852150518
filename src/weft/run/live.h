#pragma once
/// A scene that runs in real time on a thread of its own, to be watched and touched from another.
///
///     caller's thread                          simulation's thread
///     play, pause, grab, set_wind, … ──queue──>  between two steps
///     newest() <──one lock for a swap of vectors──  after each frame of the scene
///
/// Neither side waits for the other. Steps are those of SceneRun: same scene, same commands before the same
/// steps, same bits, however often somebody looks or pauses. Cloth that is too heavy for real time slows its
/// time down; nothing is skipped and nothing piles up.

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

/// How a live simulation is doing.
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
  bool too_heavy = false;           // for real time: time runs slower

  std::vector<std::string> warnings;  // of integrator and springs that do not go together
  std::string failure;                // of the last step, by name; empty: none. A step that fails pauses
  std::vector<std::string> troubles;  // of the last steps, by name
  std::optional<Vec3> held;           // the point of the cloth that a hand holds [m]
};

/// Everything at one moment.
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

  /// What does not move: names, triangles, colours, shapes; with the start as its one frame.
  const Animation& start() const { return start_; }
  const SceneDesc& scene() const { return start_scene_; }
  const std::vector<std::string>& warnings() const { return warnings_; }
  const std::vector<Vec3>& reach() const { return reach_; }  // see find_reach

  /// All of these return at once, and take effect before the next step.
  void play();
  void pause();
  void step(int count = 1);  // pauses, and makes so many steps as fast as they go
  void reset();              // to the start, with the present integrator, springs and wind; lets go
  /// Throws InputError for an unknown name. One that knows springs alone is not taken where a cloth is of a
  /// fabric; a warning says so.
  void set_integrator(const std::string& name);
  void set_model(SpringModel model);            // of cloths that are grids; they stay where they are
  void set_wind(std::optional<Vec3> velocity);  // everywhere and at any time; empty: the scene's [m/s]
  void grab(const ClothPoint& point);           // instead of what is held
  void move_grab(const Vec3& target);           // draws what is held to there [m]
  void release();

  /// The newest frame, if there is one since the last call; `frame`'s memory is used again.
  bool take_newest(LiveFrame& frame);

  /// Of the state between two steps; waits for the step under way.
  std::uint64_t state_hash();

 private:
  using Clock = std::chrono::steady_clock;

  /// A moment of play, to measure the pace.
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
  void tell(const StepReport& report);
  void start_pace();
  void end_frame();
  void apply_wind();
  void change_model(SpringModel model);
  void judge_solver();
  void hold();
  void publish();
  LiveStatus measure() const;

  // Constant once made.
  SceneDesc start_scene_;
  Animation start_;
  std::vector<std::string> warnings_;
  std::vector<Vec3> reach_;

  // Of the simulation's thread.
  std::shared_ptr<JobSystem> jobs_;
  std::unique_ptr<SceneRun> run_;
  IntegratorSettings solver_;
  World::Snapshot snapshot_;  // of the start
  LiveStatus status_;
  int steps_to_make_ = 0;
  std::optional<Vec3> wind_;
  std::optional<ClothPoint> held_;
  bool is_paced_ = false;  // play is under way, and due_ and milestones_ are about it
  Clock::time_point due_;  // of the next frame
  std::deque<Milestone> milestones_;
  std::deque<double> step_ms_;
  LiveFrame next_;

  // Shared.
  std::mutex commands_mutex_, frame_mutex_;
  std::condition_variable wake_;
  std::vector<std::function<void()>> commands_;
  bool is_ending_ = false;
  LiveFrame frame_;
  bool is_fresh_ = false;

  std::thread thread_;
};

}  // namespace weft::engine
