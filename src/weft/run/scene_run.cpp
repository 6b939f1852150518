#include "weft/run/scene_run.h"

#include <cstdio>
#include <utility>

#include "weft/core/hash.h"
#include "weft/core/version.h"
#include "weft/face/world_impl.h"
#include "weft/run/frame_checker.h"
#include "weft/run/recorder.h"
#include "weft/run/run_archive.h"
#include "weft/run/start_from.h"
#include "weft/run/warnings.h"
#include "weft/scene/scene_changes.h"
#include "weft/world/measures.h"

namespace weft::engine {
namespace {

constexpr const char* kSaved = "a saved run";

/// What SceneRun::save() returns, before the parts of the sinks.
struct SavedRun {
  RunReport report;
  double spent = 0;  // [s]
  std::vector<double> frame_ms;
  double cpu_seconds = 0;
  std::vector<std::byte> world;
};

template <class Archive>
void describe(Archive& archive, SavedRun& run) {
  members(archive, run.report, run.spent, run.frame_ms, run.cpu_seconds, run.world);
}

constexpr std::size_t kMaxInfeasible = 100;  // listed in a report

RunReport make_report(const SceneDesc& scene, const SceneNotes& notes, const World& world) {
  RunReport report{.scene = scene.name, .integrator = scene.solver.integrator, .version = kVersion};
  for (int c = 0; c < world.num_cloths(); ++c) {
    const ClothTopology& topology = *world.model(world.cloth(c)).topology;
    report.particles += topology.num_particles();
    report.triangles += topology.mesh.num_triangles();
    report.springs += static_cast<int>(topology.springs.size());
  }
  report.warnings = notes.warnings;
  report.notes = notes.notes;
  report.untangle_seconds = notes.untangle_seconds;
  const std::vector<std::string> paper = check_paper(scene.solver, scene.step_length(), world);
  report.warnings.insert(report.warnings.end(), paper.begin(), paper.end());
  return report;
}

}  // namespace

SceneRun::SceneRun(SceneDesc scene, std::shared_ptr<JobSystem> jobs, std::vector<FrameSink*> sinks,
                   std::optional<int> num_frames, const SceneStart* start,
                   const OnPreparation& on_preparation)
    : scene_(std::move(scene)),
      num_frames_(num_frames.value_or(scene_.num_frames())),
      built_(build_scene(scene_, jobs, start, on_preparation)),
      sinks_(std::move(sinks)),
      report_(make_report(scene_, built_, world())) {
  report_.threads = jobs->num_threads();
  for (FrameSink* sink : sinks_) sink->begin(*this, report_);
}

SceneRun::SceneRun(SceneDesc scene, std::shared_ptr<JobSystem> jobs, std::vector<FrameSink*> sinks,
                   int num_frames, std::span<const std::byte> saved)
    : scene_(std::move(scene)), num_frames_(num_frames), sinks_(std::move(sinks)) {
  Reader in(saved, kSaved);
  SavedRun run;
  describe(in, run);
  report_ = std::move(run.report);
  spent_ = run.spent;
  frame_ms_ = std::move(run.frame_ms);
  stopwatch_ = Stopwatch(run.cpu_seconds);
  built_.world = weft::World::load(run.world);
  world().set_jobs(jobs);
  report_.threads = jobs->num_threads();
  for (FrameSink* sink : sinks_) sink->resume(*this, report_, in);
  if (in.left() > 0) in.fail();
}

std::vector<std::byte> SceneRun::save() {
  for (FrameSink* sink : sinks_) sink->sync();
  Writer out;
  SavedRun run{report_, spent_, frame_ms_, stopwatch_.cpu_total(), built_.world.save()};
  describe(out, run);
  for (FrameSink* sink : sinks_) sink->save(out);
  return std::move(out.bytes);
}

World& SceneRun::world() { return WorldAccess::engine(built_.world); }
const World& SceneRun::world() const { return WorldAccess::engine(built_.world); }

StepReport SceneRun::step() { return built_.world.step(scene_.step_length()); }

void SceneRun::change(const SceneDesc& wanted) {
  apply_changes(scene_, wanted, built_.world);
  scene_ = changeable_part(scene_, wanted);
}

bool SceneRun::next_frame(const std::function<bool()>& keep_going) {
  if (report_.outcome != RunOutcome::done || frame() == num_frames_) return false;
  seconds_in_frame_ = 0;
  if (!simulate_frame(keep_going)) return false;
  spent_ += seconds_in_frame_;
  frame_ms_.push_back(1000 * seconds_in_frame_);
  ++report_.frames;
  for (FrameSink* sink : sinks_) sink->add_frame(*this, report_);
  return true;
}

/// False if a step failed, or if the frame was interrupted.
bool SceneRun::simulate_frame(const std::function<bool()>& keep_going) {
  for (int s = 0; s < scene_.steps_per_frame; ++s) {
    if (s > 0 && keep_going && !keep_going()) {
      interrupt();
      return false;
    }
    for (FrameSink* sink : sinks_) sink->begin_step(*this);
    stopwatch_.start();
    const StepReport done = step();
    seconds_in_frame_ += stopwatch_.stop();
    for (FrameSink* sink : sinks_) sink->end_step(*this, done, report_);
    add_work(done);
    if (done.ok) continue;
    report_.outcome = RunOutcome::failed;
    report_.failure = "frame " + std::to_string(frame() + 1) + ", " + describe(world(), done.warnings.back());
    return false;
  }
  return true;
}

void SceneRun::add_work(const StepReport& done) {
  report_.divisions.resize(frame() + 1, 0);
  report_.divisions.back() += done.divisions;
  report_.retries += done.retries;
  report_.work += done.work;
  report_.torn += done.torn;
  if (done.fault) ++report_.faults[to_string(*done.fault)];
  if (scene_.contact) add_contact(done);
  if (done.guard_events) report_.guard_events = report_.guard_events.value_or(0) + *done.guard_events;
  if (!done.linear_iterations) return;
  report_.newton_steps.resize(frame() + 1, 0);
  report_.cg_iterations.resize(frame() + 1, 0);
  report_.newton_steps.back() += done.iterations;
  report_.cg_iterations.back() += *done.linear_iterations;
}

void SceneRun::add_contact(const StepReport& done) {
  report_.contact_hits = report_.contact_hits.value_or(0) + done.hits;
  report_.contact_zones = report_.contact_zones.value_or(0) + done.zones;
  if (!report_.infeasible) report_.infeasible.emplace();
  for (const InfeasiblePair& pair : done.infeasible) {
    if (report_.infeasible->size() == kMaxInfeasible) break;
    report_.infeasible->push_back("frame " + std::to_string(frame() + 1) + ": " + describe(world(), pair));
  }
}

void SceneRun::observe(std::function<void(double)> observer) {
  world().set_observer([this, observe = std::move(observer)](double time) {
    seconds_in_frame_ += stopwatch_.stop();
    observe(time);
    stopwatch_.start();
  });
}

/// Leaves out the work of an unfinished frame.
void SceneRun::end_series() {
  for (std::vector<int>* series : {&report_.divisions, &report_.newton_steps, &report_.cg_iterations}) {
    if (std::cmp_greater(series->size(), frame())) series->resize(frame());
  }
}

const RunReport& SceneRun::finish() {
  end_series();
  report_.seconds_simulated = world().time();
  report_.ms_per_frame_median = quantile(frame_ms_, 0.5);
  report_.ms_per_frame_p95 = quantile(frame_ms_, 0.95);
  if (report_.frames > 0) report_.cpu_ms_per_frame = 1000 * stopwatch_.cpu_total() / report_.frames;
  report_.state_hash = to_hex(world().state_hash());
  for (FrameSink* sink : sinks_) sink->finish(*this, report_);
  return report_;
}

weft::World load_world(std::span<const std::byte> saved) {
  Reader in(saved, kSaved);
  SavedRun run;
  describe(in, run);
  return weft::World::load(run.world);
}

const RunReport& play(SceneRun& run, const RunOptions& options, const OnFrame& on_frame) {
  while (run.next_frame(options.keep_going)) {
    const double spent = run.seconds_spent();
    const int left = run.num_frames() - run.frame();
    if (on_frame && !on_frame({run.frame(), run.num_frames(), spent, spent / run.frame() * left}) && left > 0)
      run.interrupt();
  }
  return run.finish();
}

RunReport run_scene(const SceneDesc& scene, const RunOptions& options, const std::vector<FrameSink*>& sinks,
                    const OnFrame& on_frame) {
  Recorder recorder(options.audit);
  FrameChecker checker(options.check_passages);
  std::vector<FrameSink*> all = {&recorder, &checker};
  all.insert(all.end(), sinks.begin(), sinks.end());
  std::optional<SceneStart> start;
  if (!options.start_from.empty()) start = read_start(parse_start_from(options.start_from));
  SceneRun run(scene, make_jobs(options.threads), std::move(all), options.frames, start ? &*start : nullptr,
               options.on_preparation);
  return play(run, options, on_frame);
}

std::vector<std::string> check_paper(const IntegratorSettings& solver, double step, const World& world) {
  std::vector<std::string> warnings;
  if (solver.integrator != "paper") return warnings;
  for (int c = 0; c < world.num_cloths(); ++c) {
    const double a = compute_stiffness_number(world.model(world.cloth(c)), step);
    if (a <= 1) continue;
    char text[256];
    std::snprintf(
        text, sizeof text,
        "cloth \"%s\" is too stiff for the paper's Eq. 16 at this step: a = h²Σk/m reaches %.3g, and from "
        "rest it falls with %.2g of gravity; use paper_fixed, or raise solver.steps_per_frame",
        world.name(world.cloth(c)).c_str(), a, gravity_factor(a));
    warnings.emplace_back(text);
  }
  return warnings;
}

}  // namespace weft::engine
