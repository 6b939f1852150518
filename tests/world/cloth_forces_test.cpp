/// Forces of springs and elements in doubles, against an integrator's forces and against energies.

#include "weft/world/cloth_forces.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/integrators/fabric_sheets.h"
#include "tests/support.h"
#include "weft/world/measures.h"

namespace weft::engine {
namespace {

constexpr int kCells = 6;

std::shared_ptr<const ClothModel> springs(DampingKind kind) {
  return build_cloth_model(
      build_grid_topology(test::square(kCells), SpringModel::basic),
      {.structural = 200, .shear = 100, .bend = 20, .damping = 0.05, .damping_kind = kind});
}

const Fabric kThick{
    .c12 = 300, .bend_warp = 0.01, .bend_weft = 0.008, .bend_bias = 0.008, .strain_limit = 0.02};
/// As stiff in bending as in stretching.
const Fabric kPlate{.c11 = 1, .c22 = 1, .g = 1, .bend_warp = 0.05, .bend_weft = 0.05, .bend_bias = 0.05};

std::shared_ptr<const ClothModel> hinges() {
  const auto topology = build_grid_topology(test::square(kCells), SpringModel::alternating);
  return build_cloth_model(topology, {.structural = 0, .shear = 0, .bend = 0},
                           build_grid_elements(test::square(kCells), topology->mesh, GridWarp::first_axis,
                                               kPlate, BendingModel::hinges));
}

struct Case {
  const char* name;
  std::shared_ptr<const ClothModel> model;
};

std::vector<Case> cases() {
  return {{"springs, projected damping", springs(DampingKind::projected)},
          {"springs, plain damping", springs(DampingKind::plain)},
          {"stencils on a grid", test::on_grid(test::square(kCells), kThick)},
          {"stencils on a mesh", test::on_mesh(test::square(kCells), kThick)},
          {"stencils of a plate", test::on_grid(test::square(kCells), kPlate)},
          {"hinges of a plate", hinges()},
          {"springs for a fabric, with a limit", test::springs_on(test::square(kCells), 0.02)}};
}

ClothState shaken(const ClothModel& model) {
  ClothState state = make_state(model.topology->mesh.positions);
  test::shake(state, 0.02, 0.5);
  return state;
}

TEST(ClothForces, AreThoseThatImplicitEulerMovesClothWith) {
  // After its step m (v − v₀)/h is the total force. Its damping is that of the start shape, which has hardly
  // changed in 10 µs.
  constexpr double kStep = 1e-5;
  for (const auto& [name, model] : cases()) {
    const ClothState before = shaken(*model);
    ClothState after = before;
    const auto integrator = make_implicit_euler_in_double({.tolerance = 1e-9});
    test::advance(*integrator, *model, {}, kStep, 1, after);
    const std::vector<Vec3> elastic = compute_elastic_forces(*model, after),
                            damping = compute_damping_forces(*model, after);
    double largest = 0, worst = 0, largest_damping = 0;
    for (int i = 0; i < model->num_particles(); ++i) {
      const double m = model->mass[i];
      const Vec3 inertia = m / kStep * (after.precise.v[i] - before.v.get(i));
      largest = std::max(largest, inertia.norm());
      largest_damping = std::max(largest_damping, damping[i].norm());
      worst = std::max(worst, (inertia - m * Environment().gravity - elastic[i] - damping[i]).norm());
    }
    EXPECT_LT(worst, 5e-4 * largest) << name << ": positions and velocities are floats";
    EXPECT_GT(largest_damping, 1e-3 * largest) << name << ": it must show if damping were missing";
  }
}

TEST(ClothForces, AreMinusTheGradientOfTheElasticEnergy) {
  for (const auto& [name, model] : cases()) {
    ClothState state = shaken(*model);
    const std::vector<Vec3> force = compute_elastic_forces(*model, state);
    Random random(3);
    std::vector<Vec3> direction;
    double slope = 0;
    for (const Vec3& f : force) {
      direction.push_back(test::random_vector(random, 1) + f / force[0].norm());
      slope -= f.dot(direction.back());
    }
    const auto energy_at = [&](double share) {
      ClothState moved = state;
      for (std::size_t i = 0; i < force.size(); ++i) moved.x.set(i, state.x.get(i) + share * direction[i]);
      return compute_elastic_energy(*model, moved);
    };
    constexpr double kShare = 1e-4;
    const double measured = (energy_at(kShare) - energy_at(-kShare)) / (2 * kShare);
    EXPECT_NEAR(measured, slope, 2e-3 * std::abs(slope)) << name << ": positions are floats";
  }
}

TEST(ClothForces, OfDampingOnlyTakeEnergyAndLeaveARigidRotationAlone) {
  for (const auto& [name, model] : cases()) {
    ClothState state = shaken(*model);
    double power = 0;
    Vec3 sum = Vec3::Zero();
    for (int i = 0; const Vec3& f : compute_damping_forces(*model, state)) {
      power += f.dot(state.v.get(i++));
      sum += f;
    }
    EXPECT_LT(power, -1e-3) << name;
    EXPECT_LT(sum.norm(), 1e-9) << name;
    if (name == std::string("springs, plain damping")) continue;  // damps rotations too
    for (std::size_t i = 0; i < state.x.size(); ++i) state.v.set(i, Vec3(0.3, 1, -0.2).cross(state.x.get(i)));
    for (const Vec3& f : compute_damping_forces(*model, state)) EXPECT_LT(f.norm(), 1e-5) << name;
  }
}

TEST(Measures, SplitTheElasticEnergyInTwo) {
  for (const auto& [name, model] : cases()) {
    const ElasticParts parts = compute_elastic_parts(*model, shaken(*model));
    const double sum = compute_elastic_energy(*model, shaken(*model));
    EXPECT_NEAR(parts.stretch + parts.bending, sum, 1e-12 * sum) << name;
    EXPECT_GT(parts.stretch, 0) << name;
    EXPECT_GT(parts.bending, 0) << name;
  }
}

TEST(Measures, CallACylinderBentAndNotStretched) {
  const auto model =
      test::on_grid(test::square(20), {.bend_warp = 0.01, .bend_weft = 0.01, .bend_bias = 0.01});
  ClothState state = make_state(model->topology->mesh.positions);
  for (int i = 0; i < model->num_particles(); ++i) {
    const Vec3 p = model->topology->mesh.positions[i];
    state.set_position(i, {std::sin(p.x()), std::cos(p.x()), p.z()});
  }
  const ElasticParts parts = compute_elastic_parts(*model, state);
  // ½ D κ² over a square metre; at the free ends stencils are fewer.
  EXPECT_NEAR(parts.bending, 0.5 * 0.01, 0.1 * 0.5 * 0.01);
  EXPECT_LT(parts.stretch, 0.05 * parts.bending) << "chords are shorter than arcs by h²/24";
}

}  // namespace
}  // namespace weft::engine
