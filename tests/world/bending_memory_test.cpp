/// Cloth whose threads rub as it bends, and cloth that creases: it keeps its folds by the formula, and loses
/// energy only.

#include <gtest/gtest.h>

#include <cmath>

#include "tests/message_of.h"
#include "weft/weft.h"

namespace weft {
namespace {

constexpr double kStep = 1.0 / 60;
constexpr double kRigidity = 2e-5, kSlip = 10;  // [N·m], [1/m]

/// Slow enough by its damping that it unbends without inertia.
Fabric slow(double hysteresis, double set) {
  return {.density = 0.15,
          .c11 = 1000,
          .c22 = 1000,
          .g = 100,
          .bend_warp = kRigidity,
          .bend_weft = kRigidity,
          .bend_bias = kRigidity,
          .bend_hysteresis_warp = hysteresis,
          .bend_hysteresis_weft = hysteresis,
          .bend_set = set,
          .damping = 0.2};
}

constexpr int kCellsX = 20, kCellsZ = 4;
constexpr double kLength = 0.05;

ClothDesc strip_of(const Fabric& fabric, bool on_mesh) {
  const Grid grid{.size_x = kLength, .size_z = kLength / 5, .cells_x = kCellsX, .cells_z = kCellsZ};
  ClothDesc desc;
  desc.fabric = fabric;
  desc.warp = Vec3{1, 0, 0};
  if (!on_mesh) {
    desc.shape = grid;
    return desc;
  }
  TriangleMesh mesh;
  const int columns = kCellsX + 1;
  for (int j = 0; j <= kCellsZ; ++j) {
    for (int i = 0; i < columns; ++i)
      mesh.positions.push_back({kLength * i / kCellsX, 0, kLength / 5 * j / kCellsZ});
  }
  for (int j = 0; j < kCellsZ; ++j) {
    for (int i = 0; i < kCellsX; ++i) {
      const int a = j * columns + i, b = a + columns;
      mesh.triangles.push_back({a, b, a + 1});
      mesh.triangles.push_back({a + 1, b, b + 1});
    }
  }
  desc.shape = mesh;
  return desc;
}

/// Rolls a strip to a cylinder of this curvature.
void roll(World& world, ClothId cloth, double curvature) {
  std::vector<Vec3> x = world.positions(cloth);
  for (Vec3& p : x) {
    const double along = p.x;
    p.x = std::sin(curvature * along) / curvature;
    p.y = (1 - std::cos(curvature * along)) / curvature;
  }
  world.set_positions(cloth, x);
}

/// Of the middle row, from the directions of the cells next to its ends.
double curvature_of(const World& world, ClothId cloth) {
  const std::vector<Vec3> x = world.positions(cloth);
  const int first = kCellsZ / 2 * (kCellsX + 1) + 2, last = first + kCellsX - 4;
  const Vec3 a = x[first + 1] - x[first], b = x[last] - x[last - 1];
  return std::acos(dot(a, b) / (length(a) * length(b))) / (kLength / kCellsX * (last - first - 1));
}

/// Where no moment is left: D (κ − κ_set) = −H clamp((κ − κ_slip)/s), after bending to `most`.
double kept_curvature(double most, double friction, double set) {
  const double kept_set = set > 0 ? std::max(0.0, most - set) : 0, slip = most - kSlip;
  const double sliding = kept_set + friction / kRigidity;
  if (sliding <= most - 2 * kSlip) return sliding;
  const double stick = friction / kSlip;
  return (kRigidity * kept_set + stick * slip) / (kRigidity + stick);
}

struct Fold {
  double most, friction, set;  // [1/m], [N], [1/m]
};

/// Curvature of a strip two seconds after it has been let go [1/m].
double unfold(const IntegratorSettings& settings, const Fold& fold, double damping, bool on_mesh) {
  World world;
  world.set_gravity({0, 0, 0});
  world.set_integrator(settings);
  Fabric fabric = slow(2 * fold.friction, fold.set);
  fabric.damping = damping;
  const ClothId cloth = world.add_cloth(strip_of(fabric, on_mesh));
  roll(world, cloth, fold.most);
  for (int s = 0; s < 120; ++s) EXPECT_TRUE(world.step(kStep).ok);
  return curvature_of(world, cloth);
}

TEST(BendingMemory, AStripKeepsItsFoldByTheFormula) {
  for (const char* integrator : {"newton", "implicit_euler"}) {
    for (const bool on_mesh : {false, true}) {
      for (const Fold& f : {Fold{60, 4e-4, 0}, Fold{60, 1e-3, 0}, Fold{60, 2e-4, 30}, Fold{50, 0, 20}}) {
        EXPECT_NEAR(unfold({.integrator = integrator}, f, 0.2, on_mesh),
                    kept_curvature(f.most, f.friction, f.set), 0.04 * f.most)
            << integrator << (on_mesh ? " mesh " : " grid ") << f.most << ' ' << f.friction << ' ' << f.set;
      }
    }
  }
}

/// A sheet that is shaken and left alone, without damping: its energy is never above that of the start, and friction takes
/// more of it than the integrator does. (The integrator alone raises it by 7 % in the first steps.)
TEST(BendingMemory, OnlyLosesEnergy) {
  double left[2];
  for (const bool has_friction : {false, true}) {
    Fabric fabric = slow(has_friction ? 4e-4 : 0, has_friction ? 100 : 0);
    fabric.damping = 0;
    World world;
    world.set_gravity({0, 0, 0});
    const ClothId cloth = world.add_cloth(
        {.shape = Grid{.size_x = 0.3, .size_z = 0.3, .cells_x = 20, .cells_z = 20}, .fabric = fabric});
    std::vector<Vec3> v(world.positions(cloth).size());
    for (std::size_t i = 0; i < v.size(); ++i) v[i].y = 0.3 * std::sin(0.37 * static_cast<double>(i % 21));
    world.set_velocities(cloth, v);
    const double start = world.energies().total();
    double largest = 0;
    for (int s = 0; s < 60; ++s) {
      ASSERT_TRUE(world.step(kStep / 2).ok);
      largest = std::max(largest, world.energies().total());
    }
    if (has_friction) {
      EXPECT_LE(largest, start * 1.001);
    }
    left[has_friction ? 1 : 0] = world.energies().total() / start;
  }
  EXPECT_LT(left[1], 0.7 * left[0]);
}

TEST(BendingMemory, IsSavedAndHasTheSameBitsForAnyThreads) {
  std::vector<std::uint64_t> hashes;
  for (const int threads : {1, 2, 3}) {
    World world;
    world.set_jobs(make_jobs(threads));
    const ClothId cloth =
        world.add_cloth({.shape = Grid{.size_x = 0.5, .size_z = 0.5, .cells_x = 40, .cells_z = 40},
                         .fabric = slow(1e-3, 60)});
    world.set_pins(cloth, {{.particles = {0, 40}}});
    for (int s = 0; s < 20; ++s) ASSERT_TRUE(world.step(kStep).ok);
    World restored = World::load(world.save());
    for (World* each : {&world, &restored}) {
      for (int s = 0; s < 10; ++s) ASSERT_TRUE(each->step(kStep).ok);
      hashes.push_back(each->state_hash());
    }
  }
  for (const std::uint64_t hash : hashes) EXPECT_EQ(hash, hashes[0]);
}

TEST(BendingMemory, RefusesNegativeNumbers) {
  Fabric fabric;
  fabric.bend_hysteresis_warp = -1;
  fabric.bend_hysteresis_weft = std::nan("");
  fabric.bend_set = -2;
  const std::vector<FabricMistake> mistakes = find_mistakes(fabric);
  ASSERT_EQ(mistakes.size(), 3u);
  EXPECT_EQ(mistakes[0].field, "bend_hysteresis_warp");
  EXPECT_EQ(mistakes[0].reason, "must be 0 N or above, is -1");
}

TEST(BendingMemory, IsRefusedByXpbd) {
  World world;
  world.set_integrator({.integrator = "xpbd"});
  const ClothId cloth = world.add_cloth(strip_of(slow(0, 0), false));
  const std::string sentence =
      "has a bend_hysteresis or bend_set, but xpbd does not support it; use newton or implicit_euler";
  EXPECT_NE(message_of([&] { world.add_cloth(strip_of(slow(0, 60), true)); }).find(sentence),
            std::string::npos);
  EXPECT_NE(message_of([&] { world.set_fabric(cloth, slow(1e-3, 0)); }).find(sentence), std::string::npos);
  World other;
  other.add_cloth(strip_of(slow(1e-3, 0), false));
  EXPECT_NE(message_of([&] { other.set_integrator({.integrator = "xpbd"}); }).find(sentence),
            std::string::npos);
}

/// A softer fabric in the middle of a run, with or without memory, needs no restart.
TEST(BendingMemory, ComesAndGoesWithTheFabric) {
  World world;
  const ClothId cloth = world.add_cloth(
      {.shape = Grid{.size_x = 0.3, .size_z = 0.3, .cells_x = 10, .cells_z = 10}, .fabric = slow(1e-3, 60)});
  world.set_pins(cloth, {{.particles = {0, 10}}});
  for (int round = 0; round < 3; ++round) {
    for (const double hysteresis : {0.0, 1e-3}) {
      world.set_fabric(cloth, slow(hysteresis, 0));
      for (int s = 0; s < 5; ++s) ASSERT_TRUE(world.step(kStep).ok);
    }
  }
}

}  // namespace
}  // namespace weft
