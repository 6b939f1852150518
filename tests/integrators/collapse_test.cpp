/// Crushed cloth opens again (forces/collapse.h).

#include <gtest/gtest.h>

#include <cmath>

#include "tests/integrators/fabric_sheets.h"
#include "tests/support.h"
#include "weft/fabric.h"
#include "weft/forces/collapse.h"
#include "weft/world/measures.h"

namespace weft::engine {
namespace {

using test::on_grid;
using test::on_mesh;
using test::square;

/// The smallest area of a triangle over its rest area.
double least_area(const ClothModel& model, const ClothState& state) {
  double least = 9;
  const RestMesh& mesh = model.topology->mesh;
  for (int t = 0; t < mesh.num_triangles(); ++t) {
    const auto& [a, b, c] = mesh.triangles[t];
    const auto [wide, narrow] = principal_stretches(
        make_rest_triangle(mesh, t), {state.position(a), state.position(b), state.position(c)});
    least = std::min(least, wide * narrow);
  }
  return least;
}

double energy(const ClothModel& model, const ClothState& state) {
  return compute_kinetic_energy(model, state) + compute_elastic_energy(model, state);
}

/// A collapsed shape: the image of the point (x, 0, z) of a sheet.
struct Crush {
  const char* name;
  Vec3 x, z;  // per metre along x, along z
};

const Crush kCrushes[] = {
    {"threads parallel", {1, 0, 0}, {0.98, 0.02, 0.01}},
    {"warp without length", {1e-3, 0, 0}, {0, 0, 1}},
    {"both short", {0.1, 0, 0}, {0, 0, 0.02}},
    {"on a line", {0.7, 0, 0}, {-0.9, 0, 0}},
    {"in a point", {0, 0, 0}, {0, 0, 0}},
};

ClothState crushed(const ClothModel& model, const Crush& crush) {
  std::vector<Vec3> places;
  for (const Vec3& p : model.topology->mesh.positions) places.push_back(p.x() * crush.x + p.z() * crush.z);
  return make_state(places);
}

std::vector<std::pair<std::string, std::shared_ptr<const ClothModel>>> sheets(int cells, double size) {
  const Fabric silk = find_fabric("silk");
  const auto springs =
      build_cloth_model(build_grid_topology(square(cells, size), SpringModel::simplified),
                        {.density = 0.2, .structural = 2000, .shear = 500, .bend = 1, .damping = 0.002});
  return {{"silk, grid", on_grid(square(cells, size), silk)},
          {"silk, mesh", on_mesh(square(cells, size), silk)},
          {"springs, grid", springs},
          {"springs, mesh", build_cloth_model(test::mesh_of(square(cells, size)),
                                              {.density = 0.2, .structural = 2000, .bend = 1})}};
}

Environment nothing() {
  Environment environment;
  environment.gravity = Vec3::Zero();
  return environment;
}

/// Within half a second, at 60 steps per second. BDF2 carries the opening on as a velocity: energy may rise
/// from one step to the next by its previous loss, but never above that of the crushed cloth.
void expect_opens(const IntegratorSettings& settings, int cells, double size) {
  for (const auto& [sheet, model] : sheets(cells, size)) {
    for (const Crush& crush : kCrushes) {
      SCOPED_TRACE(settings.integrator + ", " + sheet + ", " + crush.name);
      ClothState state = crushed(*model, crush);
      const auto integrator = make_integrator(settings);
      const double start = energy(*model, state);
      for (int frame = 0; frame < 30; ++frame) {
        test::advance(*integrator, *model, nothing(), 1.0 / 60, 1, state);
        EXPECT_LT(energy(*model, state), start) << frame;
      }
      EXPECT_LT(energy(*model, state), 0.01 * start);
      EXPECT_GT(least_area(*model, state), 0.5);
    }
  }
}

TEST(Collapse, CellsOpenAgainWithoutGainOfEnergy) { expect_opens({.integrator = "newton"}, 1, 0.02); }

TEST(Collapse, SheetsOpenAgainWithoutGainOfEnergy) { expect_opens({.integrator = "newton"}, 6, 0.1); }

TEST(Collapse, CellsOpenAgainWithImplicitEuler) {
  for (const bool is_double : {false, true})
    expect_opens({.integrator = "implicit_euler", .is_double = is_double}, 1, 0.02);
  expect_opens({.integrator = "newton", .is_double = true}, 1, 0.02);
}

/// `newton` and `implicit_euler` have the same term: with small steps both open a cell along one path.
TEST(Collapse, OpensTheSameWithNewtonAndImplicitEuler) {
  for (const auto& [sheet, model] : sheets(1, 0.02)) {
    SCOPED_TRACE(sheet);
    const Crush crush = {"sheared by 75 degrees", {1, 0, 0}, {0.966, 0, 0.259}};
    ClothState of_newton = crushed(*model, crush), of_euler = of_newton;
    const auto newton = make_integrator({.integrator = "newton", .newton = {.iterations = 100}});
    const auto euler =
        make_integrator({.integrator = "implicit_euler", .implicit_euler = {.tolerance = 1e-6}});
    test::advance(*newton, *model, nothing(), 1e-6, 100, of_newton);
    test::advance(*euler, *model, nothing(), 1e-6, 100, of_euler);
    const double moved = test::rms_distance(of_newton, crushed(*model, crush));
    EXPECT_GT(moved, 1e-5);
    EXPECT_LT(test::rms_distance(of_newton, of_euler), 0.03 * moved);
  }
}

}  // namespace
}  // namespace weft::engine
