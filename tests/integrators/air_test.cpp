/// Drag, lift and gusts: the analytic terminal velocity, no force edge-on, no energy from still air, and
/// stability with light cloth at 60 steps per second.

#include <gtest/gtest.h>

#include <cmath>

#include "tests/forces/sheets.h"
#include "tests/support.h"
#include "weft/fabric.h"
#include "weft/world/measures.h"

namespace weft::engine {
namespace {

constexpr int kCells = 8;
constexpr const char* kIntegrators[] = {"newton", "implicit_euler"};

/// Silk with another density, or a board.
std::shared_ptr<const ClothModel> sheet_of(double density, bool is_board = false) {
  Fabric fabric = find_fabric("silk");
  fabric.density = density;
  if (is_board) fabric.bend_warp = fabric.bend_weft = fabric.bend_bias = 0.01;
  const Grid grid = test::square(kCells);
  const auto topology = build_grid_topology(grid, SpringModel::alternating);
  return build_cloth_model(topology, {.density = density, .structural = 0, .shear = 0, .bend = 0},
                           build_grid_elements(grid, topology->mesh, GridWarp::first_axis, fabric));
}

std::unique_ptr<Integrator> make(const char* name) { return make_integrator({.integrator = name}); }

const Wind kStill = {.air = {.density = 1.2, .drag = 1.1, .lift = 0.5}};

Vec3 mean_velocity(const ClothModel& model, const ClothState& state) {
  return compute_momentum(model, state) / (model.material.density * 1.0);
}

TEST(AirForce, IsTheTextbooksDragAndLift) {
  const Air air{.density = 1.2, .drag = 1.1, .lift = 0.5};
  const auto force = [&](const Vec3& n, const Vec3& u) { return Vec3(air_matrix(air, 2 * n, u) * u); };
  EXPECT_LT((force(Vec3::UnitY(), {0, 3, 0}) - Vec3(0, 0.5 * 1.2 * 1.1 * 2 * 9, 0)).norm(), 1e-12)
      << "face-on";
  EXPECT_EQ(force(Vec3::UnitY(), {3, 0, 0}).norm(), 0) << "edge-on";
  EXPECT_EQ((force(Vec3::UnitY(), {1, 2, 0}) - force(-Vec3::UnitY(), {1, 2, 0})).norm(), 0) << "both sides";
  // At 45°: lift is perpendicular to the stream, up or down with the normal.
  const Vec3 u(2, 0, 0), slanted = Vec3(1, 1, 0).normalized(), f = force(slanted, u);
  EXPECT_NEAR(f.x(), 0.5 * 1.2 * 2 * 4 * 1.1 * std::sqrt(0.5), 1e-12);
  EXPECT_NEAR(f.y(), 0.5 * 1.2 * 2 * 4 * 0.5 * 0.5, 1e-12);
  EXPECT_NEAR(force(Vec3(1, -1, 0).normalized(), u).y(), -f.y(), 1e-12);
}

TEST(Air, GivesAFallingSheetTheTerminalVelocityOfTheFormula) {
  // ½ ρ C_D v² = (mass per area) g
  for (const char* name : kIntegrators) {
    for (const double density : {0.03, 0.2}) {
      const auto model = sheet_of(density, true);  // a soft one bulges, and falls faster
      ClothState state = make_state(model->topology->mesh.positions);
      test::advance(*make(name), *model, {.wind = kStill}, 1.0 / 60, 60, state);
      const double terminal = std::sqrt(density * 9.81 / (0.5 * 1.2 * 1.1));
      EXPECT_NEAR(mean_velocity(*model, state).y() / -terminal, 1, 0.01) << name << ", " << density;
      EXPECT_LT(std::abs(mean_velocity(*model, state).x()), 0.01 * terminal) << name;
    }
  }
}

TEST(Air, LeavesASheetThatMovesEdgeOnAlone) {
  for (const char* name : kIntegrators) {
    const auto model = sheet_of(0.05);
    ClothState state = make_state(model->topology->mesh.positions);
    for (std::size_t i = 0; i < state.v.size(); ++i) state.v.set(i, {5, 0, 0});
    test::advance(*make(name), *model, {.gravity = Vec3::Zero(), .wind = kStill}, 1.0 / 60, 60, state);
    EXPECT_NEAR(mean_velocity(*model, state).x(), 5, 1e-4) << name;
    EXPECT_LT(std::abs(mean_velocity(*model, state).y()), 1e-4) << name;
  }
}

double total_energy(const ClothModel& model, const ClothState& state) {
  return compute_kinetic_energy(model, state) + compute_elastic_energy(model, state);
}

TEST(Air, TakesEnergyFromTumblingClothWhenStillAndGivesNone) {
  for (const char* name : kIntegrators) {
    const auto model = sheet_of(0.02);
    ClothState state = make_state(model->topology->mesh.positions);
    for (std::size_t i = 0; i < state.v.size(); ++i) {
      const Vec3 arm = state.x.get(i) - Vec3(0.5, 0, 0.5);
      state.v.set(i, Vec3(3, -4, 1) + Vec3(0, 0, 8).cross(arm) + Vec3(5, 0, 0).cross(arm));
    }
    const auto integrator = make(name);
    const double start = total_energy(*model, state);
    double before = start;
    for (int step = 0; step < 60; ++step) {
      test::advance(*integrator, *model, {.gravity = Vec3::Zero(), .wind = kStill}, 1.0 / 60, 1, state);
      const double now = total_energy(*model, state);
      EXPECT_LT(now, before + 2e-3 * start) << name << ", step " << step << ": what an unfinished solve adds";
      before = now;
    }
    EXPECT_LT(before, 0.1 * start) << name;
  }
}

TEST(Air, KeepsTheLightestClothSteadyInAGaleAtSixtyStepsPerSecond) {
  // Chiffon on a pole in 20 m/s: a hundred times its weight.
  const auto model = sheet_of(0.03);
  Environment environment{.wind = {.velocity = {20, 0, 3}, .air = {.density = 1.2, .lift = 1.2}}};
  for (int j = 0; j <= kCells; ++j) {
    environment.pins.particle.push_back(j * (kCells + 1));
    environment.pins.position.push_back(model->topology->mesh.positions[j * (kCells + 1)]);
  }
  ClothState state = make_state(model->topology->mesh.positions);
  const auto integrator = make("newton");
  for (int frame = 0; frame < 120; ++frame) {
    test::advance(*integrator, *model, environment, 1.0 / 60, 1, state);
    ASSERT_LT(compute_strain(*model, state).max, 0.5) << frame;
    for (std::size_t i = 0; i < state.v.size(); ++i) ASSERT_LT(state.v.get(i).norm(), 40) << frame;
  }
}

TEST(Gusts, AreTheSameForTheSameSeedSmoothAndAsStrongAsAsked) {
  const Gusts gusts{.strength = 2, .length = 0.5, .time = 0.3, .seed = 7};
  Gusts other = gusts;
  other.seed = 8;
  double square = 0, largest_change = 0;
  int count = 0;
  Vec3 sum = Vec3::Zero();
  for (int k = 0; k < 4000; ++k) {
    const Vec3 place(0.37 * k, -0.11 * k, 0.05 * k);
    const double time = 0.017 * k;
    const Vec3 v = gust_velocity(gusts, place, time);
    EXPECT_EQ(v, gust_velocity(gusts, place, time));
    sum += v;
    square += v.squaredNorm() / 3;
    largest_change =
        std::max(largest_change, (gust_velocity(gusts, place + Vec3(1e-4, 0, 0), time) - v).norm());
    ++count;
  }
  EXPECT_NEAR(std::sqrt(square / count), 2, 0.2);
  EXPECT_LT((sum / count).norm(), 0.2) << "about zero";
  EXPECT_LT(largest_change, 1e-4 / 0.5 * 2 * 20) << "slopes of a few strengths per length";
  EXPECT_GT((gust_velocity(gusts, {0.1, 0.2, 0.3}, 1) - gust_velocity(other, {0.1, 0.2, 0.3}, 1)).norm(),
            0.01);
}

}  // namespace
}  // namespace weft::engine
