/// Membrane and bending elements in implicit_euler.

#include <gtest/gtest.h>

#include "tests/forces/sheets.h"
#include "tests/support.h"
#include "weft/fabric.h"
#include "weft/forces/terms.h"

namespace weft::engine {
namespace {

using test::SheetKind;

std::shared_ptr<const ClothModel> sheet_of(const Fabric& fabric, SheetKind kind, BendingModel bending) {
  const auto topology = build_mesh_topology(make_sheet(kind, 8));
  const TriangleMesh& mesh = topology->mesh;
  return build_cloth_model(
      topology, {.density = fabric.density, .structural = 0, .shear = 0, .bend = 0},
      build_mesh_elements(mesh, warp_from_direction(mesh, Vec3::UnitX()), fabric, bending));
}

const BendingModel kBendings[] = {BendingModel::stencils, BendingModel::hinges};
constexpr double kStep = 0.01;

TEST(Elements, FallFreelyAndStayFlat) {
  for (const BendingModel bending : kBendings) {
    const auto model = sheet_of(find_fabric("cotton_shirting"), SheetKind::random, bending);
    ClothState state = make_state(model->topology->mesh.positions);
    const auto integrator = make_implicit_euler({.tolerance = 1e-6});
    test::advance(*integrator, *model, {}, kStep, 20, state);
    for (int i = 0; i < model->num_particles(); ++i) {
      EXPECT_NEAR(state.v.get(i).y(), -20 * 9.81 * kStep, 1e-5) << "the solver's tolerance and floats";
      EXPECT_NEAR(state.position(i).y(), -9.81 * kStep * kStep * 20 * 21 / 2, 1e-6);
    }
  }
}

Vec3 momentum(const ClothModel& model, const ClothState& state) {
  Vec3 sum = Vec3::Zero();
  for (int i = 0; i < model.num_particles(); ++i) sum += model.mass[i] * state.v.get(i);
  return sum;
}

TEST(Elements, ShakenKeepTheirMomentumAndSettle) {
  for (const BendingModel bending : kBendings) {
    const auto model = sheet_of(find_fabric("silk"), SheetKind::random, bending);
    ClothState state = make_state(model->topology->mesh.positions);
    test::shake(state, 0.01, 1);
    const Vec3 before = momentum(*model, state);
    const auto jobs = make_serial_jobs();
    const auto integrator = make_implicit_euler({.tolerance = 1e-6, .iterations = 500});
    for (int step = 0; step < 10; ++step) {
      const Environment weightless{.gravity = Vec3::Zero()};
      EXPECT_TRUE(integrator->advance(*model, weightless, kStep, *jobs, state).converged);
    }
    // 0.07 kg at about 1 m/s; the tolerance of 1e-6 m/s in ten steps.
    EXPECT_LT((momentum(*model, state) - before).norm(), 1e-6);
  }
}

/// Kinetic energy [J] of a curled and spinning sheet after a second.
double spin_left(double damping, BendingModel bending) {
  Fabric fabric = find_fabric("cotton_shirting");
  fabric.damping = damping;
  const auto model = sheet_of(fabric, SheetKind::random, bending);
  ClothState state = make_state(test::rolled(model->topology->mesh, 0.5, 0.3));
  for (int i = 0; i < model->num_particles(); ++i) {
    state.v.set(i, Vec3(0.1, 0.2, 0.3).cross(state.position(i) - Vec3(0.5, 0.1, 0.5)));
  }
  const auto integrator = make_implicit_euler({.tolerance = 1e-6, .iterations = 200});
  test::advance(*integrator, *model, {.gravity = Vec3::Zero()}, kStep, 100, state);
  double energy = 0;
  for (int i = 0; i < model->num_particles(); ++i)
    energy += 0.5 * model->mass[i] * state.v.get(i).squaredNorm();
  return energy;
}

TEST(Elements, DampingDoesNotBrakeARotation) {
  for (const BendingModel bending : kBendings) {
    const double free = spin_left(0, bending), damped = spin_left(0.02, bending);
    EXPECT_GT(free, 1e-4) << "it spins";
    EXPECT_GT(damped, 0.9 * free) << "what unrolling and shaking lose, and not the rotation";
  }
}

TEST(Elements, DampingIsTheTimeConstantTimesTheElasticStress) {
  // In one step from strain e₀ to e the potential gains τ/(2h) C (e − e₀)²: τ/h times the elastic energy of
  // the difference. This holds for hinges and stencils, in stretching and in bending.
  constexpr double kTau = 0.03;
  Fabric fabric = find_fabric("cotton_shirting");
  for (const BendingModel bending : kBendings) {
    const auto energy = [&](double damping, const std::vector<Vec3>& from, const std::vector<Vec3>& to) {
      fabric.damping = damping;
      const auto model = sheet_of(fabric, SheetKind::parallel, bending);
      const ClothState flat = make_state(model->topology->mesh.positions);
      return sum_energies(make_elastic_terms(*model, flat), to) +
             sum_energies(make_damping_terms(*model, {from, from, kStep}), to);
    };
    const TriangleMesh mesh = make_sheet(SheetKind::parallel, 8);
    const auto stretched =
        test::mapped(mesh, [](const Vec3& p) { return Vec3(1.0001 * p.x(), 0, 0.9999 * p.z()); });
    const double stretching = energy(0, mesh.positions, stretched);
    EXPECT_NEAR(energy(kTau, mesh.positions, stretched) / stretching, 1 + kTau / kStep, 1e-3)
        << "the strain's second order is 1e-4 of it";
    // Curvature 0.2/m, then 0.3/m: the difference of 0.1/m has a ninth of the energy at 0.3/m. The membrane
    // is soft: its resistance to chords shorter than their arcs is negligible.
    fabric.c11 = fabric.c22 = 1e-6;
    fabric.g = 1e-6;
    const auto some = test::rolled(mesh, 0.2, 0), more = test::rolled(mesh, 0.3, 0);
    const double elastic = energy(0, some, more), viscous = energy(kTau, some, more) - elastic;
    EXPECT_NEAR(viscous / (elastic / 9), kTau / kStep, 0.05) << "directions turn by a few hundredths";
    fabric = find_fabric("cotton_shirting");
  }
}

}  // namespace
}  // namespace weft::engine
