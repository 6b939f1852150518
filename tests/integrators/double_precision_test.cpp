/// Integrators in double precision: less rounding, and the same guarantees.

#include <gtest/gtest.h>

#include "tests/support.h"
#include "weft/core/hash.h"
#include "weft/error.h"

namespace weft::engine {
namespace {

using test::Hung;
using test::rms_distance;
using test::square;

std::unique_ptr<Integrator> in_double(const char* name, double tolerance = 1e-9) {
  return make_integrator({.integrator = name, .implicit_euler = {.tolerance = tolerance}, .is_double = true});
}

/// Position in the stored precision [m].
Vec3 position_of(const ClothState& state, int particle) {
  return state.origin + most_precise(state.precise.x, state.x, particle);
}

TEST(DoublePrecision, FallsFreelyToTheLastDigits) {
  const auto topology = build_grid_topology(square(2), SpringModel::simplified);
  const double step = 1e-5;
  constexpr int kSteps = 20000;
  for (const char* name : {"newton", "implicit_euler"}) {
    Hung sheet(topology, 2);
    sheet.environment.pins = {};
    const auto integrator = in_double(name);
    const double start = sheet.state.position(4).y();
    for (int s = 0; s < kSteps; ++s) {
      test::advance(*integrator, *sheet.model, sheet.environment, step, 1, sheet.state);
      follow_cloth(sheet.state);
    }
    const double time = kSteps * step;
    const double late = std::string(name) == "newton" ? 0 : 0.5 * 9.81 * step * time;  // implicit Euler
    EXPECT_NEAR(position_of(sheet.state, 4).y(), start - 0.5 * 9.81 * time * time - late, 1e-9) << name;
  }
}

TEST(DoublePrecision, IsWhatNewtonInFloatsComesToWithEnoughIterations) {
  constexpr int kCells = 10;
  for (const auto& topology :
       {build_grid_topology(square(kCells), SpringModel::simplified), test::mesh_of(square(kCells))}) {
    for (const DampingKind kind : {DampingKind::projected, DampingKind::plain}) {
      const ClothMaterial material{.damping = 0.01, .damping_kind = kind};
      Hung exact(topology, kCells, material), fast(topology, kCells, material);
      const auto converged = make_newton({.iterations = 400, .quality = NewtonQuality::high});
      const auto reference = in_double("newton");
      exact.advance_frame(*reference, 4);
      fast.advance_frame(*converged, 4);
      EXPECT_LT(rms_distance(exact.state, fast.state), 1e-5);
      for (int frame = 0; frame < 10; ++frame) {
        exact.advance_frame(*reference, 4);
        fast.advance_frame(*converged, 4);
      }
      EXPECT_LT(rms_distance(exact.state, fast.state), 3e-4);
    }
  }
}

/// Position of a soft strip's free corner after a tenth of a second in n steps.
Vec3 swing(const char* name, int steps) {
  Hung sheet(build_grid_topology(square(3), SpringModel::alternating), 3,
             {.structural = 20, .shear = 10, .bend = 1, .damping = 0.01});
  const auto integrator = in_double(name);
  test::advance(*integrator, *sheet.model, sheet.environment, 0.1 / steps, steps, sheet.state);
  return position_of(sheet.state, 15);
}

TEST(DoublePrecision, ShowsTheOrderFarBelowTheRoundingOfFloats) {
  for (const auto& [name, gain] : {std::pair{"newton", 4.0}, std::pair{"implicit_euler", 2.0}}) {
    const Vec3 a = swing(name, 500), b = swing(name, 1000), c = swing(name, 2000);
    const double coarse = (a - b).norm(), fine = (b - c).norm();
    EXPECT_NEAR(coarse / fine, gain, 0.1 * gain) << name;
    EXPECT_LT(fine, gain == 4 ? 1e-7 : 1e-3) << name;
  }
}

TEST(DoublePrecision, TakesWhatIsMovedFromOutside) {
  Hung sheet(build_grid_topology(square(3), SpringModel::simplified), 3);
  const auto integrator = in_double("newton");
  sheet.advance_frame(*integrator, 1);
  ASSERT_FALSE(sheet.state.precise.x.empty());
  const Vec3 precise = most_precise(sheet.state.precise.x, sheet.state.x, 15);
  EXPECT_NE(precise, sheet.state.x.get(15));
  EXPECT_LT((precise - sheet.state.x.get(15)).norm(), 1e-6);
  sheet.state.x.set(15, {1, 2, 3});
  EXPECT_EQ(most_precise(sheet.state.precise.x, sheet.state.x, 15), Vec3(1, 2, 3));
}

TEST(DoublePrecision, IsPartOfSnapshots) {
  World world;
  world.set_integrator({.is_double = true});
  const auto topology = build_grid_topology(square(4), SpringModel::simplified);
  const ClothId cloth = world.add_cloth({.topology = topology});
  world.set_pins(cloth, {{.particles = {0, 4}}});
  for (int s = 0; s < 3; ++s) world.step(1.0 / 60);
  const auto snapshot = world.snapshot();
  for (int s = 0; s < 5; ++s) world.step(1.0 / 60);
  const auto hash = world.state_hash();
  world.restore(snapshot);
  for (int s = 0; s < 5; ++s) world.step(1.0 / 60);
  EXPECT_EQ(world.state_hash(), hash);
}

TEST(DoublePrecision, IsRefusedWhereThereIsNone) {
  for (const IntegratorRow& row : integrator_rows()) {
    const IntegratorSettings settings{.integrator = std::string(row.name), .is_double = true};
    if (row.make_in_double) {
      EXPECT_NE(make_integrator(settings), nullptr);
    } else {
      EXPECT_THROW(make_integrator(settings), InputError) << row.name;
    }
  }
}

}  // namespace
}  // namespace weft::engine
