/// Section "contact": intersections, friction, rest and momentum.

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "lab/contact/contact_experiments.h"
#include "lab/report/sections.h"
#include "weft/run/scene_run.h"
#include "weft/scene/scene_library.h"
#include "weft/scene/scene_reader.h"

namespace weft::engine::lab {
namespace {

Hypothesis nothing_crosses(const SectionOptions& options) {
  Hypothesis hypothesis{.title = "No frame has intersections", .source = "the paper, section 5, and Weft"};
  const int most_frames = options.quick ? 4 : 90;
  hypothesis.text = {fmt::format(
      "The first {} frames of every scene in `scenes/contact`, {} thread{}. The independent checker "
      "tests every frame for intersecting triangles and for the deepest point of cloth inside a "
      "collider. `make scenes` and `weft bench contact` run the scenes completely. CCD hits: pairs "
      "that the contact terms of the solve leave to the CCD fail-safe. Zones: rigid impact zones, "
      "for pairs that impulses cannot separate.",
      most_frames, options.threads, options.threads == 1 ? "" : "s")};
  hypothesis.found.tables = {{{"scene", "particles", "intersections", "deepest, mm", "infeasible", "CCD hits",
                               "zones", "ms per frame"},
                              {}}};
  int crossings = 0, infeasible = 0;
  double deepest = 0;
  for (const ShippedScene& shipped : list_scenes()) {
    if (!shipped.name.starts_with("contact/")) continue;
    options.report_progress(shipped.name);
    const SceneDesc scene = read_scene(shipped.file);
    const RunReport r =
        run_scene(scene, {.frames = std::min(most_frames, scene.num_frames()), .threads = options.threads});
    const std::size_t impossible = r.infeasible ? r.infeasible->size() : 0;
    crossings += r.intersections.value_or(0);
    deepest = std::max(deepest, r.penetration_max.value_or(0));
    if (shipped.name != "contact/self_crossing_body") infeasible += static_cast<int>(impossible);
    hypothesis.found.tables[0].rows.push_back(
        {"`" + shipped.name + "`", fmt::format("{}", r.particles),
         fmt::format("{}", r.intersections.value_or(0)),
         r.penetration_max ? fmt::format("{:.2g}", 1000 * *r.penetration_max) : "–",
         fmt::format("{}", impossible), fmt::format("{}", r.contact_hits.value_or(0)),
         fmt::format("{}", r.contact_zones.value_or(0)), fmt::format("{:.0f}", r.ms_per_frame_median)});
  }
  hypothesis.found.metrics = {
      {"contact_crossings", static_cast<double>(crossings), "1", "0", 0.5},
      {"contact_deepest", 1e6 * deepest, "µm", "≤ 1", 1},
      {"contact_infeasible", static_cast<double>(infeasible), "1", "0 except for self_crossing_body", 0.5}};
  hypothesis.verdict = crossings > 0                      ? Verdict::fails
                       : infeasible > 0 || deepest > 1e-6 ? Verdict::holds_in_part
                                                          : Verdict::holds;
  return hypothesis;
}

Hypothesis friction_is_coulombs(const SectionOptions& options) {
  options.report_progress("friction");
  Hypothesis hypothesis{.title = "Friction follows Coulomb's law", .source = "Weft"};
  const ContactExperiment setup;
  hypothesis.text = {fmt::format(
      "A sheet of {0}×{0} cells on an incline of 30° (tan = 0.577), `newton`: its acceleration against g "
      "(sin α − µ cos α). A strip over half a turn of a rotating drum: the ratio of the tensions at its ends "
      "against e^{{µπ}}.",
      setup.cells)};
  hypothesis.found.tables = {{{"experiment", "µ", "measured", "predicted", "error, %"}, {}}};
  double incline = 0, capstan = 0;
  bool sticks = true;
  for (const double friction : {0.0, 0.2, 0.4, 0.566, 0.59}) {
    const Slide slide = slide_on_incline(setup, 30, friction);
    const double off = slide.expected > 0 ? 100 * (slide.acceleration / slide.expected - 1) : 0;
    if (slide.expected > 0.5) incline = std::max(incline, std::abs(off));
    if (slide.expected == 0) sticks = sticks && slide.acceleration < 0.02;
    hypothesis.found.tables[0].rows.push_back(
        {"incline, m/s²", fmt::format("{}", friction), fmt::format("{:.3f}", slide.acceleration),
         fmt::format("{:.3f}", slide.expected), slide.expected > 0 ? fmt::format("{:+.1f}", off) : "–"});
  }
  for (const double friction : {0.1, 0.3, 0.5}) {
    const Capstan drum = pull_over_drum(setup, friction);
    const double off = 100 * (drum.ratio / drum.expected - 1);
    capstan = std::max(capstan, std::abs(off));
    hypothesis.found.tables[0].rows.push_back(
        {"capstan, ratio", fmt::format("{}", friction), fmt::format("{:.3f}", drum.ratio),
         fmt::format("{:.3f}", drum.expected), fmt::format("{:+.1f}", off)});
  }
  hypothesis.found.metrics = {{"incline_error", incline, "%", "≤ 3", 1},
                              {"capstan_error", capstan, "%", "≤ 5", 1.5}};
  const int met = (incline <= 3) + (capstan <= 5) + sticks;
  hypothesis.verdict = met == 3                       ? Verdict::holds
                       : incline <= 3 || capstan <= 5 ? Verdict::holds_in_part
                                                      : Verdict::fails;
  return hypothesis;
}

Hypothesis ball_takes_cloth_along(const SectionOptions& options) {
  options.report_progress("a ball that turns");
  Hypothesis hypothesis{.title = "A rotating ball drags cloth as far as Coulomb's law predicts",
                        .source = "Weft"};
  hypothesis.text = {
      "A sheet on a ball that accelerates to half a turn per second within a second. Measured: the rotation "
      "of both after that second. Predicted: the rotation of a sliding rigid flat sheet, µ g ⟨r⟩/(2⟨r²⟩), or "
      "that of the ball."};
  hypothesis.found.tables = {{{"µ", "ball, rad", "sheet, rad", "predicted, rad"}, {}}};
  double worst = 0;
  for (const double friction : {0.02, 0.03, 0.6}) {
    const Spin spin = spin_ball({}, friction);
    worst = std::max(worst, std::abs(spin.turned_sheet / spin.expected - 1));
    hypothesis.found.tables[0].rows.push_back(
        {fmt::format("{}", friction), fmt::format("{:.3f}", spin.turned_ball),
         fmt::format("{:.3f}", spin.turned_sheet), fmt::format("{:.3f}", spin.expected)});
  }
  hypothesis.found.metrics = {{"worst_error", worst, "1", "0", 0.05}};
  hypothesis.verdict = worst < 0.05 ? Verdict::holds : Verdict::holds_in_part;
  return hypothesis;
}

Hypothesis cloth_comes_to_rest(const SectionOptions& options) {
  Hypothesis hypothesis{.title = "Cloth comes to rest and stays at rest", .source = "Weft"};
  const double seconds = options.quick ? 6 : 20;
  hypothesis.text = {fmt::format(
      "A sheet of 0.8 m dropped from 1 cm, `newton` at 60 steps per second. In the second half of "
      "{:.0f} s: median of the root mean square velocity, maximum kinetic energy per mass, drift of the "
      "middle, and mean of the contact forces over the weight. In the whole time: maximum rise of the middle "
      "in a step.",
      seconds)};
  hypothesis.found.tables = {{{"on", "velocity, mm/s", "kinetic energy, J/kg", "drift, mm",
                               "rise in a step, mm", "force over weight"},
                              {}}};
  double speed = 0, energy = 0, drift = 0, force = 0;
  for (const auto& [name, support] :
       {std::pair("a floor", Support::floor), std::pair("a ball", Support::ball)}) {
    options.report_progress(std::string("rest on ") + name);
    const RestingSheet rest = rest_on({}, support, seconds);
    speed = std::max(speed, 1000 * rest.speed);
    energy = std::max(energy, rest.kinetic);
    drift = std::max(drift, 1000 * rest.drift);
    force = std::max(force, std::abs(rest.force - 1));
    hypothesis.found.tables[0].rows.push_back(
        {name, fmt::format("{:.3f}", 1000 * rest.speed), fmt::format("{:.2g}", rest.kinetic),
         fmt::format("{:.3f}", 1000 * rest.drift), fmt::format("{:.4f}", 1000 * rest.rise),
         fmt::format("{:.4f}", rest.force)});
  }
  hypothesis.found.metrics = {{"rest_velocity", speed, "mm/s", "≤ 0.2", 0},
                              {"rest_kinetic_energy", energy, "J/kg", "< 1e-6", 0},
                              {"rest_drift", drift, "mm", "< 1", 0},
                              {"rest_force_error", force, "1", "0", 0.02}};
  hypothesis.verdict = energy < 1e-6 && drift < 1 ? Verdict::holds : Verdict::holds_in_part;
  return hypothesis;
}

Hypothesis momentum_is_kept(const SectionOptions& options) {
  options.report_progress("momentum");
  Hypothesis hypothesis{.title = "Contact conserves momentum", .source = "Weft"};
  const FoldedFall fall = drop_fold({}, 0.5);
  const Collision collision = collide_sheets({}, 0.5);
  const double gain = 100 * std::abs(fall.worst_gain - 1);
  hypothesis.text = {fmt::format(
      "A folded sheet in free fall, its halves within contact distance: gain of mean velocity per "
      "step over g h, the worst in half a second. Two free sheets that collide (up to {} "
      "contacts): change of their total momentum over the momentum of one sheet.",
      collision.contacts)};
  hypothesis.found.metrics = {{"fold_gain_error", gain, "%", "≤ 0.1", 0.1},
                              {"collision_momentum_change", collision.momentum_change, "1", "≤ 1e-5", 1e-5}};
  hypothesis.verdict =
      gain <= 0.1 && collision.momentum_change <= 1e-5 ? Verdict::holds : Verdict::holds_in_part;
  return hypothesis;
}

}  // namespace

Section study_contact(const SectionOptions& options) {
  Section section{.name = "contact",
                  .title = "Contact",
                  .introduction =
                      "Tests of a requirement of the paper: \"It is not allowed that cloth is embedded in "
                      "itself or in the objects in the scene\"."};
  section.hypotheses = {nothing_crosses(options), friction_is_coulombs(options),
                        ball_takes_cloth_along(options), cloth_comes_to_rest(options),
                        momentum_is_kept(options)};
  return section;
}

}  // namespace weft::engine::lab
