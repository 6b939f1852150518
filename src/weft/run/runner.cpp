#include "weft/run/runner.h"

#include <algorithm>
#include <cstdio>
#include <limits>

#include "weft/error.h"
#include "weft/core/version.h"
#include "weft/run/film.h"
#include "weft/run/frame_checks.h"
#include "weft/run/start_check.h"
#include "weft/run/stopwatch.h"
#include "weft/run/warnings.h"
#include "weft/scene/scene_world.h"
#include "weft/verify/passages.h"
#include "weft/world/energy_audit.h"
#include "weft/world/measures.h"

namespace weft::engine {
namespace {

constexpr int kMostInfeasible = 100;  // listed in a report

std::string hex(std::uint64_t value) {
  char digits[17];
  std::snprintf(digits, sizeof digits, "%016llx", static_cast<unsigned long long>(value));
  return digits;
}

/// Gathers the figures of a run, frame by frame.
class Recorder {
 public:
  Recorder(const SceneDesc& scene, const World& world, RunReport& report)
      : world_(world), frames_(world), problems_(world), report_(report) {
    report.scene = scene.name;
    report.integrator = scene.solver.integrator;
    report.version = kVersion;
    for (int c = 0; c < world.num_cloths(); ++c) {
      const ClothTopology& topology = *world.model(world.cloth(c)).topology;
      report.particles += topology.num_particles();
      report.triangles += topology.mesh.num_triangles();
      report.springs += static_cast<int>(topology.springs.size());
    }
  }

  /// Warns of cloth that crosses something before anything has moved, or refuses it by an InputError.
  void check_start(const SceneDesc& scene) {
    const std::vector<std::string> found = weft::engine::check_start(world_);
    report_.warnings.insert(report_.warnings.end(), found.begin(), found.end());
    if (found.empty() || !scene.contact || scene.crossed_start == CrossedStart::allow) return;
    std::string all = scene.untangle ? "the start crosses, and could not be set apart:"
                                     : "the start crosses, and solver.untangle = false leaves it so:";
    for (const std::string& sentence : found) all += "\n  " + sentence;
    throw InputError(all + "\nmove them apart, or solver.crossed_start = \"allow\" runs all the same");
  }

  void add_frame() {
    double lowest = std::numeric_limits<double>::infinity(), mean_strain = 0;
    for (int c = 0; c < world_.num_cloths(); ++c) {
      const ClothModel& model = world_.model(world_.cloth(c));
      const ClothState& state = world_.state(world_.cloth(c));
      lowest = std::min(lowest, compute_lowest_y(state));
      mean_strain += add_strain(compute_strain(model, state)) / world_.num_cloths();
    }
    report_.lowest_y.push_back(lowest);
    add_energy(compute_energy(world_));
    add_stretches();
    ++report_.frames;
    report_.mean_strain += (mean_strain - report_.mean_strain) / report_.frames;
    judge_frame(report_.kinetic_energy.back() + report_.potential_energy.back());
  }

  void add_step(const StepReport& step) { problems_.add_step(step); }

  void finish() {
    problems_.add_passages(report_.passages.value_or(0));
    report_.problems = problems_.problems();
  }

  void add_audit(const EnergyAudit& frame) {
    EnergySeries& energy = report_.energy;
    energy.work_pins.push_back(frame.work_pins);
    energy.work_shapes.push_back(frame.work_shapes);
    energy.work_wind.push_back(frame.work_wind);
    energy.work_hands.push_back(frame.work_hands);
    energy.left_over.push_back(frame.left_over);
  }

 private:
  void judge_frame(double energy) {
    const verify::FrameCheck check = verify::check_frame(frames_.now().frame, 0);
    problems_.add_frame(energy, check.intersections);
    report_.intersections = std::max(report_.intersections.value_or(0), check.intersections);
    if (!check.deepest) return;
    report_.penetration_max = std::max(report_.penetration_max.value_or(0), check.penetration());
  }

  void add_energy(const WorldEnergy& energy) {
    report_.kinetic_energy.push_back(energy.kinetic);
    report_.potential_energy.push_back(energy.potential());
    report_.energy.kinetic.push_back(energy.kinetic);
    report_.energy.elastic.push_back(energy.elastic);
    report_.energy.bending.push_back(energy.bending);
    report_.energy.gravitational.push_back(energy.gravitational);
  }

  void add_stretches() {
    std::optional<Stretches> all;
    for (int c = 0; c < world_.num_cloths(); ++c) {
      const auto own =
          compute_principal_stretches(world_.model(world_.cloth(c)), world_.state(world_.cloth(c)));
      if (!own) continue;
      all = all ? Stretches{std::min(all->min, own->min), std::max(all->max, own->max)} : *own;
    }
    if (!all) return;
    report_.min_stretch.push_back(all->min);
    report_.max_stretch.push_back(all->max);
  }

  double add_strain(const Strain& strain) {
    report_.max_strain = std::max(report_.max_strain, strain.max);
    report_.min_strain = std::min(report_.min_strain, strain.min);
    return strain.mean;
  }

  const World& world_;
  WorldFrames frames_;
  ProblemFinder problems_;
  RunReport& report_;
};

/// Shows the checker the motion of every substep.
class PassageCounter {
 public:
  PassageCounter(const World& world, RunReport& report)
      : frames_(world), watch_(frames_.now().frame), report_(report) {
    report_.passages = 0;
  }

  void add_moment(double time, int frame) {
    const FrameToCheck moment = frames_.at(time);
    const std::vector<verify::FeaturePair> passages = watch_.advance(moment.frame);
    if (passages.empty()) return;
    if (report_.passages == 0)
      report_.first_passage =
          "frame " + std::to_string(frame) + ": " + verify::describe(moment.frame, passages[0]);
    *report_.passages += static_cast<int>(passages.size());
  }

  int num_left_out() const { return watch_.num_left_out(); }

 private:
  WorldFrames frames_;
  verify::PassageWatch watch_;
  RunReport& report_;
};

/// A run under way.
class Run {
 public:
  Run(const SceneDesc& scene, const RunOptions& options)
      : scene_(scene),
        options_(options),
        num_frames_(options.frames.value_or(scene.num_frames())),
        built_(build_world(scene, make_jobs(options.threads))),
        recorder_(scene, built_.world, result_.report),
        film_(scene, built_.world) {
    result_.report.threads = options.threads;
    result_.report.warnings = built_.warnings;
    result_.report.notes = built_.notes;
    result_.report.untangle_seconds = built_.untangle_seconds;
    warn_about_paper(scene, built_.world, result_.report.warnings);
    recorder_.check_start(scene);
    built_.world.track_contacts(options.audit);
    if (options.record_animation) film_.add_frame();
    if (options.check_passages) watch_passages();
  }

  RunResult go(const OnFrame& on_frame) {
    RunReport& report = result_.report;
    for (int frame = 1; frame <= num_frames_ && report.outcome == RunOutcome::done; ++frame) {
      seconds_in_frame_ = 0;
      EnergyAudit audit;
      if (!simulate_frame(frame, audit)) break;
      const double seconds = seconds_in_frame_;
      spent_ += seconds;
      frame_ms_.push_back(1000 * seconds);
      recorder_.add_frame();
      if (options_.audit) recorder_.add_audit(audit);
      if (options_.record_animation) film_.add_frame();
      const Progress progress{frame, num_frames_, spent_, spent_ / frame * (num_frames_ - frame)};
      if (on_frame && !on_frame(progress) && frame < num_frames_) report.outcome = RunOutcome::interrupted;
    }
    finish();
    result_.animation = film_.take();
    return std::move(result_);
  }

 private:
  /// With the stopwatch held.
  void watch_passages() {
    passages_.emplace(built_.world, result_.report);
    built_.world.set_observer([this](double time) {
      seconds_in_frame_ += stopwatch_.stop();
      passages_->add_moment(time, result_.report.frames + 1);
      stopwatch_.start();
    });
  }

  /// False if the simulation failed: then the report says where and why.
  bool simulate_frame(int frame, EnergyAudit& audit) {
    World& world = built_.world;
    for (int s = 0; s < scene_.steps_per_frame; ++s) {
      std::optional<AuditStart> start;
      if (options_.audit) start = begin_energy_audit(world);
      stopwatch_.start();
      world.set_wind(wind_at(scene_.wind, world.time()));
      const StepReport done = world.step(1 / (scene_.fps * scene_.steps_per_frame));
      seconds_in_frame_ += stopwatch_.stop();
      if (start) audit += finish_energy_audit(*start, world);
      add_work(done, frame);
      if (done.ok) {
        recorder_.add_step(done);
        continue;
      }
      result_.report.outcome = RunOutcome::failed;
      result_.report.failure =
          "frame " + std::to_string(frame) + ", " + describe(world, done.warnings.back());
      return false;
    }
    return true;
  }

  void add_work(const StepReport& done, int frame) {
    RunReport& report = result_.report;
    report.divisions.resize(frame, 0);
    report.divisions.back() += done.divisions;
    report.retries += done.retries;
    report.work += done.work;
    if (done.fault) ++report.faults[to_string(*done.fault)];
    if (scene_.contact) add_contact(done, frame);
    if (done.guard_events) report.guard_events = report.guard_events.value_or(0) + *done.guard_events;
    if (!done.linear_iterations) return;
    report.newton_steps.resize(frame, 0);
    report.cg_iterations.resize(frame, 0);
    report.newton_steps.back() += done.iterations;
    report.cg_iterations.back() += *done.linear_iterations;
  }

  void add_contact(const StepReport& done, int frame) {
    RunReport& report = result_.report;
    report.contact_hits = report.contact_hits.value_or(0) + done.hits;
    report.contact_zones = report.contact_zones.value_or(0) + done.zones;
    if (!report.infeasible) report.infeasible.emplace();
    for (const InfeasiblePair& pair : done.infeasible) {
      if (static_cast<int>(report.infeasible->size()) == kMostInfeasible) break;
      report.infeasible->push_back("frame " + std::to_string(frame) + ": " + describe(built_.world, pair));
    }
  }

  void finish() {
    RunReport& report = result_.report;
    recorder_.finish();
    if (passages_ && passages_->num_left_out() > 0) {
      report.warnings.push_back("passages are not counted of " + std::to_string(passages_->num_left_out()) +
                                " substeps in which cloth moved by more than its own size");
    }
    report.seconds_simulated = built_.world.time();
    report.ms_per_frame_median = quantile(frame_ms_, 0.5);
    report.ms_per_frame_p95 = quantile(frame_ms_, 0.95);
    if (report.frames > 0) report.cpu_ms_per_frame = 1000 * stopwatch_.cpu_total() / report.frames;
    report.state_hash = hex(built_.world.state_hash());
  }

  const SceneDesc& scene_;
  const RunOptions& options_;
  int num_frames_;
  SceneWorld built_;
  RunResult result_;
  Recorder recorder_;
  Film film_;
  std::optional<PassageCounter> passages_;
  Stopwatch stopwatch_;
  double seconds_in_frame_ = 0;  // wall time of its steps [s]
  std::vector<double> frame_ms_;
  double spent_ = 0;  // on simulation, wall time [s]
};

}  // namespace

void warn_about_paper(const SceneDesc& scene, const World& world, std::vector<std::string>& warnings) {
  if (scene.solver.integrator != "paper") return;
  const double step = 1 / (scene.fps * scene.steps_per_frame);
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
}

RunResult run_scene(const SceneDesc& scene, const RunOptions& options, const OnFrame& on_frame) {
  return Run(scene, options).go(on_frame);
}

}  // namespace weft::engine
