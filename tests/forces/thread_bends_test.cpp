/// Bending with memory: the law of one thread, and the curvatures of threads on sheets.

#include "weft/forces/thread_bends.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/forces/sheets.h"
#include "weft/fabric.h"
#include "weft/model/cloth_model.h"

namespace weft::engine {
namespace {

using test::SheetKind;

constexpr double kPi = 3.141592653589793;
constexpr double kFriction = 6e-4, kRigidity = 2e-5;  // of warp threads: H [N], D [N·m]

Fabric fabric_with(double hysteresis_warp, double hysteresis_weft, double set) {
  Fabric fabric;
  fabric.bend_warp = fabric.bend_weft = fabric.bend_bias = kRigidity;
  fabric.bend_hysteresis_warp = hysteresis_warp;
  fabric.bend_hysteresis_weft = hysteresis_weft;
  fabric.bend_set = set;
  return fabric;
}

/// A single row that stands for a square metre.
struct Thread {
  ThreadBends rows;
  ThreadBendStep step;

  explicit Thread(double set) {
    rows.friction = {kFriction};
    rows.stiffness = {kRigidity};
    rows.center = {0};
    rows.set = set;
    step = {.rows = &rows, .normal = {Vec3::UnitY()}, .slip = {0}, .set = {0}};
  }

  /// As the memory follows between two steps.
  void follow(double curvature) {
    step.slip[0] = std::clamp(step.slip[0], curvature - kSlipCurvature, curvature + kSlipCurvature);
    if (rows.set > 0) step.set[0] = std::clamp(step.set[0], curvature - rows.set, curvature + rows.set);
  }

  /// With elastic bending [N].
  double moment(double curvature) const {
    return kRigidity * curvature + thread_bend_response(step, 0, curvature).moment;
  }
};

TEST(ThreadBends, MomentIsTheDerivativeOfTheEnergyAndTheStiffnessBoundsItsOwn) {
  Thread thread(200);
  thread.step.slip[0] = 30;
  thread.step.set[0] = -20;
  for (double curvature = -100; curvature < 150; curvature += 3.7) {
    constexpr double kDelta = 1e-4;
    const ThreadBendResponse at = thread_bend_response(thread.step, 0, curvature);
    const ThreadBendResponse low = thread_bend_response(thread.step, 0, curvature - kDelta),
                             high = thread_bend_response(thread.step, 0, curvature + kDelta);
    EXPECT_NEAR((high.energy - low.energy) / (2 * kDelta), at.moment, 1e-4 * kFriction);
    EXPECT_NEAR((high.moment - low.moment) / (2 * kDelta), at.tangent, 1e-4 * kFriction);
    EXPECT_GE(at.stiffness, at.tangent);
    // A majoriser: the parabola with this stiffness is nowhere below the energy.
    for (double other = -100; other < 150; other += 11.3) {
      const double by = other - curvature;
      EXPECT_GE(at.energy + at.moment * by + 0.5 * at.stiffness * by * by,
                thread_bend_response(thread.step, 0, other).energy - 1e-15);
    }
  }
}

TEST(ThreadBends, ABendingTesterReadsTheGivenHysteresis) {
  Thread thread(0);
  double forth = 0, back = 0;
  for (double c = 0; c < 250; ++c) thread.follow(c);
  for (double c = 250; c > -250; --c) {
    thread.follow(c);
    if (c == 100) back = thread.moment(c);
  }
  for (double c = -250; c <= 100; ++c) thread.follow(c);
  forth = thread.moment(100);
  EXPECT_NEAR(forth - back, 2 * kFriction, 1e-12);
  EXPECT_NEAR(forth + back, 2 * kRigidity * 100, 1e-12);
}

TEST(ThreadBends, ACreaseLimitsTheElasticMoment) {
  Thread thread(50);
  for (double c = 0; c <= 300; ++c) thread.follow(c);
  EXPECT_NEAR(thread.moment(300), kRigidity * 50 + kFriction, 1e-12);
  EXPECT_NEAR(thread.step.set[0], 250, 1e-12);
}

/// A closed loop of bending costs 2HB times its length, and no step gains energy.
TEST(ThreadBends, LosesTheAreaOfTheLoop) {
  Thread thread(0);
  const auto energy = [&](double c) {
    return 0.5 * kRigidity * c * c + thread_bend_response(thread.step, 0, c).energy;
  };
  double work = 0, last = 0;
  const auto bend = [&](double from, double to) {
    for (int s = 1; s <= 1000; ++s) {
      const double c = from + (to - from) * s / 1000, before = thread.moment(last), stored = energy(last);
      const double done = 0.5 * (before + thread.moment(c)) * (c - last);
      thread.follow(c);
      EXPECT_LE(energy(c) - stored, done + 1e-9);
      work += done;
      last = c;
    }
  };
  bend(0, 200);
  work = 0;
  bend(200, -200);
  bend(-200, 200);
  const double ends = 2 * 2 * kFriction * kSlipCurvature;  // the corners that sticking cuts off
  EXPECT_NEAR(work, 2 * kFriction * 400 - ends, 0.002 * work);
}

/// Rolled to a cylinder in any direction, the rows have the curvature of each family of threads, and all together slip
/// at the moment H_warp cos² + H_weft sin².
TEST(ThreadBends, RowsOfARolledSheetAddUpToItsFriction) {
  constexpr int kCells = 24;
  constexpr double kCurvature = 0.2;  // of a square of 1 m
  const Fabric fabric = fabric_with(2 * kFriction, 4 * kFriction, 0);
  for (const SheetKind kind : {SheetKind::parallel, SheetKind::alternating, SheetKind::random}) {
    const TriangleMesh mesh = make_sheet(kind, kCells);
    const ThreadBends rows = build_mesh_thread_bends(mesh, warp_from_direction(mesh, Vec3::UnitX()), fabric);
    for (const double degrees : {0.0, 30.0, 45.0, 90.0, 120.0}) {
      const double psi = degrees * kPi / 180, c = std::cos(psi), s = std::sin(psi);
      ClothState state = make_state(test::rolled(mesh, kCurvature, psi));
      const ThreadBendStep step = begin_thread_bends(rows, mesh, state);
      double power = 0;
      for (int r = 0; r < rows.num_rows(); ++r)
        power += rows.friction[r] * thread_curvature(step, r, [&](int v) { return state.x.get(v); });
      // Next to the border, half a cell bends along it only.
      const double expected = (1 - 1.0 / kCells) * kFriction * (c * c + 2 * s * s);
      EXPECT_NEAR(std::abs(power) / kCurvature, expected, 0.03 * expected)
          << to_string(kind) << ' ' << degrees;
    }
  }
}

TEST(ThreadBends, AFabricWithoutHysteresisHasNoRows) {
  const TriangleMesh mesh = make_sheet(SheetKind::random, 6);
  const Fabric fabric;
  EXPECT_TRUE(build_mesh_thread_bends(mesh, warp_from_direction(mesh, Vec3::UnitX()), fabric).empty());
  EXPECT_TRUE(build_grid_thread_bends({.size_x = 1, .size_z = 1, .cells_x = 4, .cells_z = 4},
                                      GridWarp::first_axis, fabric)
                  .empty());
}

/// A ribbon of one cell has no inner vertex: its threads bend at the edges between its triangles.
TEST(ThreadBends, ARibbonOfOneCellHasFriction) {
  const Grid grid{.size_x = 1, .size_z = 0.02, .cells_x = 50, .cells_z = 1};
  const TriangleMesh mesh = build_grid_mesh(grid, GridDiagonals::alternating);
  const Fabric fabric = fabric_with(2 * kFriction, 2 * kFriction, 0);
  const ThreadBends rows = build_mesh_thread_bends(mesh, warp_from_direction(mesh, Vec3::UnitX()), fabric);
  ClothState state = make_state(test::rolled(mesh, 1, 0));
  const ThreadBendStep step = begin_thread_bends(rows, mesh, state);
  double power = 0;
  for (int r = 0; r < rows.num_rows(); ++r)
    power += rows.friction[r] * thread_curvature(step, r, [&](int v) { return state.x.get(v); });
  EXPECT_NEAR(std::abs(power), kFriction * 0.02, 0.03 * kFriction * 0.02);
}

}  // namespace
}  // namespace weft::engine
