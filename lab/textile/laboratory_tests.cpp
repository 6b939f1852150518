#include "lab/textile/laboratory_tests.h"

#include <algorithm>
#include <cmath>

#include "lab/report/plot.h"
#include "lab/textile/drape.h"
#include "weft/world/cloth_forces.h"

namespace weft::engine::lab {
namespace {

constexpr double kGravity = 9.81;
constexpr double kDegree = 3.141592653589793 / 180;
constexpr double kPeirceLoad = 8.004;  // ρ g L³/B at which the elastica's chord angle is 41.5°
constexpr int kStripCells = 25, kStripWidth = 4;
constexpr int kClampedColumn = 1;   // the last held column; the edge of the clamp is half a cell before it
constexpr double kSheetSize = 0.1;  // of tensile and shear specimens [m]
constexpr int kSheetCells = 10;
constexpr double kStrain = 1e-3;

constexpr double kPeirceAngle = 41.5 * kDegree;

/// Peirce's function: bending length against chord angle.
double peirce(double chord) { return std::cbrt(std::cos(chord / 2) / (8 * std::tan(chord))); }

int or_default(int value, int otherwise) { return value > 0 ? value : otherwise; }

double warp_angle(StripDirection direction) {
  switch (direction) {
    case StripDirection::warp:
      return 0;
    case StripDirection::weft:
      return 90;
    case StripDirection::bias:
      break;
  }
  return 45;
}

ReportPicture picture_of(Animation specimen) {
  return {.file = "specimen",
          .caption = "A specimen.",
          .animation = std::make_shared<const Animation>(std::move(specimen))};
}

void warn_unsettled(bool is_settled, Findings& result) {
  if (!is_settled) result.warnings.emplace_back("the specimen did not come to rest; results are rough");
}

/// A strip clamped up to the middle of its first cells.
struct Strip {
  Specimen specimen;
  double cell = 0, overhang = 0;
  int cells = 0;
};

Strip make_strip(const Fabric& fabric, const SpecimenSettings& settings, double warp_deg) {
  const double radians = warp_deg * kDegree;
  const double rigidity = bending_rigidity(fabric, std::cos(radians), std::sin(radians));
  Strip strip;
  strip.cells = or_default(settings.resolution, kStripCells);
  strip.overhang = std::cbrt(kPeirceLoad * rigidity / (fabric.density * kGravity));
  strip.cell = strip.overhang / (strip.cells - 0.5);
  const Grid grid{.size_x = strip.cells * strip.cell,
                  .size_z = kStripWidth * strip.cell,
                  .cells_x = strip.cells,
                  .cells_z = kStripWidth};
  strip.specimen =
      make_rectangle(fabric, grid, settings.mesh, {.warp_deg = warp_deg, .straight_column = kClampedColumn});
  strip.specimen.environment.gravity = {0, -kGravity, 0};
  clamp(strip.specimen, [&](const Vec3& p) -> std::optional<Vec3> {
    if (p.x() > (kClampedColumn + 0.01) * strip.cell) return {};
    return p;
  });
  return strip;
}

/// Moves every border vertex by a homogeneous deformation, and lets the others come to rest.
Specimen make_deformed(const Fabric& fabric, const SpecimenSettings& settings,
                       const std::function<Vec3(const Vec3&)>& deform, Findings& result) {
  const int cells = or_default(settings.resolution, kSheetCells);
  const Grid grid{.size_x = kSheetSize, .size_z = kSheetSize, .cells_x = cells, .cells_z = cells};
  Specimen specimen = make_rectangle(fabric, grid, settings.mesh, {.membrane = settings.membrane});
  const auto is_end = [](double x) { return x < 1e-9 || x > kSheetSize - 1e-9; };
  clamp(specimen, [&](const Vec3& p) -> std::optional<Vec3> {
    if (!is_end(p.x()) && !is_end(p.z())) return {};
    return deform(p);
  });
  warn_unsettled(settle(specimen, kSheetSize), result);
  return specimen;
}

/// Force per width at the clamp along x = size (axis 0) or z = size (axis 2) [N/m].
Vec3 pull(const Specimen& specimen, int axis) {
  const std::vector<Vec3> force = compute_membrane_forces(specimen);
  Vec3 sum = Vec3::Zero();
  for (std::size_t i = 0; i < force.size(); ++i) {
    if (specimen.rest()[i][axis] > kSheetSize - 1e-9) sum -= force[i];
  }
  return sum / kSheetSize;
}

/// Two entries of C from a stretch along x or z: C_aa and C_ab. The second Piola–Kirchhoff stress is C times
/// Green's strain e + e²/2. The force per rest width is the stress, times 1 + e along the pull.
std::array<double, 2> stretch(const Fabric& fabric, const SpecimenSettings& settings, int axis,
                              Findings& result) {
  const Specimen specimen = make_deformed(
      fabric, settings,
      [axis](Vec3 p) {
        p[axis] *= 1 + kStrain;
        return p;
      },
      result);
  const double green = kStrain + 0.5 * kStrain * kStrain;
  const int across = 2 - axis;
  result.pictures = {picture_of(show_specimen(*specimen.model, specimen.state))};
  return {pull(specimen, axis)[axis] / ((1 + kStrain) * green), pull(specimen, across)[across] / green};
}

constexpr double kBendLength = 0.01;                      // between the clamps [m]
constexpr double kMostCurvature = 250, kBendStep = 12.5;  // [1/m]
constexpr double kBendTime = 0.01;       // per step of the integrator, so long that nothing swings [s]
constexpr double kBendTolerance = 1e-6;  // [m/s]
constexpr int kBendCells = 20, kBendCellsAcross = 8, kBendStepsEach = 3, kBendClampCells = 2;

/// A point of a circular arc, at a distance along it from its middle [m].
Vec3 on_arc(double curvature, double along, double z) {
  const double angle = curvature * along;
  return curvature == 0 ? Vec3(along, 0, z)
                        : Vec3(std::sin(angle) / curvature, (1 - std::cos(angle)) / curvature, z);
}

/// A strip with its middle at x = 0 on a circular arc, and its clamps.
struct BendingTester {
  Specimen specimen;
  double clamp_edge = 0, width = 0;  // [m]

  /// Clamps at a curvature [1/m].
  void bend(double curvature) {
    PinTargets& pins = specimen.environment.pins;
    for (std::size_t k = 0; k < pins.particle.size(); ++k) {
      const Vec3& p = specimen.rest()[pins.particle[k]];
      pins.position[k] = on_arc(curvature, p.x() - (clamp_edge - 0.5 * kBendLength), p.z());
    }
  }

  /// Moment per width of the forces on the far clamp, about its edge; positive for positive curvature [N].
  double moment(double curvature) const {
    const Vec3 edge = on_arc(curvature, 0.5 * kBendLength, 0);
    const std::vector<Vec3> force = compute_elastic_forces(*specimen.model, specimen.state);
    double sum = 0;
    for (const int i : specimen.environment.pins.particle) {
      if (specimen.rest()[i].x() < clamp_edge - 1e-9) continue;
      sum -= (specimen.state.position(i) - edge).cross(force[i]).z();
    }
    return sum / width;
  }
};

BendingTester make_bending_tester(const Fabric& fabric, const SpecimenSettings& settings, double warp_deg) {
  const int cells = or_default(settings.resolution, kBendCells);
  const double cell = kBendLength / cells;
  const Grid grid{.size_x = kBendLength + 2 * kBendClampCells * cell,
                  .size_z = kBendCellsAcross * cell,
                  .cells_x = cells + 2 * kBendClampCells,
                  .cells_z = kBendCellsAcross};
  BendingTester tester;
  tester.specimen =
      make_rectangle(fabric, grid, settings.mesh, {.warp_deg = warp_deg, .straight_column = kBendClampCells});
  tester.clamp_edge = kBendLength + kBendClampCells * cell;
  tester.width = grid.size_z;
  clamp(tester.specimen, [&](const Vec3& p) -> std::optional<Vec3> {
    const bool is_held = p.x() < kBendClampCells * cell + 1e-9 || p.x() > tester.clamp_edge - 1e-9;
    return is_held ? std::optional(p) : std::nullopt;
  });
  for (int i = 0; i < tester.specimen.model->num_particles(); ++i)
    tester.specimen.state.set_position(i, tester.specimen.rest()[i] - Vec3(grid.size_x / 2, 0, 0));
  return tester;
}

/// The moment at a curvature, between the points of a branch.
double moment_at(const std::vector<PlotPoint>& branch, double curvature) {
  for (std::size_t k = 1; k < branch.size(); ++k) {
    const PlotPoint &a = branch[k - 1], &b = branch[k];
    if (curvature <= b.x) return a.y + (curvature - a.x) / (b.x - a.x) * (b.y - a.y);
  }
  return branch.back().y;
}

}  // namespace

Findings test_bending(const Fabric& fabric, const SpecimenSettings& settings, StripDirection direction) {
  BendingTester tester = make_bending_tester(fabric, settings, warp_angle(direction));
  const auto integrator = make_implicit_euler_in_double({.tolerance = kBendTolerance});
  const auto jobs = make_serial_jobs();
  const auto bend_to = [&](double from, double to) {
    std::vector<PlotPoint> branch;
    const int steps = static_cast<int>(std::lround(std::abs(to - from) / kBendStep));
    for (int s = 1; s <= steps; ++s) {
      const double curvature = from + (to - from) * s / steps;
      tester.bend(curvature);
      for (int k = 0; k < kBendStepsEach; ++k) {
        integrator->advance(*tester.specimen.model, tester.specimen.environment, kBendTime, *jobs,
                            tester.specimen.state);
      }
      branch.push_back({curvature, tester.moment(curvature), ""});
    }
    return branch;
  };
  bend_to(0, kMostCurvature);
  std::vector<PlotPoint> back = bend_to(kMostCurvature, -kMostCurvature);
  std::reverse(back.begin(), back.end());
  const std::vector<PlotPoint> forth = bend_to(-kMostCurvature, kMostCurvature);
  const double slope =
      (moment_at(forth, 150) - moment_at(forth, 50) + moment_at(back, -50) - moment_at(back, -150)) / 200;
  const double width =
      (moment_at(forth, 100) - moment_at(back, 100) + moment_at(forth, -100) - moment_at(back, -100)) / 2;
  Findings result;
  result.metrics = {{"bending_rigidity", slope, "N·m"}, {"hysteresis", width, "N"}};
  const Plot plot{.x_title = "curvature [1/m]",
                  .y_title = "moment per width [N]",
                  .mark_y = 0.0,
                  .panels = {{"", {{"bending", forth}, {"bending back", back}}}},
                  .x_scale = PlotScale::linear,
                  .y_scale = PlotScale::linear,
                  .line = PlotLine::through_all};
  result.pictures = {picture_of(show_specimen(*tester.specimen.model, tester.specimen.state)),
                     {.file = "loop.svg", .caption = "Moment and curvature.", .svg = to_svg(plot)}};
  return result;
}

Findings test_cantilever(const Fabric& fabric, const SpecimenSettings& settings, StripDirection direction) {
  Strip strip = make_strip(fabric, settings, warp_angle(direction));
  Findings result;
  warn_unsettled(settle(strip.specimen, strip.overhang), result);
  double drop = 0, reach = 0;
  const int columns = strip.cells + 1;
  for (int j = 0; j <= kStripWidth; ++j) {
    const Vec3 tip = strip.specimen.state.position(j * columns + columns - 1);
    drop -= tip.y() / (kStripWidth + 1);
    reach += (tip.x() - strip.cell / 2) / (kStripWidth + 1);
  }
  const double chord = std::atan2(drop, reach);
  const double length = strip.overhang / 2 * peirce(chord) / peirce(kPeirceAngle);
  result.metrics = {{"h_over_w", drop / reach, "1"},
                    {"chord_angle", chord / kDegree, "degrees"},
                    {"bending_length", length, "m"},
                    {"bending_rigidity", fabric.density * kGravity * std::pow(length, 3), "N·m"},
                    {"overhang", strip.overhang, "m"}};
  result.pictures = {picture_of(show_specimen(*strip.specimen.model, strip.specimen.state))};
  return result;
}

Findings test_tensile(const Fabric& fabric, const SpecimenSettings& settings) {
  Findings result;
  const auto [c22, from_weft] = stretch(fabric, settings, 2, result);
  const auto [c11, from_warp] = stretch(fabric, settings, 0, result);
  result.metrics = {{"c11", c11, "N/m"}, {"c22", c22, "N/m"}, {"c12", (from_warp + from_weft) / 2, "N/m"}};
  return result;
}

Findings test_shear(const Fabric& fabric, const SpecimenSettings& settings) {
  Findings result;
  const Specimen specimen = make_deformed(
      fabric, settings, [](const Vec3& p) { return Vec3(p.x() + kStrain * p.z(), 0, p.z()); }, result);
  result.metrics = {{"g", pull(specimen, 2).x() / kStrain, "N/m"}};
  result.pictures = {picture_of(show_specimen(*specimen.model, specimen.state))};
  return result;
}

Findings test_buckling(const Fabric& fabric, const SpecimenSettings& settings) {
  constexpr double kLength = 0.1, kLean = 0.01;  // [m], of the tip at the start, as a share of the length
  constexpr int kCellsAcross = 2;
  const int cells = or_default(settings.resolution, kStripCells);
  const double cell = kLength / (cells - 0.5);
  const Grid grid{
      .size_x = cells * cell, .size_z = kCellsAcross * cell, .cells_x = cells, .cells_z = kCellsAcross};
  const double gravity_per_load = fabric.bend_warp / (fabric.density * std::pow(kLength, 3));
  Findings result;
  const auto tips = [&](double load) {
    Specimen specimen = make_rectangle(fabric, grid, settings.mesh, {.straight_column = kClampedColumn});
    specimen.environment.gravity = {0, 0, load * gravity_per_load};
    for (int i = 0; i < specimen.model->num_particles(); ++i) {
      const Vec3& p = specimen.rest()[i];
      specimen.state.set_position(i, p + Vec3(0, kLean * p.x() * p.x() / kLength, 0));
    }
    clamp(specimen, [&](const Vec3& p) -> std::optional<Vec3> {
      if (p.x() > (kClampedColumn + 0.01) * cell) return {};
      return p;
    });
    settle(specimen, kLength);
    result.pictures = {picture_of(show_specimen(*specimen.model, specimen.state))};
    return std::abs(specimen.state.position(cells).y()) > kLean * kLength;
  };
  double low = 1, high = 200;
  while (high > 1.01 * low) {
    const double middle = std::sqrt(low * high);
    (tips(middle) ? high : low) = middle;
  }
  const double load = std::sqrt(low * high);
  tips(high);  // for the picture: a strip just after tipping
  result.metrics = {
      {"critical_load", load, "1"},
      {"critical_length", std::cbrt(load * fabric.bend_warp / (fabric.density * kGravity)), "m"}};
  return result;
}

Findings test_drape(const Fabric& fabric, const SpecimenSettings& settings, int threads) {
  constexpr int kSpecimens = 5;
  Findings result;
  double nodes = 0;
  std::vector<double> percent;
  for (int k = 0; k < kSpecimens; ++k) {
    const Drape drape = simulate_drape(fabric, settings, static_cast<std::uint64_t>(k) + 1, threads);
    warn_unsettled(drape.is_at_rest, result);
    percent.push_back(100 * drape.coefficient);
    nodes += static_cast<double>(drape.nodes) / kSpecimens;
    if (k == 0) result.pictures = {picture_of(drape.specimen)};
  }
  double mean = 0, variance = 0;
  for (const double p : percent) mean += p / kSpecimens;
  for (const double p : percent) variance += (p - mean) * (p - mean) / (kSpecimens - 1);
  result.metrics = {{"drape_coefficient", mean, "%"},
                    {"drape_coefficient_spread", std::sqrt(variance), "%"},
                    {"drape_nodes", nodes, "1"},
                    {"specimens", kSpecimens, "1"}};
  return result;
}

}  // namespace weft::engine::lab
