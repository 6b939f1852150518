/// Cloth in resting contact comes to rest and stays at rest.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "tests/support.h"
#include "weft/world/measures.h"

namespace weft::engine {
namespace {

const ClothMaterial kCotton{.structural = 60, .shear = 20, .bend = 0.3, .damping = 2e-3, .friction = 0.4};

/// Square sheets of 0.8 m, one above the other, over a ball of 0.3 m.
World make_sheets_on_ball(const std::string& integrator, int num_sheets, int cells) {
  constexpr double kSize = 0.8;
  World world;
  world.set_integrator({.integrator = integrator, .explicit_euler = {}, .paper = {}, .implicit_euler = {}});
  world.add_collider({"ball", Sphere{Vec3::Zero(), 0.3}, 0.4, {}});
  const auto topology = build_grid_topology(test::square(cells, kSize), SpringModel::simplified);
  for (int c = 0; c < num_sheets; ++c) {
    std::vector<Vec3> positions;
    for (const Vec3& p : topology->mesh.positions)
      positions.push_back(p + Vec3(-kSize / 2, 0.301 + 0.003 * c, -kSize / 2));
    world.add_cloth({.name = "sheet", .topology = topology, .material = kCotton, .positions = positions});
  }
  return world;
}

struct Rest {
  double largest_kinetic = 0;  // of one cloth after settling [J]
  double largest_rise = 0;     // of the total energy of one cloth, from its lowest to any later one [J]
  double drift = 0;            // of a centre [m]
  double drop = 0;             // drop of the first one's centre since the start [m]
};

/// Runs `settling` seconds, then measures for `watching` more.
Rest watch(World& world, double settling, double watching, int steps_per_second) {
  const double step = 1.0 / steps_per_second;
  const auto middle = [&](int c) {
    return compute_center_of_mass(world.model(world.cloth(c)), world.state(world.cloth(c)));
  };
  const Vec3 first = middle(0);
  const auto run = [&](double seconds, const auto& after_step) {
    for (int s = 0; s < std::lround(seconds * steps_per_second); ++s) {
      const StepReport report = world.step(step);
      ASSERT_TRUE(report.ok);
      after_step();
    }
  };
  run(settling, [] {});
  const int n = world.num_cloths();
  std::vector<Vec3> before;
  std::vector<double> lowest(n, std::numeric_limits<double>::infinity());
  for (int c = 0; c < n; ++c) before.push_back(middle(c));
  Rest rest;
  run(watching, [&] {
    for (int c = 0; c < n; ++c) {
      const ClothModel& model = world.model(world.cloth(c));
      const ClothState& state = world.state(world.cloth(c));
      const double kinetic = compute_kinetic_energy(model, state);
      const double energy = kinetic + compute_elastic_energy(model, state) +
                            compute_gravity_energy(model, state, world.gravity());
      rest.largest_kinetic = std::max(rest.largest_kinetic, kinetic);
      rest.largest_rise = std::max(rest.largest_rise, energy - lowest[c]);
      lowest[c] = std::min(lowest[c], energy);
      rest.drift = std::max(rest.drift, (middle(c) - before[c]).norm());
    }
  });
  rest.drop = (first - middle(0)).y();
  return rest;
}

struct RestCase {
  const char* integrator;
  int num_sheets, cells;
  int steps_per_second;
  double fastest;  // average speed that counts as rest [m/s]
};

class ClothOnABall : public testing::TestWithParam<RestCase> {};

TEST_P(ClothOnABall, ComesToRestAndStays) {
  const auto [integrator, num_sheets, cells, steps_per_second, fastest] = GetParam();
  World world = make_sheets_on_ball(integrator, num_sheets, cells);
  const Rest rest = watch(world, 5, 10, steps_per_second);
  RecordProperty("kinetic_nJ", std::to_string(rest.largest_kinetic * 1e9));
  RecordProperty("rise_nJ", std::to_string(rest.largest_rise * 1e9));
  RecordProperty("drift_um", std::to_string(rest.drift * 1e6));
  EXPECT_GT(rest.drop, 0.02) << "it has draped itself over the ball, and hangs";
  // Mass 0.128 kg. (implicit_euler is not among the cases: at 60 steps per second it jitters by some
  // centimetres per second on this ball, because triangles sag into round shapes between its steps.)
  EXPECT_LT(rest.largest_kinetic, 0.5 * 0.128 * fastest * fastest);
  EXPECT_LT(rest.drift, 1e-3);
  // Corresponds to lifting the sheet by 40 µm: a twenty-fifth of its thickness.
  EXPECT_LT(rest.largest_rise, 0.128 * 9.81 * 4e-5);
}

INSTANTIATE_TEST_SUITE_P(Scenes, ClothOnABall,
                         testing::Values(RestCase{"paper_fixed", 1, 16, 600, 0.005},
                                         RestCase{"paper_fixed", 2, 10, 600, 0.02}),
                         [](const auto& test) {
                           return test.param.integrator + std::string("_") +
                                  std::to_string(test.param.num_sheets);
                         });

TEST(LayersOnAFloor, DoNotBuzz) {
  // Two sheets, one rotated by 7°. Solving one after the other with later separation would jitter by
  // 0.8 mm/s indefinitely.
  World world;
  world.add_collider({"floor", Plane{Vec3::Zero(), Vec3::UnitY()}, 0.4, {}});
  const auto topology = build_grid_topology(test::square(24, 0.75), SpringModel::alternating);
  for (const double angle_deg : {0.0, 7.0}) {
    const Eigen::AngleAxisd turn(angle_deg * 3.14159265358979 / 180, Vec3::UnitY());
    std::vector<Vec3> positions;
    for (const Vec3& p : topology->mesh.positions)
      positions.push_back(turn * (p - Vec3(0.375, 0, 0.375)) + Vec3(0, angle_deg == 0 ? 0.004 : 0.008, 0));
    world.add_cloth({.name = "layer",
                     .topology = topology,
                     .material = {.damping = 2e-3, .friction = 0.2},
                     .positions = positions});
  }
  for (int s = 0; s < 120; ++s) ASSERT_TRUE(world.step(1.0 / 60).ok);
  for (const int cloth : {0, 1}) {
    double kinetic = 0;
    constexpr int kSteps = 20;
    for (int s = 0; s < kSteps; ++s) {
      world.step(1.0 / 60);
      kinetic +=
          compute_kinetic_energy(world.model(world.cloth(cloth)), world.state(world.cloth(cloth))) / kSteps;
    }
    const double speed = std::sqrt(2 * kinetic / (0.2 * 0.75 * 0.75));
    std::printf("layer %d: %.2e m/s\n", cloth, speed);
    EXPECT_LT(speed, 1e-4);
  }
}

}  // namespace
}  // namespace weft::engine
