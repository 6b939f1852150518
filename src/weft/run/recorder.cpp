#include "weft/run/recorder.h"

#include <algorithm>
#include <limits>

#include "weft/run/run_archive.h"
#include "weft/run/scene_run.h"
#include "weft/world/measures.h"

namespace weft::engine {
namespace {

void add_energy(const WorldEnergy& energy, RunReport& report) {
  report.kinetic_energy.push_back(energy.kinetic);
  report.potential_energy.push_back(energy.potential());
  report.energy.kinetic.push_back(energy.kinetic);
  report.energy.elastic.push_back(energy.elastic);
  report.energy.bending.push_back(energy.bending);
  report.energy.gravitational.push_back(energy.gravitational);
}

void add_audit(const EnergyAudit& frame, EnergySeries& energy) {
  energy.work_pins.push_back(frame.work_pins);
  energy.work_shapes.push_back(frame.work_shapes);
  energy.work_wind.push_back(frame.work_wind);
  energy.work_hands.push_back(frame.work_hands);
  energy.left_over.push_back(frame.left_over);
}

void add_stretches(const World& world, RunReport& report) {
  std::optional<Stretches> all;
  for (int c = 0; c < world.num_cloths(); ++c) {
    const auto own = compute_principal_stretches(world.model(world.cloth(c)), world.state(world.cloth(c)));
    if (!own) continue;
    all = all ? Stretches{std::min(all->min, own->min), std::max(all->max, own->max)} : *own;
  }
  if (!all) return;
  report.min_stretch.push_back(all->min);
  report.max_stretch.push_back(all->max);
}

void add_strains(const World& world, RunReport& report) {
  double mean = 0, lowest = std::numeric_limits<double>::infinity();
  for (int c = 0; c < world.num_cloths(); ++c) {
    const ClothState& state = world.state(world.cloth(c));
    const Strain strain = compute_strain(world.model(world.cloth(c)), state);
    lowest = std::min(lowest, compute_lowest_y(state));
    mean += strain.mean / world.num_cloths();
    report.max_strain = std::max(report.max_strain, strain.max);
    report.min_strain = std::min(report.min_strain, strain.min);
  }
  report.lowest_y.push_back(lowest);
  report.mean_strain += (mean - report.mean_strain) / report.frames;
}

}  // namespace

void Recorder::begin(SceneRun& run, RunReport&) {
  problems_.emplace(run.world());
  for (const StepReport& step : run.notes().settling) problems_->add_step(step);
  run.world().track_contacts(has_audit_);
}

void Recorder::begin_step(const SceneRun& run) {
  if (has_audit_) step_ = begin_energy_audit(run.world());
}

void Recorder::end_step(const SceneRun& run, const StepReport& step, RunReport&) {
  if (step_) frame_ += finish_energy_audit(*step_, run.world());
  if (step.ok) problems_->add_step(step);
}

void Recorder::add_frame(const SceneRun& run, RunReport& report) {
  add_strains(run.world(), report);
  add_energy(compute_energy(run.world()), report);
  add_stretches(run.world(), report);
  problems_->add_frame(report.kinetic_energy.back(), report.potential_energy.back());
  if (has_audit_) add_audit(frame_, report.energy);
  frame_ = {};
}

void Recorder::save(Writer& out) {
  ProblemFinder::Found found = problems_->found();
  describe(out, found);
}

void Recorder::resume(SceneRun& run, RunReport&, Reader& saved) {
  ProblemFinder::Found found;
  describe(saved, found);
  problems_.emplace(run.world(), std::move(found));
}

void Recorder::finish(const SceneRun&, RunReport& report) {
  problems_->set_crossings(report.crossings_at_end.value_or(0));
  problems_->set_inside(report.inside_at_end);
  problems_->add_passages(report.passages.value_or(0));
  report.problems = problems_->problems();
}

}  // namespace weft::engine
