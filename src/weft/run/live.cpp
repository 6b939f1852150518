#include "weft/run/live.h"

#include <algorithm>
#include <future>

#include "weft/error.h"
#include "weft/face/convert.h"
#include "weft/run/reach.h"
#include "weft/run/report.h"
#include "weft/run/warnings.h"

namespace weft::engine {
namespace {

constexpr double kPatience = 0.05;           // maximum delay to real time before slow motion [s]
constexpr double kWindow = 1;                // for measuring the pace [s]
constexpr double kSlow = 0.95;               // of real time: a lower pace is too heavy [1]
constexpr std::size_t kSteps = 512;          // in medians
constexpr std::size_t kMaxStepWarnings = 4;  // maximum number reported
constexpr double kDrag = 0.25;               // of wind in scenes without wind [N·s/m³]

constexpr const char* kNoModel = "mesh";

double seconds(std::chrono::steady_clock::duration d) { return std::chrono::duration<double>(d).count(); }

/// The spring model of the first grid; meshes have none.
std::string name_of_model(const SceneDesc& scene) {
  for (const ClothSceneDesc& cloth : scene.cloths) {
    if (std::holds_alternative<Grid>(cloth.shape)) return std::string(to_string(cloth.model));
  }
  return kNoModel;
}

}  // namespace

LiveSimulation::LiveSimulation(SceneDesc scene, const LiveSettings& settings)
    : start_scene_(std::move(scene)),
      jobs_(make_jobs(settings.threads)),
      run_(std::make_unique<SceneRun>(start_scene_, jobs_)),
      solver_(start_scene_.solver),
      snapshot_(world().snapshot()) {
  warnings_ = run_->notes().warnings;
  reach_ = find_reach(world());
  start_ = make_animation(start_scene_, world());
  append_frame(capture_frame(world()), start_);
  status_.playing = settings.playing;
  status_.integrator = solver_.integrator;
  status_.model = name_of_model(start_scene_);
  check_solver();
  publish();
  thread_ = std::thread([this] { run(); });
}

LiveSimulation::~LiveSimulation() {
  {
    const std::lock_guard lock(commands_mutex_);
    is_ending_ = true;
  }
  wake_.notify_all();
  thread_.join();
}

void LiveSimulation::post(std::function<void()> command) {
  {
    const std::lock_guard lock(commands_mutex_);
    commands_.push_back(std::move(command));
  }
  wake_.notify_all();
}

void LiveSimulation::play() {
  post([this] {
    status_.playing = true;
    status_.failure.clear();
    steps_to_make_ = 0;
  });
}

void LiveSimulation::pause() {
  post([this] {
    status_.playing = false;
    steps_to_make_ = 0;
  });
}

void LiveSimulation::step(int count) {
  post([this, count] {
    status_.playing = false;
    steps_to_make_ += count;
  });
}

void LiveSimulation::reset() {
  post([this] {
    held_.reset();
    hold();
    world().restore(snapshot_);
    apply_wind();
    status_.steps = status_.frames = 0;
    status_.failure.clear();
    status_.step_warnings.clear();
    steps_to_make_ = 0;
    is_paced_ = false;
  });
}

void LiveSimulation::set_integrator(const std::string& name) {
  make_integrator({.integrator = name});  // throws on the caller's side
  post([this, name] {
    const auto is_fabric = [](const ClothSceneDesc& cloth) { return cloth.fabric.has_value(); };
    if (!supports_elements(name) &&
        std::any_of(start_scene_.cloths.begin(), start_scene_.cloths.end(), is_fabric)) {
      status_.warnings = {name + " supports springs only, and this scene has a fabric: keeping " +
                          status_.integrator};
      return;
    }
    solver_.integrator = name;
    world().set_integrator(solver_);
    status_.integrator = name;
    check_solver();
  });
}

void LiveSimulation::set_model(SpringModel model) {
  post([this, model] { change_model(model); });
}

void LiveSimulation::set_wind(std::optional<Vec3> velocity) {
  post([this, velocity] {
    wind_ = velocity;
    apply_wind();
  });
}

void LiveSimulation::grab(const ClothPoint& point) {
  post([this, point] {
    held_ = point;
    hold();
  });
}

void LiveSimulation::move_grab(const Vec3& target) {
  post([this, target] {
    if (held_) world().set_attachment_target(world().cloth(held_->cloth), 0, target);
  });
}

void LiveSimulation::release() {
  post([this] {
    held_.reset();
    hold();
  });
}

bool LiveSimulation::take_newest(LiveFrame& frame) {
  const std::lock_guard lock(frame_mutex_);
  if (!is_fresh_) return false;
  std::swap(frame, frame_);
  is_fresh_ = false;
  return true;
}

std::uint64_t LiveSimulation::state_hash() {
  std::promise<std::uint64_t> answer;
  post([&] { answer.set_value(world().state_hash()); });
  return answer.get_future().get();
}

bool LiveSimulation::is_between_frames() const { return status_.steps % scene_now().steps_per_frame == 0; }

/// Waits for a command, a step or the next frame's time, and runs the commands. False: end of the thread.
bool LiveSimulation::run_commands() {
  std::vector<std::function<void()>> commands;
  {
    std::unique_lock lock(commands_mutex_);
    const auto has_news = [this] { return is_ending_ || !commands_.empty(); };
    if (!status_.playing && steps_to_make_ == 0) {
      is_paced_ = false;
      wake_.wait(lock, has_news);
    } else if (steps_to_make_ == 0 && is_paced_ && is_between_frames()) {
      wake_.wait_until(lock, due_, has_news);
    }
    if (is_ending_) return false;
    commands.swap(commands_);
  }
  for (const auto& command : commands) {
    try {
      command();
    } catch (const InputError& error) {
      status_.failure = error.what();
      status_.playing = false;
    }
  }
  if (!commands.empty()) publish();
  return true;
}

void LiveSimulation::run() {
  while (run_commands()) {
    if (steps_to_make_ > 0) {
      --steps_to_make_;
      if (take_step() && is_between_frames()) status_.frames = status_.steps / scene_now().steps_per_frame;
      publish();
    } else if (status_.playing) {
      start_pace();
      if (is_between_frames() && Clock::now() < due_) continue;
      if (!take_step())
        publish();
      else if (is_between_frames())
        end_frame();
    }
  }
}

/// Makes a step. False: it failed, and the state is unchanged.
bool LiveSimulation::take_step() {
  const Clock::time_point start = Clock::now();
  const StepReport report = run_->step();
  step_ms_.push_back(1000 * seconds(Clock::now() - start));
  if (step_ms_.size() > kSteps) step_ms_.pop_front();
  status_.wind = world().wind();
  report_step(report);
  return report.ok;
}

void LiveSimulation::report_step(const StepReport& report) {
  status_.substeps = report.substeps;
  status_.iterations = report.iterations;
  status_.failure.clear();
  status_.divisions = report.divisions;
  for (const StepWarning& warning : report.warnings) {
    const std::string message = describe(world(), warning);
    if (!report.ok) {
      status_.failure = "step " + std::to_string(status_.steps + 1) + ", " + message;
      continue;
    }
    std::vector<std::string>& listed = status_.step_warnings;
    if (std::find(listed.begin(), listed.end(), message) != listed.end()) continue;
    if (listed.size() == kMaxStepWarnings) listed.erase(listed.begin());
    listed.push_back(message);
  }
  if (report.ok) {
    ++status_.steps;
    return;
  }
  status_.playing = false;
  steps_to_make_ = 0;
}

void LiveSimulation::start_pace() {
  if (is_paced_) return;
  is_paced_ = true;
  due_ = Clock::now();
  milestones_.clear();
  milestones_.push_back({due_, status_.steps, world().time()});
}

/// The next frame is due one frame's time after this one. Slow motion if play is too late.
void LiveSimulation::end_frame() {
  status_.frames = status_.steps / scene_now().steps_per_frame;
  const Clock::time_point now = Clock::now();
  due_ += std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(1 / scene_now().fps));
  if (seconds(now - due_) > kPatience) due_ = now;
  milestones_.push_back({now, status_.steps, world().time()});
  while (milestones_.size() > 2 && seconds(now - milestones_[1].wall) > kWindow) milestones_.pop_front();
  publish();
}

/// The scene's wind, with the velocity that was set, if any.
void LiveSimulation::apply_wind() {
  weft::Wind wind = describe_wind(start_scene_.wind);
  if (wind_) {
    wind.keys.clear();
    wind.velocity = from_engine(*wind_);
    if (wind.drag == 0 && wind.air.density == 0) wind.drag = kDrag;
  }
  run_->public_world().set_wind(wind);
}

void LiveSimulation::change_model(SpringModel model) {
  if (status_.model == kNoModel) return;
  SceneDesc scene = scene_now();
  scene.solver = solver_;
  for (ClothSceneDesc& cloth : scene.cloths) cloth.model = model;
  // Pins depend on initial positions: build the new world at the start, then restore the current state.
  const World::Snapshot now = world().snapshot();
  run_ = std::make_unique<SceneRun>(std::move(scene), jobs_);
  world().restore(now);
  apply_wind();
  hold();
  status_.model = to_string(model);
  check_solver();
}

/// After a change of solver or springs: recomputes the warnings and discards results of earlier steps.
void LiveSimulation::check_solver() {
  status_.warnings = check_paper(solver_, scene_now().step_length(), world());
  status_.failure.clear();
  status_.step_warnings.clear();
  step_ms_.clear();
  is_paced_ = false;
}

/// Grabs `held_` at its current position; releases all other grabs.
void LiveSimulation::hold() {
  World& held = world();
  for (int c = 0; c < held.num_cloths(); ++c) held.set_attachments(held.cloth(c), {});
  if (!held_) return;
  const ClothId cloth = held.cloth(held_->cloth);
  held.set_attachments(
      cloth, {make_attachment(held.model(cloth), held.state(cloth), held_->triangle, held_->weights)});
}

LiveStatus LiveSimulation::measure() const {
  LiveStatus status = status_;
  status.time = world().time();
  const std::vector<double> ms(step_ms_.begin(), step_ms_.end());
  status.ms_per_step = quantile(ms, 0.5);
  status.ms_per_step_p95 = quantile(ms, 0.95);
  if (milestones_.size() > 1) {
    const Milestone &first = milestones_.front(), &last = milestones_.back();
    const double wall = std::max(seconds(last.wall - first.wall), 1e-9);
    status.steps_per_second = static_cast<double>(last.steps - first.steps) / wall;
    status.simulated_per_second = (last.time - first.time) / wall;
    status.too_heavy = status.playing && wall > kWindow / 2 && status.simulated_per_second < kSlow;
  }
  if (held_) {
    const ClothId cloth = world().cloth(held_->cloth);
    const Triangle& t = world().model(cloth).topology->mesh.triangles[held_->triangle];
    Vec3 point = Vec3::Zero();
    for (int corner = 0; corner < 3; ++corner)
      point += held_->weights[corner] * world().state(cloth).position(t[corner]);
    status.held = point;
  }
  return status;
}

void LiveSimulation::publish() {
  next_.status = measure();
  next_.meshes = capture_frame(world());
  next_.topologies.clear();
  for (int c = 0; c < world().num_cloths(); ++c)
    next_.topologies.push_back(world().model(world().cloth(c)).topology);
  const std::lock_guard lock(frame_mutex_);
  std::swap(next_, frame_);
  is_fresh_ = true;
}

}  // namespace weft::engine
