/// Findings that are not in the paper: filtered gravity, a lost damping term, a sign error.

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <complex>

#include "lab/accuracy/hung_cloth.h"
#include "lab/paper/paper_hypotheses.h"
#include "lab/report/plot.h"
#include "weft/core/random.h"
#include "weft/world/measures.h"

namespace weft::engine::lab::paper {
namespace {

constexpr double kGravity = 9.81;  // [m/s²]
constexpr double kPi = 3.141592653589793;

/// Share of a uniform acceleration that Eq. 16 gives to every particle in the first step from rest.
std::vector<double> predict_shares(const ClothModel& model, double step) {
  const auto n = model.mass.size();
  std::vector<double> a(n), sum(n, 0.0), share(n);
  for (std::size_t i = 0; i < n; ++i) a[i] = step * step * model.stiffness_sum[i] / model.mass[i];
  const std::vector<Spring>& springs = model.topology->springs;
  for (std::size_t s = 0; s < springs.size(); ++s) {
    const double k = model.stiffness(static_cast<int>(s));
    sum[springs[s].i] += k / (1 + a[springs[s].j]);
    sum[springs[s].j] += k / (1 + a[springs[s].i]);
  }
  for (std::size_t i = 0; i < n; ++i) share[i] = (1 + step * step / model.mass[i] * sum[i]) / (1 + a[i]);
  return share;
}

/// Growth factor per step, ω h = x, of the amplitude of a free oscillation of two particles. Amplitude: norm
/// of (extension, relative velocity / ω), maximum over a period, relative to the first period. 0: it dies out
/// within a period.
double measure_growth(const std::string& name, double x) {
  constexpr double kMass = 0.1, kLength = 1, kStretch = 1e-3, kOmega = 10;
  constexpr int kSteps = 600;
  constexpr double kRounding = 0.02;  // of the first amplitude: resolution of floats
  HungCloth pair =
      make_chain({{0, 0, 0}, {0, kLength + kStretch, 0}}, kMass, kLength, kMass * kOmega * kOmega / 2);
  pair.environment.gravity = Vec3::Zero();
  IntegratorSettings settings{.integrator = name};
  settings.xpbd.substeps = 1;
  settings.implicit_euler.tolerance = 1e-6;
  const auto integrator = make_integrator(settings);
  const auto jobs = make_serial_jobs();
  std::vector<double> amplitude;
  for (int s = 0; s < kSteps; ++s) {
    integrator->advance(*pair.model, pair.environment, x / kOmega, *jobs, pair.state);
    const double extension = (pair.state.position(1) - pair.state.position(0)).norm() - kLength;
    amplitude.push_back(std::hypot(extension, (pair.state.v.get(1) - pair.state.v.get(0)).norm() / kOmega));
  }
  const auto period = static_cast<std::ptrdiff_t>(std::ceil(2 * kPi / x)) + 1;
  const auto largest = [&](std::ptrdiff_t first) {
    return *std::max_element(amplitude.begin() + first, amplitude.begin() + first + period);
  };
  std::ptrdiff_t last = kSteps - period;
  while (last > 0 && largest(last) < kRounding * largest(0)) --last;
  return last == 0 ? 0 : std::pow(largest(last) / largest(0), 1.0 / static_cast<double>(last));
}

/// |λ| of BDF2: (3/2 − i x) z² − 2 z + 1/2 = 0, the root that tends to 1 as x tends to 0.
double bdf2_growth(double x) {
  const std::complex<double> lead(1.5, -x);
  return std::abs((2.0 + std::sqrt(4.0 - 2.0 * lead)) / (2.0 * lead));
}

std::string growth_cell(double growth) { return growth > 0 ? fmt::format("{:.4f}", growth) : "dies out"; }

}  // namespace

Hypothesis gravity_is_filtered() {
  Hypothesis hypothesis{.title = "Gravity is filtered like every other force", .source = "not in the paper"};
  hypothesis.text = {
      "Eq. 16 is exactly two Jacobi sweeps of Eq. 14 from Δv = 0, and these also filter gravity. With "
      "a = h²Σk/m, a particle with the same a as its neighbours gets (1 + 2a)/(1 + a)² of gravity. The "
      "measurement is the first step from rest of a free sheet of 17² particles, for its middle particle. "
      "Deviation: the maximum over all particles, with the border, from their formula "
      "Δv = g h [1 + h²/m Σ k/(1 + a_j)]/(1 + a)."};
  hypothesis.found.tables = {
      {{"a", "measured share of g", "formula", "largest deviation of any particle"}, {}}};
  constexpr int kSide = 17;
  constexpr std::size_t kMiddle = kSide * kSide / 2;
  const HungCloth sheet = make_hung_sheet(kSide, "simplified", {});
  PlotSeries measured{"measured", {}}, formula{"formula", {}};
  double worst = 0, at_100 = 0;
  for (const double a : {0.01, 0.1, 1.0, 10.0, 100.0, 1000.0, 10000.0, 56000.0}) {
    const double step = std::sqrt(a * sheet.model->mass[kMiddle] / sheet.model->stiffness_sum[kMiddle]);
    ClothState state = sheet.state;
    make_paper({})->advance(*sheet.model, {}, step, *make_serial_jobs(), state);
    const std::vector<double> share = predict_shares(*sheet.model, step);
    double deviation = 0;
    for (std::size_t i = 0; i < share.size(); ++i)
      deviation = std::max(deviation, std::abs(state.v.get(i).y() / (-kGravity * step) - share[i]));
    const double got = state.v.get(kMiddle).y() / (-kGravity * step);
    worst = std::max(worst, deviation);
    if (a == 100) at_100 = got;
    measured.points.push_back({a, got, ""});
    formula.points.push_back({a, gravity_factor(a), ""});
    hypothesis.found.tables[0].rows.push_back({fmt::format("{:g}", a), fmt::format("{:.5f}", got),
                                               fmt::format("{:.5f}", gravity_factor(a)),
                                               fmt::format("{:.1e}", deviation)});
  }
  hypothesis.found.metrics = {{"gravity_share_at_a_100", at_100, "1", "1; formula 0.0197", 1e-4},
                              {"gravity_formula_deviation", worst, "1", "0", 1e-5}};
  hypothesis.text.push_back(
      "Real fabric has a = 56 000 at 60 steps per second: it hangs in the air, stable and wrong. The fix "
      "(`paper_fixed`) keeps uniform acceleration outside the filter. An exact solve of Eq. 12 (`desbrun`) "
      "needs no fix, because the rows of H sum to zero.");
  hypothesis.found.pictures = {{"paper_gravity.svg", "Share of gravity after the filter of Eq. 16.",
                                to_svg({.x_title = "a = h²Σk/m",
                                        .y_title = "share of gravity",
                                        .panels = {{"first step from rest", {measured, formula}}},
                                        .line = PlotLine::through_all})}};
  return hypothesis;
}

Hypothesis no_damping_of_its_own() {
  Hypothesis hypothesis{.title = "A term of Eq. 9 is missing in Eq. 12, and with it the damping",
                        .source = "not in the paper"};
  hypothesis.text = {
      "Implicit Euler damps fast oscillations: per step of ω h = x their amplitude falls by the factor "
      "1/√(1 + x²). The cause is the term h·H·v, which is in Eq. 9 but not in Eq. 12. Measured: growth of "
      "the amplitude per step for two particles on a spring, over 600 steps."};
  const double sizes[] = {0.1, 0.5, 2.0};
  hypothesis.found.tables = {{{"integrator", "ω h = 0.1", "0.5", "2", "theory at 0.5"}, {}}};
  const double euler = 1 / std::sqrt(1.25);
  const std::vector<std::pair<std::string, std::optional<double>>> methods = {
      {"paper", 1.0},  {"paper_fixed", std::nullopt}, {"desbrun", euler}, {"implicit_euler", euler},
      {"xpbd", euler}, {"newton", bdf2_growth(0.5)},  {"explicit", 1.0}};
  double paper = 0, desbrun = 0, newton = 0;
  for (const auto& [name, theory] : methods) {
    std::vector<std::string> row{"`" + name + "`"};
    for (const double x : sizes) {
      if (name == "explicit" && x >= 2) {
        row.emplace_back("unstable");
        continue;
      }
      const double growth = measure_growth(name, x);
      row.push_back(growth_cell(growth));
      if (x != 0.5) continue;
      if (name == "paper") paper = growth;
      if (name == "desbrun") desbrun = growth;
      if (name == "newton") newton = growth;
    }
    row.push_back(theory ? fmt::format("{:.4f}", *theory) : "–");
    hypothesis.found.tables[0].rows.push_back(row);
  }
  hypothesis.found.metrics = {
      {"paper_growth", paper, "1", "1 without the term, 0.8944 with it", 1e-3},
      {"desbrun_growth", desbrun, "1", "0.8944", 1e-3},
      {"newton_growth", newton, "1", fmt::format("{:.4f} (BDF2)", bdf2_growth(0.5)), 1e-3}};
  hypothesis.text.emplace_back(
      "Without damping of its springs, d > 0, cloth with Eq. 16 therefore never comes to rest. `paper_fixed` "
      "and `desbrun` keep the term.");
  return hypothesis;
}

Hypothesis damping_feeds_motion() {
  Hypothesis hypothesis{.title = "Eq. 2 has the wrong sign", .source = "not in the paper"};
  hypothesis.text = {
      "The damping force on particle i is printed as d (v_i − v_j), which accelerates relative motion. "
      "Measured: energy of a free sheet of 11² particles with random velocities after 50 steps of 1 ms, "
      "over that at the start (10 N/m, d = 0.01 N·s/m)."};
  const auto topology = build_grid_topology({.cells_x = 10, .cells_z = 10}, SpringModel::simplified);
  const auto model = build_cloth_model(
      topology,
      {.structural = 10, .shear = 5, .bend = 0.1, .damping = 0.01, .damping_kind = DampingKind::plain});
  ClothState start = make_state(topology->mesh.positions);
  Random random(1);
  for (std::size_t i = 0; i < start.v.size(); ++i)
    start.v.set(i, {random.uniform(-0.1, 0.1), random.uniform(-0.1, 0.1), random.uniform(-0.1, 0.1)});
  const auto energy = [&](const ClothState& state) {
    return compute_kinetic_energy(*model, state) + compute_elastic_energy(*model, state);
  };
  const auto ratio = [&](bool printed) {
    ClothState state = start;
    const auto integrator = make_paper({.printed_damping_sign = printed});
    for (int s = 0; s < 50; ++s)
      integrator->advance(*model, {.gravity = Vec3::Zero()}, 1e-3, *make_serial_jobs(), state);
    return energy(state) / energy(start);
  };
  hypothesis.found.metrics = {{"energy_ratio_as_printed", ratio(true), "1", "< 1", 0},
                              {"energy_ratio_corrected", ratio(false), "1", "< 1", 0.01}};
  hypothesis.text.emplace_back(
      "We correct it to d (v_j − v_i); `solver.paper.damping_sign = \"as_printed\"` restores it.");
  return hypothesis;
}

}  // namespace weft::engine::lab::paper
