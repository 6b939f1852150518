#include "lab/textile/fabric_hypotheses.h"

#include <algorithm>
#include <cmath>

#include "lab/report/plot.h"
#include "lab/textile/drape.h"
#include "lab/textile/hung_strip.h"
#include "lab/textile/laboratory_tests.h"
#include "weft/fabric.h"
#include "weft/world/measures.h"

namespace weft::engine::lab {
namespace {

constexpr double kElastica = 0.88473;  // H/W at a chord angle of 41.5°

const char* name_of(SpecimenMesh mesh) { return mesh == SpecimenMesh::grid ? "grid" : "random"; }

double find_metric(const Findings& result, const std::string& name) {
  const auto found = std::find_if(result.metrics.begin(), result.metrics.end(),
                                  [&](const Metric& f) { return f.name == name; });
  return found->value;
}

/// A mesh of the comparison.
struct MeshCase {
  std::string name;
  int cells;  // along the longer side; discs have about as many vertices, in rings
  SpecimenMesh mesh;
};

std::vector<MeshCase> five_meshes(bool quick) {
  if (quick) return {{"grid 25²", 24, SpecimenMesh::grid}, {"random, coarse", 24, SpecimenMesh::random}};
  return {{"grid 33²", 32, SpecimenMesh::grid},
          {"grid 65²", 64, SpecimenMesh::grid},
          {"grid 129²", 128, SpecimenMesh::grid},
          {"random, coarse", 24, SpecimenMesh::random},
          {"random, fine", 48, SpecimenMesh::random}};
}

/// Rings of a disc with about as many vertices as a grid of cells × cells; at most 45, to limit run time.
int rings_like(int cells) { return std::min(45, static_cast<int>(std::lround(cells / std::sqrt(3.0)))); }

Specimen settle_hammock(const Fabric& fabric, const MeshCase& mesh, Findings& result) {
  Specimen specimen = make_hammock(fabric, mesh.cells, mesh.mesh);
  if (!settle(specimen, 1)) result.warnings.push_back("the strip on " + mesh.name + " did not come to rest");
  return specimen;
}

double spread_of(const std::vector<double>& values) {
  const auto [least, most] = std::minmax_element(values.begin(), values.end());
  return *most - *least;
}

struct Swing {
  double strain = 0;        // maximum principal stretch minus one, over all frames [1]
  double newton_steps = 0;  // per frame [1]
};

/// A sheet of a metre, held by two corners, for a second after its release from horizontal.
Swing swing_sheet(const Fabric& fabric, int cells, SpecimenMesh mesh) {
  constexpr int kFrames = 60;
  const Grid grid{.size_x = 1, .size_z = 1, .cells_x = cells, .cells_z = cells};
  Specimen sheet = make_rectangle(fabric, grid, mesh);
  sheet.environment.gravity = {0, -9.81, 0};
  clamp(sheet, [](const Vec3& p) -> std::optional<Vec3> {
    if (p.z() > 1e-9 || (p.x() > 1e-9 && p.x() < 1 - 1e-9)) return {};
    return p;
  });
  const auto integrator = make_newton({});
  const auto jobs = make_serial_jobs();
  Swing swing;
  for (int frame = 0; frame < kFrames; ++frame) {
    const IntegratorReport report =
        integrator->advance(*sheet.model, sheet.environment, 1.0 / 60, *jobs, sheet.state);
    swing.newton_steps += static_cast<double>(report.iterations) / kFrames;
    const auto stretches = compute_principal_stretches(*sheet.model, sheet.state);
    swing.strain = std::max(swing.strain, stretches->max - 1);
  }
  return swing;
}

double mean_of(const std::vector<double>& values) {
  double sum = 0;
  for (const double v : values) sum += v;
  return sum / static_cast<double>(values.size());
}

}  // namespace

Findings fabric_constants(const SectionOptions& options) {
  Findings result;
  Table table{{"fabric", "membrane, mesh", "c11", "given", "c22", "given", "c12", "given", "g", "given"},
              {},
              "Stiffness from tensile and shear tests, and given stiffness [N/m]"};
  const std::vector<const char*> names =
      options.quick ? std::vector<const char*>{"denim"}
                    : std::vector<const char*>{"silk", "denim", "11oz_black_denim", "gray_interlock",
                                               "pink_ribbon_brown"};
  for (const SpecimenMembrane membrane : {SpecimenMembrane::triangle, SpecimenMembrane::springs}) {
    for (const SpecimenMesh mesh : {SpecimenMesh::grid, SpecimenMesh::random}) {
      const bool has_springs = membrane == SpecimenMembrane::springs, is_grid = mesh == SpecimenMesh::grid;
      const SpecimenSettings specimen{.mesh = mesh, .membrane = membrane};
      double worst = 0;
      for (const char* name : names) {
        const Fabric& f = find_fabric(name);
        if (has_springs && f.c11 <= f.g) continue;  // not representable by springs
        const std::string kind = std::string(has_springs ? "springs, " : "triangle, ") + name_of(mesh);
        options.report_progress(std::string(name) + ", " + kind);
        const Findings tensile = test_tensile(f, specimen);
        const double c11 = find_metric(tensile, "c11"), c22 = find_metric(tensile, "c22"),
                     c12 = find_metric(tensile, "c12"), g = find_metric(test_shear(f, specimen), "g");
        table.rows.push_back({name, kind, digits(c11, 5), digits(f.c11, 5), digits(c22, 5), digits(f.c22, 5),
                              digits(c12, 4), digits(f.c12, 4), digits(g, 4), digits(f.g, 4)});
        worst =
            std::max({worst, std::abs(c11 / f.c11 - 1), std::abs(c22 / f.c22 - 1), std::abs(g / f.g - 1)});
      }
      const std::string error =
          std::string(has_springs ? "springs_" : "") + "stiffness_error_" + name_of(mesh);
      const bool is_expected = is_grid || !has_springs;  // springs on random meshes are approximate
      result.metrics.push_back(is_expected ? expect(error, 100 * worst, "%", 0, is_grid ? 1.0 : 2.0)
                                           : Metric{error, 100 * worst, "%"});
    }
  }
  result.tables.push_back(std::move(table));
  return result;
}

Findings fabric_cantilever(const SectionOptions& options) {
  Findings result;
  Table table{{"fabric", "mesh", "cells", "warp", "weft", "bias"},
              {},
              "H/W of a strip cut along warp, weft and bias; elastica: 0.88473"};
  const std::vector<int> resolutions = options.quick ? std::vector{10} : std::vector{10, 25, 50};
  for (const char* name : {"denim", "silk"}) {
    if (options.quick && name != std::string("denim")) continue;
    for (const SpecimenMesh mesh : {SpecimenMesh::grid, SpecimenMesh::random}) {
      for (const int cells : resolutions) {
        options.report_progress(std::string(name) + ", " + name_of(mesh) + " of " + std::to_string(cells) +
                                " cells");
        std::vector<double> ratio;
        for (const StripDirection direction :
             {StripDirection::warp, StripDirection::weft, StripDirection::bias}) {
          const Findings test =
              test_cantilever(find_elastic_fabric(name), {.mesh = mesh, .resolution = cells}, direction);
          ratio.push_back(find_metric(test, "h_over_w"));
        }
        table.rows.push_back({name, name_of(mesh), std::to_string(cells), digits(ratio[0], 4),
                              digits(ratio[1], 4), digits(ratio[2], 4)});
        if (cells != resolutions.back()) continue;
        const double error = std::max(std::abs(ratio[0] / kElastica - 1), std::abs(ratio[1] / kElastica - 1));
        const std::string where = std::string(name) + "_" + name_of(mesh);
        result.metrics.push_back(
            expect("h_over_w_error_" + where, 100 * error, "%", 0, mesh == SpecimenMesh::grid ? 2.0 : 4.0));
        result.metrics.push_back(
            expect("h_over_w_error_bias_" + where, 100 * std::abs(ratio[2] / kElastica - 1), "%", 0, 5));
      }
    }
  }
  result.tables.push_back(std::move(table));
  return result;
}

Findings fabric_drape(const SectionOptions& options) {
  Findings result;
  const std::vector<int> rings = options.quick ? std::vector{10, 15} : std::vector{15, 20, 30, 45};
  Table table{{"rings", "regular", "folds", "irregular", "folds"},
              {},
              "Drape coefficient of denim without hysteresis, mean and spread of five specimens [%]"};
  PlotPanel panel{"drape coefficient of denim", {{"regular rings", {}}, {"irregular rings", {}}}};
  for (const int n : rings) {
    std::vector<std::string> row = {std::to_string(n)};
    for (const SpecimenMesh mesh : {SpecimenMesh::grid, SpecimenMesh::random}) {
      options.report_progress("denim, " + std::to_string(n) + " rings");
      const Findings test =
          test_drape(find_elastic_fabric("denim"), {.mesh = mesh, .resolution = n}, options.threads);
      const double coefficient = find_metric(test, "drape_coefficient");
      row.push_back(digits(coefficient, 3) + " ± " +
                    digits(find_metric(test, "drape_coefficient_spread"), 2));
      row.push_back(digits(find_metric(test, "drape_nodes"), 2));
      panel.series[mesh == SpecimenMesh::grid ? 0 : 1].points.push_back(
          {static_cast<double>(n), coefficient, ""});
      if (n == rings.back() && mesh == SpecimenMesh::grid) result.pictures = test.pictures;
    }
    table.rows.push_back(row);
  }
  const auto last = panel.series[0].points.end() - 1;
  result.metrics.push_back(expect("drape_change_with_resolution", last->y - (last - 1)->y, "%", 0, 3));
  result.tables.push_back(std::move(table));
  result.pictures.push_back({"fabric_drape.svg",
                             "Drape coefficient of denim against the number of rings of the mesh.",
                             to_svg({.x_title = "rings of triangles",
                                     .y_title = "drape coefficient, %",
                                     .panels = {std::move(panel)},
                                     .x_scale = PlotScale::linear,
                                     .y_scale = PlotScale::linear,
                                     .line = PlotLine::through_all})});
  return result;
}

Findings fabric_drapes(const SectionOptions& options) {
  Findings result;
  Table table{{"fabric", "drape coefficient [%]", "folds"},
              {},
              "Every preset, mean and spread of five specimens of 20 rings"};
  for (const FabricPreset& preset : fabric_presets()) {
    if (options.quick && preset.name != "silk" && preset.name != "leather") continue;
    options.report_progress(preset.name);
    const Findings test = test_drape(preset.fabric, {.resolution = options.quick ? 10 : 20}, options.threads);
    table.rows.push_back({preset.name,
                          digits(find_metric(test, "drape_coefficient"), 3) + " ± " +
                              digits(find_metric(test, "drape_coefficient_spread"), 2),
                          digits(find_metric(test, "drape_nodes"), 2)});
    result.warnings.insert(result.warnings.end(), test.warnings.begin(), test.warnings.end());
  }
  result.tables.push_back(std::move(table));
  return result;
}

Findings fabric_locking(const SectionOptions& options) {
  const auto percent = [&](double stiffness, SpecimenSettings settings) {
    const Fabric fabric = {.density = 0.15,
                           .c11 = stiffness,
                           .c22 = stiffness,
                           .c12 = 0,
                           .g = 40,
                           .bend_warp = 1e-6,
                           .bend_weft = 1e-6,
                           .bend_bias = 1e-6,
                           .damping = 0,
                           .strain_limit = 0};
    const int num_seeds = options.quick ? 1 : 3;
    options.report_progress(digits(stiffness, 5) + " N/m, " + std::to_string(settings.resolution) + " rings");
    double sum = 0;
    for (int seed = 1; seed <= num_seeds; ++seed)
      sum += 100 *
             simulate_drape(fabric, settings, static_cast<std::uint64_t>(seed), options.threads).coefficient;
    return sum / num_seeds;
  };
  constexpr double kUsual = 2000;  // c11 = c22 [N/m]
  const int fine = options.quick ? 15 : 30;
  Findings result;
  Table table{{"rings", "mesh", "c11 = c22 [N/m]", "warp [degrees]", "drape coefficient [%]"},
              {},
              "A fabric of 0.15 kg/m², g = 40 N/m, bending 1e-6 N·m"};
  const auto measure = [&](double stiffness, const SpecimenSettings& settings) {
    const double drape = percent(stiffness, settings);
    table.rows.push_back({std::to_string(settings.resolution), name_of(settings.mesh), digits(stiffness, 5),
                          digits(settings.warp_deg, 2), digits(drape, 3)});
    return drape;
  };
  const double usual = measure(kUsual, {.resolution = fine});
  if (!options.quick) {
    const double finest = measure(kUsual, {.resolution = 45});
    for (const auto& [rings, tolerated] : {std::pair(15, 10.0), std::pair(24, 6.0)})
      result.metrics.push_back(expect("drape_" + std::to_string(rings) + "_rings_minus_45",
                                      measure(kUsual, {.resolution = rings}) - finest, "%", 0, tolerated));
    result.metrics.push_back(expect("drape_30_rings_minus_45", usual - finest, "%", 0, 3));
  }
  std::vector<double> of_stiffness = {usual}, of_warp = {usual};
  for (const double stiffness : {400.0, 20000.0})
    of_stiffness.push_back(measure(stiffness, {.resolution = fine}));
  const double crooked = measure(kUsual, {.mesh = SpecimenMesh::random, .resolution = fine});
  for (const double degrees : {15.0, 30.0, 45.0}) {
    if (options.quick && degrees != 45) continue;
    of_warp.push_back(measure(kUsual, {.resolution = fine, .warp_deg = degrees}));
  }
  result.metrics.push_back(expect("drape_spread_over_stiffness", spread_of(of_stiffness), "%", 0, 4));
  result.metrics.push_back(expect("drape_crooked_minus_regular", crooked - usual, "%", 0, 4));
  result.metrics.push_back(expect("drape_spread_over_warp", spread_of(of_warp), "%", 0, 3));
  result.tables.push_back(std::move(table));
  return result;
}

Findings fabric_meshes(const SectionOptions& options) {
  Findings result;
  Fabric fabric = find_fabric("cotton_shirting");
  Table table{{"mesh", "drape coefficient [%]", "folds", "sag [m]", "period [s]"},
              {},
              "Cotton shirting on five meshes"};
  std::vector<double> drapes, sags, periods;
  for (const MeshCase& mesh : five_meshes(options.quick)) {
    options.report_progress("cotton shirting on " + mesh.name);
    const Findings drape =
        test_drape(fabric, {.mesh = mesh.mesh, .resolution = rings_like(mesh.cells)}, options.threads);
    drapes.push_back(find_metric(drape, "drape_coefficient"));
    sags.push_back(measure_sag(settle_hammock(fabric, mesh, result)));
    periods.push_back(measure_swing_period(fabric, mesh.cells, mesh.mesh));
    table.rows.push_back({mesh.name, digits(drapes.back(), 3), digits(find_metric(drape, "drape_nodes"), 2),
                          digits(sags.back(), 4), digits(periods.back(), 4)});
  }
  result.metrics = {
      expect("drape_spread_over_meshes", spread_of(drapes), "%", 0, 3),
      expect("sag_spread_over_meshes", 100 * spread_of(sags) / mean_of(sags), "%", 0, 2),
      expect("period_spread_over_meshes", 100 * spread_of(periods) / mean_of(periods), "%", 0, 1)};
  result.tables.push_back(std::move(table));
  return result;
}

Findings fabric_strain_limit(const SectionOptions& options) {
  constexpr double kLimit = 0.01, kAllowed = 1.5;  // [1], [%]
  Findings result;
  Table table{{"fabric", "mesh", "cells", "stretch", "Newton steps", "stretch without a limit"},
              {},
              "Maximum principal stretch minus one [%] and Newton steps per frame, with strain_limit = 0.01"};
  const std::vector<int> resolutions = options.quick ? std::vector{12} : std::vector{16, 32, 64};
  double worst = 0;
  for (const char* name : {"gray_interlock", "cotton_shirting"}) {
    for (const SpecimenMesh mesh : {SpecimenMesh::grid, SpecimenMesh::random}) {
      for (const int cells : resolutions) {
        options.report_progress(std::string(name) + ", " + name_of(mesh) + " of " + std::to_string(cells) +
                                " cells");
        Fabric fabric = find_fabric(name);
        const Swing free = swing_sheet(fabric, cells, mesh);
        fabric.strain_limit = kLimit;
        const Swing held = swing_sheet(fabric, cells, mesh);
        worst = std::max(worst, 100 * held.strain);
        table.rows.push_back({name, name_of(mesh), std::to_string(cells), digits(100 * held.strain, 3),
                              digits(held.newton_steps, 2), digits(100 * free.strain, 3)});
      }
    }
  }
  result.metrics.push_back(expect("largest_stretch", worst, "%", 0, kAllowed));
  result.tables.push_back(std::move(table));
  return result;
}

Findings fabric_steps(const SectionOptions& options) {
  Findings result;
  Table table{{"steps per second", "sag [m]", "period [s]"}, {}, "Denim at three step lengths"};
  const Fabric denim = find_elastic_fabric("denim");
  const int cells = options.quick ? 12 : 32;
  std::vector<double> sags;
  for (const int steps_per_second : {60, 120, 240}) {
    options.report_progress("denim at " + std::to_string(steps_per_second) + " steps per second");
    Specimen specimen = make_hammock(denim, cells, SpecimenMesh::grid);
    specimen.environment.wind.drag = 5 * denim.density;
    const auto integrator = make_newton({});
    const auto jobs = make_serial_jobs();
    for (int s = 0; s < 4 * steps_per_second; ++s)
      integrator->advance(*specimen.model, specimen.environment, 1.0 / steps_per_second, *jobs,
                          specimen.state);
    sags.push_back(measure_sag(specimen));
    const double period = measure_swing_period(denim, cells, SpecimenMesh::grid, steps_per_second);
    table.rows.push_back({std::to_string(steps_per_second), digits(sags.back(), 5), digits(period, 5)});
  }
  result.metrics = {expect("sag_spread_over_steps", 100 * spread_of(sags) / mean_of(sags), "%", 0, 1)};
  result.tables.push_back(std::move(table));
  return result;
}

}  // namespace weft::engine::lab
