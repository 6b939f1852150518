#include "weft/run/live.h"

#include <algorithm>
#include <future>

#include "weft/error.h"
#include "weft/face/world_impl.h"
#include "weft/run/reach.h"
#include "weft/run/report.h"
#include "weft/run/warnings.h"
#include "weft/scene/scene_changes.h"
#include "weft/scene/unsupported.h"
#include "weft/world/measures.h"

namespace weft::engine {
namespace {

bool has_torn(const World& world) {
  for (int c = 0; c < world.num_cloths(); ++c) {
    if (!world.state(world.cloth(c)).torn.empty()) return true;
  }
  return false;
}

constexpr double kPatience = 0.05;         // maximum delay to real time before slow motion [s]
constexpr double kWindow = 1;              // for measuring the pace [s]
constexpr double kSlow = 0.95;             // of real time: a lower pace is too heavy [1]
constexpr std::size_t kSteps = 512;        // in medians
constexpr double kSlowest = 0.01;          // speed of play [1]
constexpr std::size_t kMaxSamples = 4096;  // that wait to be taken [1]

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
      wanted_(start_scene_),
      built_(start_scene_),
      snapshot_(run_->public_world().snapshot()) {
  warnings_ = run_->notes().warnings;
  reach_ = find_reach(world());
  start_ = make_animation(start_scene_, world(), TornCloth::present);
  append_frame(capture_frame(world(), TornCloth::present), start_);
  show_world();
  clear_problems();
  status_.playing = settings.playing;
  status_.integrator = start_scene_.solver.integrator;
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

/// A command that changes the motion: it begins where the past is shown, and is repeated with the steps after it.
void LiveSimulation::post_change(std::function<void()> change) {
  post([this, change = std::move(change)] {
    leave_past();
    change();
    history_.add_change(status_.steps, change);
  });
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

void LiveSimulation::step_frame() {
  post([this] {
    status_.playing = false;
    const int steps = scene_now().steps_per_frame;
    steps_to_make_ = steps - static_cast<int>(status_.steps % steps);
  });
}

void LiveSimulation::reset() {
  post([this] {
    held_.reset();
    steps_to_make_ = 0;
    if (wanted_ == built_) {
      hold();
      run_->change(built_);
      run_->public_world().restore(snapshot_);
    } else {
      rebuild(wanted_, false);
    }
    history_.clear();
    status_.steps = status_.frames = last_step_ = 0;
    status_.failure.clear();
    clear_problems();
    find_pins();
    status_.keys_for_restart.clear();
    is_paced_ = false;
    check_solver();
  });
}

void LiveSimulation::set_integrator(const std::string& name) {
  make_integrator({.integrator = name});  // throws on the caller's side
  post([this, name] {
    if (const auto unsupported = find_unsupported(wanted_, name); !unsupported.empty()) {
      status_.warnings = {"keeping " + status_.integrator + ": " + name + ' ' + unsupported.front().sentence};
      return;
    }
    leave_past();
    SceneDesc next = wanted_;
    next.solver.integrator = name;
    const auto change = [this, next] { apply(next); };
    change();
    history_.add_change(status_.steps, change);
  });
}

void LiveSimulation::set_model(SpringModel model) {
  post([this, model] {
    if (status_.model == kNoModel) return;
    SceneDesc next = wanted_;
    for (ClothSceneDesc& cloth : next.cloths) cloth.model = model;
    leave_past();
    apply(next);
  });
}

void LiveSimulation::change(SceneDesc wanted) {
  post_change([this, wanted = std::move(wanted)] { apply(wanted); });
}

void LiveSimulation::set_speed(double speed) {
  post([this, speed] {
    status_.speed = std::clamp(speed, kSlowest, 1.0);
    is_paced_ = false;
  });
}

void LiveSimulation::seek(std::int64_t steps) {
  post([this, steps] {
    status_.playing = false;
    steps_to_make_ = 0;
    if (!history_.is_empty()) show_past(std::clamp(steps, history_.first(), last_step_));
  });
}

void LiveSimulation::measure(const LiveInstruments& instruments) {
  post([this, instruments] {
    instruments_ = instruments;
    world().track_contacts(instruments_.tracks_contacts());
  });
}

void LiveSimulation::grab(const ClothPoint& point) {
  post_change([this, point] {
    held_ = point;
    hold();
  });
}

void LiveSimulation::move_grab(const Vec3& target) {
  post_change([this, target] {
    if (!held_) return;
    const ClothId cloth = world().cloth(held_->cloth);
    world().set_attachment_target(cloth, static_cast<int>(world().attachments(cloth).size()) - 1, target);
  });
}

void LiveSimulation::release() {
  post_change([this] {
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
  leave_past();
  if (history_.wants(status_.steps)) remember();
  const Clock::time_point start = Clock::now();
  const StepReport report = make_step();
  step_ms_.push_back(1000 * seconds(Clock::now() - start));
  if (step_ms_.size() > kSteps) step_ms_.pop_front();
  status_.wind = world().wind();
  report_step(report);
  last_step_ = status_.steps;
  if (report.ok) sample(report);
  return report.ok;
}

StepReport LiveSimulation::make_step() {
  glide_colliders(scene_now(), scene_now().step_length(), run_->public_world());
  return run_->step();
}

/// Before the next step.
void LiveSimulation::remember() {
  if (!moment_scene_ || !(*moment_scene_ == scene_now()))
    moment_scene_ = std::make_shared<const SceneDesc>(scene_now());
  std::size_t num_particles = 0;
  for (int c = 0; c < world().num_cloths(); ++c) num_particles += world().state(world().cloth(c)).x.size();
  history_.add({status_.steps, world().time(), run_->public_world().snapshot(), moment_scene_, held_},
               num_particles);
}

/// Repeats the steps from the moment before.
void LiveSimulation::show_past(std::int64_t steps) {
  const LiveMoment from = history_.moment_before(steps);
  const SceneDesc wanted = wanted_;
  run_->change(*from.scene);
  run_->public_world().restore(from.state);
  held_ = from.held;
  for (status_.steps = from.steps; status_.steps < steps; ++status_.steps) {
    history_.repeat_changes(status_.steps);
    if (!make_step().ok) break;
  }
  wanted_ = wanted;
  find_pins();
  status_.frames = status_.steps / scene_now().steps_per_frame;
  status_.integrator = scene_now().solver.integrator;
  status_.wind = world().wind();
  status_.failure.clear();
}

/// The state shown from the past becomes the present, with all changes and without a grab.
void LiveSimulation::leave_past() {
  if (status_.steps == last_step_) return;
  history_.forget_after(status_.steps);
  last_step_ = status_.steps;
  const auto change = [this, wanted = wanted_] {
    held_.reset();
    hold();
    apply(wanted);
  };
  change();
  history_.add_change(status_.steps, change);
}

void LiveSimulation::sample(const StepReport& report) {
  next_.samples.push_back({.time = world().time(),
                           .work = report.work,
                           .iterations = report.iterations,
                           .linear_iterations = report.linear_iterations.value_or(0),
                           .divisions = report.divisions,
                           .contacts = static_cast<int>(report.work.active),
                           .residual = report.residual.value_or(0)});
  if (next_.samples.size() > kMaxSamples) next_.samples.erase(next_.samples.begin());
}

/// Energies and strain of the newest sample.
void LiveSimulation::measure_frame() {
  if (next_.samples.empty()) return;
  LiveSample& last = next_.samples.back();
  measure_world(run_->public_world(), last);
  if (is_between_frames())
    problems_->add_frame(last.energies.kinetic, last.energies.total() - last.energies.kinetic);
}

void LiveSimulation::report_step(const StepReport& report) {
  status_.substeps = report.substeps;
  status_.iterations = report.iterations;
  status_.failure.clear();
  status_.divisions = report.divisions;
  if (report.ok) {
    problems_->add_step(report);
    ++status_.steps;
    return;
  }
  for (const StepWarning& warning : report.warnings)
    status_.failure = "step " + std::to_string(status_.steps + 1) + ", " + to_string(warning.code) + ": " +
                      describe(world(), warning);
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
  due_ += std::chrono::duration_cast<Clock::duration>(
      std::chrono::duration<double>(1 / (scene_now().fps * status_.speed)));
  if (seconds(now - due_) > kPatience) due_ = now;
  milestones_.push_back({now, status_.steps, world().time()});
  while (milestones_.size() > 2 && seconds(now - milestones_[1].wall) > kWindow) milestones_.pop_front();
  publish();
}

/// What can change without a restart; the rest waits.
void LiveSimulation::apply(const SceneDesc& wanted) {
  const std::string integrator = scene_now().solver.integrator;
  const bool has_new_bodies = changes_bodies(scene_now(), changeable_part(scene_now(), wanted));
  run_->change(wanted);
  wanted_ = wanted;
  SceneDesc with_model = scene_now();
  for (std::size_t c = 0; c < std::min(with_model.cloths.size(), wanted.cloths.size()); ++c)
    with_model.cloths[c].model = wanted.cloths[c].model;
  if (!(with_model == scene_now())) rebuild(std::move(with_model), true);
  if (has_new_bodies) {
    history_.clear();
    show_world();
  }
  clear_problems();
  find_pins();
  status_.keys_for_restart = find_keys_for_restart(scene_now(), wanted);
  status_.integrator = scene_now().solver.integrator;
  status_.wind = world().wind();
  if (status_.integrator != integrator || !status_.failure.empty()) check_solver();
}

/// A new world. Pins depend on initial positions: it is built at the start, and the state put in.
void LiveSimulation::rebuild(SceneDesc scene, bool keeps_state) {
  std::optional<World::Snapshot> now;
  if (keeps_state && !has_torn(world())) now = world().snapshot();
  auto run = std::make_unique<SceneRun>(scene, jobs_);
  run_ = std::move(run);
  built_ = std::move(scene);
  snapshot_ = run_->public_world().snapshot();
  if (now) world().restore(*now);
  history_.clear();
  show_world();
  clear_problems();
  world().track_contacts(instruments_.tracks_contacts());
  hold();
  status_.model = name_of_model(built_);
  status_.integrator = built_.solver.integrator;
  status_.wind = world().wind();
  check_solver();
}

/// After a change of solver or springs: recomputes the warnings and discards results of earlier steps.
void LiveSimulation::check_solver() {
  status_.warnings = check_paper(scene_now().solver, scene_now().step_length(), world());
  status_.failure.clear();
  clear_problems();
  step_ms_.clear();
  is_paced_ = false;
}

/// Grabs `held_` at its current position; releases all other grabs. Soft pins, which come before a grab, stay.
void LiveSimulation::hold() {
  World& held = world();
  for (int c = 0; c < held.num_cloths(); ++c) {
    const ClothId cloth = held.cloth(c);
    std::vector<Attachment> attachments = held.attachments(cloth);
    attachments.resize(WorldAccess::num_soft_pins(run_->public_world(), cloth));
    if (held_ && held_->cloth == c)
      attachments.push_back(
          make_attachment(held.model(cloth), held.state(cloth), held_->triangle, held_->weights));
    held.set_attachments(cloth, std::move(attachments));
  }
}

/// Meshes and seams, after a change of bodies.
void LiveSimulation::show_world() {
  meshes_ = std::make_shared<const Animation>(make_animation(scene_now(), world(), TornCloth::present));
  seams_ = std::make_shared<const std::vector<SeamEdges>>(find_seams(run_->public_world()));
  pins_.reset();
  find_pins();
}

/// Again only after changes: a selection may need the mesh's file.
void LiveSimulation::find_pins() {
  std::vector<std::vector<PinDesc>> now;
  for (const ClothSceneDesc& cloth : scene_now().cloths) now.push_back(cloth.pins);
  if (pins_ && now == found_pins_) return;
  found_pins_ = std::move(now);
  pins_ = std::make_shared<const std::vector<LivePins>>(
      weft::engine::find_pins(scene_now(), run_->public_world()));
}

void LiveSimulation::clear_problems() { problems_.emplace(world()); }

LiveStatus LiveSimulation::measure() const {
  LiveStatus status = status_;
  status.problems = problems_->problems();
  status.time = world().time();
  status.first_step = history_.is_empty() ? status.steps : history_.first();
  status.last_step = last_step_;
  const std::vector<double> ms(step_ms_.begin(), step_ms_.end());
  status.ms_per_step = quantile(ms, 0.5);
  status.ms_per_step_p95 = quantile(ms, 0.95);
  if (milestones_.size() > 1) {
    const Milestone &first = milestones_.front(), &last = milestones_.back();
    const double wall = std::max(seconds(last.wall - first.wall), 1e-9);
    status.steps_per_second = static_cast<double>(last.steps - first.steps) / wall;
    status.simulated_per_second = (last.time - first.time) / wall;
    status.too_heavy =
        status.playing && wall > kWindow / 2 && status.simulated_per_second < kSlow * status.speed;
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
  measure_frame();
  next_.status = measure();
  next_.start = meshes_;
  next_.meshes = capture_frame(world(), TornCloth::present);
  next_.topologies.clear();
  for (int c = 0; c < world().num_cloths(); ++c)
    next_.topologies.push_back(world().model(world().cloth(c)).topology);
  next_.seams = seams_;
  next_.pins = pins_;
  read_instruments(world(), instruments_, *pins_, next_);
  const std::lock_guard lock(frame_mutex_);
  // A frame that nobody has taken leaves its samples to this one.
  if (is_fresh_) next_.samples.insert(next_.samples.begin(), frame_.samples.begin(), frame_.samples.end());
  std::swap(next_, frame_);
  next_.samples.clear();
  is_fresh_ = true;
}

}  // namespace weft::engine
