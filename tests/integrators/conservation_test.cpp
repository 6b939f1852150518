/// Momentum, energy, wind, damping.

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "tests/support.h"
#include "weft/world/measures.h"

namespace weft::engine {
namespace {

using test::square;

constexpr double kInfinity = std::numeric_limits<double>::infinity();

const Environment kNothing{.gravity = Vec3::Zero()};

double total_energy(const ClothModel& model, const ClothState& state) {
  return compute_kinetic_energy(model, state) + compute_elastic_energy(model, state);
}

class Momentum : public testing::TestWithParam<const char*> {};

TEST_P(Momentum, OfAFreeShakenSheetStaysTheSame) {
  for (const DampingKind kind : {DampingKind::plain, DampingKind::projected}) {
    const auto topology = build_grid_topology(square(12), SpringModel::simplified);
    const auto model = build_cloth_model(
        topology, {.structural = 100, .shear = 50, .bend = 2, .damping = 0.001, .damping_kind = kind});
    ClothState state = make_state(topology->mesh.positions);
    test::shake(state, 0.01, 1);
    const Vec3 before = compute_momentum(*model, state);
    const double h = 0.5 * explicit_step_limit(*model, {});
    test::advance(*test::integrator(GetParam()), *model, kNothing, h, 100, state);
    // Speeds of 1 m/s, rounded to floats a hundred times, over 0.2 kg.
    EXPECT_LT((compute_momentum(*model, state) - before).norm(), 0.2 * 100 * 6e-8);
  }
}

INSTANTIATE_TEST_SUITE_P(Integrators, Momentum,
                         testing::Values("explicit", "desbrun", "implicit_euler", "newton", "xpbd"));

TEST(Paper, DriftsInMomentumWhereBordersDiffer) {
  const auto topology = build_grid_topology(square(12), SpringModel::simplified);
  const auto model = build_cloth_model(topology, {.structural = 2000, .shear = 1000, .bend = 20});
  for (const char* name : {"paper", "paper_fixed"}) {
    ClothState state = make_state(topology->mesh.positions);
    test::shake(state, 0.01, 1);
    const Vec3 before = compute_momentum(*model, state);
    test::advance(*test::integrator(name), *model, kNothing, 1.0 / 600, 20, state);
    EXPECT_GT((compute_momentum(*model, state) - before).norm(), 1e-4) << name << ": a finding, not a wish";
  }
}

TEST(ImplicitEuler, NeverGainsEnergyUndriven) {
  const auto topology = build_grid_topology(square(10), SpringModel::basic);
  const auto model = build_cloth_model(topology, {.structural = 200, .shear = 100, .bend = 2});
  // Stretched evenly by a fifth: the springs stay at or beyond rest length during the first contraction.
  std::vector<Vec3> positions;
  for (const Vec3& p : topology->mesh.positions) positions.push_back(1.2 * p);
  ClothState state = make_state(positions);
  const auto integrator = make_implicit_euler({.tolerance = 1e-10});
  double energy = total_energy(*model, state);
  for (int s = 0; s < 100; ++s) {
    test::advance(*integrator, *model, kNothing, 1e-3, 1, state);
    const double now = total_energy(*model, state);
    // Once springs are compressed, the bound for the true Jacobian applies: ½ µ h² |v'|², far below this
    // share.
    EXPECT_LT(now, energy * (1 + 1e-4)) << s;
    energy = now;
  }
}

TEST(Explicit, KeepsTheEnergyOfAnUndampedSwingWithinBounds) {
  const auto topology = build_grid_topology(square(10), SpringModel::basic);
  const auto model = build_cloth_model(topology, {.structural = 200, .shear = 100, .bend = 2});
  std::vector<Vec3> positions;
  for (const Vec3& p : topology->mesh.positions) positions.push_back(1.1 * p);
  ClothState state = make_state(positions);
  const double energy = total_energy(*model, state);
  const auto integrator = test::integrator("explicit");
  for (int s = 0; s < 2000; ++s) {
    test::advance(*integrator, *model, kNothing, 0.1 * explicit_step_limit(*model, {}), 1, state);
    EXPECT_NEAR(total_energy(*model, state), energy, 0.05 * energy) << s;
  }
}

TEST(Desbrun, IsStableAtAHundredTimesTheLargestStepOfExplicit) {
  const auto topology = build_grid_topology(square(16), SpringModel::simplified);
  const auto model = build_cloth_model(topology, {.damping = 1e-4});
  const double limit = explicit_step_limit(*model, {});
  Environment environment;
  environment.pins = {{0, 16}, {topology->mesh.positions[0], topology->mesh.positions[16]}};
  const auto highest_speed = [&](const char* name, double step, int steps) {
    ClothState state = make_state(topology->mesh.positions);
    test::shake(state, 0.001, 0.1);
    test::advance(*test::integrator(name), *model, environment, step, steps, state);
    double highest = 0;
    for (int i = 0; i < model->num_particles(); ++i) {
      const double speed = state.v.get(i).norm();
      highest = std::isfinite(speed) ? std::max(highest, speed) : kInfinity;
    }
    return highest;
  };
  EXPECT_LT(highest_speed("desbrun", 100 * limit, 500), 20);
  EXPECT_LT(highest_speed("explicit", 0.9 * limit, 500), 20) << "the limit is safe";
  EXPECT_EQ(highest_speed("explicit", 1.5 * limit, 500), kInfinity) << "and not needlessly small";
}

TEST(Wind, TakesAFallingSheetToItsTerminalVelocityOnEveryMesh) {
  const Wind wind{.velocity = {2, 0, 1}, .drag = 0.5};
  const Vec3 expected = wind.velocity + Vec3(0, -9.81, 0) * 0.2 / wind.drag;
  for (const std::string_view name :
       {"explicit", "paper_fixed", "desbrun", "implicit_euler", "newton", "xpbd"}) {
    for (const auto& topology :
         {build_grid_topology(square(4), SpringModel::simplified),
          build_grid_topology(square(11), SpringModel::simplified), test::mesh_of(square(6))}) {
      const auto model =
          build_cloth_model(topology, {.density = 0.2, .structural = 10, .shear = 5, .bend = 0.1});
      ClothState state = make_state(topology->mesh.positions);
      const double h = std::min(0.004, 0.5 * explicit_step_limit(*model, wind));
      test::advance(*test::integrator(name), *model, {.wind = wind}, h, static_cast<int>(6 / h), state);
      for (int i = 0; i < model->num_particles(); ++i) {
        EXPECT_LT((state.v.get(i) - expected).norm(), 1e-3 * expected.norm()) << name << ", particle " << i;
      }
    }
  }
}

TEST(Paper, DampingAsPrintedFeedsTheMotion) {
  const auto topology = build_grid_topology(square(10), SpringModel::simplified);
  const auto model = build_cloth_model(
      topology,
      {.structural = 10, .shear = 5, .bend = 0.1, .damping = 0.01, .damping_kind = DampingKind::plain});
  const auto energy_after = [&](bool printed) {
    ClothState state = make_state(topology->mesh.positions);
    test::shake(state, 0, 0.1);
    const auto integrator = make_paper({.printed_damping_sign = printed});
    test::advance(*integrator, *model, kNothing, 1e-3, 50, state);
    return total_energy(*model, state);
  };
  ClothState start = make_state(topology->mesh.positions);
  test::shake(start, 0, 0.1);
  EXPECT_LT(energy_after(false), total_energy(*model, start));
  EXPECT_GT(energy_after(true), 2 * total_energy(*model, start));
}

TEST(Damping, ProjectedLetsASheetSpinAndPlainBrakesIt) {
  const auto topology = build_grid_topology(square(6), SpringModel::basic);
  const auto spin_after = [&](DampingKind kind) {
    const auto model = build_cloth_model(
        topology, {.structural = 500, .shear = 250, .bend = 5, .damping = 0.01, .damping_kind = kind});
    ClothState state = make_state(topology->mesh.positions);
    const Vec3 center = compute_center_of_mass(*model, state), omega(0, 2, 0);
    for (int i = 0; i < model->num_particles(); ++i) state.v.set(i, omega.cross(state.position(i) - center));
    const double before = compute_angular_momentum(*model, state, center).y();
    test::advance(*test::integrator("explicit"), *model, kNothing, 2e-4, 2500, state);
    return compute_angular_momentum(*model, state, center).y() / before;
  };
  EXPECT_NEAR(spin_after(DampingKind::projected), 1, 1e-3);
  EXPECT_LT(spin_after(DampingKind::plain), 0.9);
}

/// Positions after 0.2 s of a soft pinned sheet.
std::vector<Vec3> swing(std::string_view name, int steps) {
  const auto topology = build_grid_topology(square(8), SpringModel::simplified);
  const auto model = build_cloth_model(topology, {.structural = 20, .shear = 10, .bend = 0.5});
  ClothState state = make_state(topology->mesh.positions);
  Environment environment;
  environment.pins = {{0, 8}, {state.position(0), state.position(8)}};
  const IntegratorSettings settings{.integrator = std::string(name), .implicit_euler = {.tolerance = 1e-9}};
  test::advance(*make_integrator(settings), *model, environment, 0.2 / steps, steps, state);
  return positions_of(state);
}

double distance(const std::vector<Vec3>& a, const std::vector<Vec3>& b) {
  double sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += (a[i] - b[i]).squaredNorm();
  return std::sqrt(sum / static_cast<double>(a.size()));
}

TEST(Integrators, AgreeAsTheStepGoesToZero) {
  const std::vector<Vec3> reference = swing("explicit", 12800);
  for (const char* name : {"explicit", "paper_fixed", "desbrun", "implicit_euler", "newton", "xpbd"}) {
    // First order divides the error by 4; the constant Jacobian's numerical damping converges late.
    const double coarse = distance(swing(name, 800), reference),
                 fine = distance(swing(name, 3200), reference);
    EXPECT_LT(fine, 0.001) << name;
    constexpr double kErrorOfReference = 5e-5;  // twice the error of explicit at 3200 steps [m]
    EXPECT_TRUE(coarse / fine > 2.5 || coarse < kErrorOfReference) << name;
  }
}

}  // namespace
}  // namespace weft::engine
