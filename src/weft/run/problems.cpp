#include "weft/run/problems.h"

#include <algorithm>
#include <numeric>

#include "weft/forces/seam_springs.h"
#include "weft/run/frame_checks.h"
#include "weft/world/infeasible_pairs.h"
#include "weft/world/measures.h"

namespace weft::engine {
namespace {

constexpr int kMaxConsecutive = 5;     // frames: allowed duration of strain and flatness
constexpr double kUsualStrain = 0.15;  // of fabrics without a limit [1]
constexpr double kMinArea = 0.1;       // share of the rest area [1]
constexpr double kEnergyShare =
    0.02;  // of the largest kinetic energy, and range of the total one, so far [1]

double strain_limit(const ClothModel& model) {
  if (!model.elements) return kUsualStrain;
  for (const StrainLimit& limit : {model.elements->limit, model.elements->spring_limit}) {
    if (limit.stiffness > 0) return limit.allowed();
  }
  return kUsualStrain;
}

/// Measures of a cloth as it is.
struct ClothCheck {
  StepWarning strained, flat, open;
  bool is_strained = false, is_flat = false, is_open = false;
};

ClothCheck check_cloth(const World& world, int c) {
  const ClothModel& model = world.model(world.cloth(c));
  const ClothState& state = world.state(world.cloth(c));
  const YarnStrain strain = compute_yarn_strain(model, state);
  const AreaShare area = compute_least_area(model, state);
  const std::optional<OpenSeam> seam = find_open_seam(model, state);
  return {.strained = {WarningCode::yarn_strain, c, strain.particle, strain.max},
          .flat = {WarningCode::flat_triangle, c, area.particle, area.min},
          .open = {WarningCode::open_seam, c, seam ? seam->particle : -1, seam ? seam->width : 0},
          .is_strained = strain.max > strain_limit(model),
          .is_flat = area.min < kMinArea,
          .is_open = seam.has_value()};
}

}  // namespace

std::vector<StepWarning> find_problems(const World& world) {
  std::vector<StepWarning> problems;
  for (int c = 0; c < world.num_cloths(); ++c) {
    const ClothCheck check = check_cloth(world, c);
    if (check.is_strained) problems.push_back(check.strained);
    if (check.is_flat) problems.push_back(check.flat);
    if (check.is_open) problems.push_back(check.open);
  }
  const WorldFrames frames(world);
  const FrameToCheck now = frames.now();
  const verify::FrameCheck check = verify::check_frame(now.frame, 0);
  if (check.intersections > 0)
    problems.push_back({.code = WarningCode::crossings, .value = static_cast<double>(check.intersections)});
  if (const std::optional<StepWarning> inside = find_inside(now.frame, check.deepest))
    problems.push_back(*inside);
  return problems;
}

/// Keeps the worst warning of each code, cloth and fault.
void ProblemFinder::record_warning(const StepWarning& warning) {
  const auto is_same = [&](const Record& s) {
    return s.worst.code == warning.code && s.worst.cloth == warning.cloth && s.worst.fault == warning.fault;
  };
  auto record = std::find_if(found_.others.begin(), found_.others.end(), is_same);
  if (record == found_.others.end()) record = found_.others.insert(found_.others.end(), Record{warning});
  if (warning.value > record->worst.value) record->worst = warning;
  ++record->frames;
}

void ProblemFinder::add_step(const StepReport& step) {
  for (const StepWarning& warning : step.warnings) record_warning(warning);
  for (const InfeasiblePair& pair : step.infeasible) add_once(pair, found_.infeasible);
}

void ProblemFinder::add_frame(double kinetic, double potential) {
  found_.strained.resize(world_.num_cloths());
  found_.flat.resize(world_.num_cloths());
  found_.open.resize(world_.num_cloths());
  for (int c = 0; c < world_.num_cloths(); ++c) check_cloth(c);
  check_energy(kinetic, potential);
  ++found_.num_frames;
}

void ProblemFinder::check_cloth(int c) {
  const ClothCheck check = weft::engine::check_cloth(world_, c);
  update(found_.strained[c], check.strained, check.is_strained,
         check.strained.value > found_.strained[c].worst.value);
  update(found_.flat[c], check.flat, check.is_flat, check.flat.value < found_.flat[c].worst.value);
  update(found_.open[c], check.open, check.is_open, check.open.value > found_.open[c].worst.value);
}

void ProblemFinder::update(Record& record, const StepWarning& warning, bool is_wrong, bool is_worse) {
  if (!is_wrong) {
    record.consecutive = 0;
    return;
  }
  if (record.frames++ == 0 || is_worse) record.worst = warning;
  record.is_reported |= ++record.consecutive > kMaxConsecutive;
}

void ProblemFinder::check_energy(double kinetic, double potential) {
  const double energy = kinetic + potential;
  if (found_.num_frames == 0) found_.max_energy = found_.min_energy = energy;
  const double rise = found_.num_frames == 0 ? 0 : energy - found_.energy;
  double lift = 0;  // energy to lift all cloth by its thickness [J]
  for (int c = 0; c < world_.num_cloths(); ++c) {
    const ClothModel& model = world_.model(world_.cloth(c));
    lift += std::accumulate(model.mass.begin(), model.mass.end(), 0.0) * world_.gravity().norm() *
            model.material.thickness;
  }
  found_.max_kinetic = std::max(found_.max_kinetic, kinetic);
  const double range = std::max(found_.max_energy - found_.min_energy, found_.max_kinetic);
  if (!world_.is_driven() && rise > lift && rise > kEnergyShare * range)
    record_warning({.code = WarningCode::energy_rise, .value = rise});
  found_.max_energy = std::max(found_.max_energy, energy);
  found_.min_energy = std::min(found_.min_energy, energy);
  found_.energy = energy;
}

std::vector<RunProblem> ProblemFinder::problems() const {
  std::vector<RunProblem> result;
  const auto add = [&](const StepWarning& w, int frames) {
    result.push_back({w.code, frames, w.value, describe(world_, w)});
  };
  for (const std::vector<Record>* all : {&found_.strained, &found_.flat, &found_.open}) {
    for (const Record& record : *all) {
      if (record.is_reported) add(record.worst, record.frames);
    }
  }
  for (const Record& record : found_.others) add(record.worst, record.frames);
  const auto add_count = [&](WarningCode code, std::size_t count) {
    if (count > 0) add({.code = code, .value = static_cast<double>(count)}, 1);
  };
  add_count(WarningCode::crossings, found_.crossings);
  if (found_.inside) add(*found_.inside, 1);
  add_count(WarningCode::passages, found_.passages);
  add_count(WarningCode::infeasible, found_.infeasible.size());
  std::stable_sort(result.begin(), result.end(),
                   [](const auto& a, const auto& b) { return a.code < b.code; });
  return result;
}

}  // namespace weft::engine
