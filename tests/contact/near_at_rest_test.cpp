/// Cloth nearer to itself at rest than its thickness: short edges, a lining.

#include <gtest/gtest.h>

#include <algorithm>
#include <string>

#include "tests/support.h"
#include "weft/mesh/grid.h"
#include "weft/run/frame_checks.h"
#include "weft/world/measures.h"

namespace weft::engine {
namespace {

constexpr double kThickness = 2e-3, kApart = 0.5e-3;  // [m]
constexpr int kCells = 10;
constexpr double kSize = 0.2;  // [m]

TriangleMesh sheet() { return build_grid_mesh(test::square(kCells, kSize), GridDiagonals::alternating); }

/// A shell with its lining, below it and slightly offset, in one mesh.
TriangleMesh lined_sheet() {
  TriangleMesh mesh = sheet();
  const TriangleMesh shell = mesh;
  const int n = shell.num_vertices();
  for (const Vec3& p : shell.positions) mesh.positions.push_back(p + Vec3(6e-3, -kApart, 8e-3));
  for (const auto& [i, j, k] : shell.triangles) mesh.triangles.push_back({n + i, n + j, n + k});
  return mesh;
}

ClothId add_cloth(World& world, const std::string& name, const TriangleMesh& mesh) {
  return world.add_cloth(
      {.name = name,
       .topology = build_mesh_topology(mesh),
       .material = {.structural = 500, .bend = 1, .damping = 2e-3, .thickness = kThickness},
       .positions = mesh.positions});
}

/// The least distance of the second sheet's particles below those of the first, without borders [m].
double least_distance(const World& world, ClothId upper, ClothId lower, int first_lower) {
  double least = 1;
  for (int row = 2; row < kCells - 1; ++row) {
    for (int i = row * (kCells + 1) + 2; i < row * (kCells + 1) + kCells - 1; ++i) {
      const Vec3 apart = world.state(upper).position(i) - world.state(lower).position(first_lower + i);
      least = std::min(least, apart.y());
    }
  }
  return least;
}

class NearAtRest : public testing::TestWithParam<const char*> {
 protected:
  static World weightless_world() {
    World world;
    world.set_integrator({.integrator = GetParam()});
    world.set_gravity(Vec3::Zero());
    return world;
  }
};

TEST_P(NearAtRest, ALiningStaysWhereItIs) {
  World world = weightless_world();
  const ClothId id = add_cloth(world, "coat", lined_sheet());
  for (int s = 0; s < 30; ++s) ASSERT_TRUE(world.step(1.0 / 60).ok);
  EXPECT_LT(compute_kinetic_energy(world.model(id), world.state(id)), 1e-11);
  EXPECT_NEAR(least_distance(world, id, id, sheet().num_vertices()), kApart, 1e-6);
}

TEST_P(NearAtRest, AShellDoesNotGoThroughItsLining) {
  World world = weightless_world();
  const TriangleMesh mesh = lined_sheet();
  const ClothId id = add_cloth(world, "coat", mesh);
  ClothState state = world.state(id);
  for (int i = 0; i < sheet().num_vertices(); ++i) state.v.set(i, Vec3(0, -0.3, 0));
  World::Snapshot moving = world.snapshot();
  moving.states[0] = state;
  world.restore(moving);
  for (int s = 0; s < 30; ++s) {
    ASSERT_TRUE(world.step(1.0 / 60).ok);
    ASSERT_EQ(verify::check_frame(WorldFrames(world).now().frame, 1).intersections, 0) << "step " << s;
  }
}

TEST_P(NearAtRest, AShortEdgeDoesNotPushItsNeighbours) {
  TriangleMesh mesh = sheet();
  const int middle = kCells / 2 * (kCells + 1) + kCells / 2;
  mesh.positions[middle] = mesh.positions[middle + 1] + Vec3(9e-5, 0, 1e-5);
  World world;
  world.set_integrator({.integrator = GetParam()});
  const ClothId id = add_cloth(world, "sheet", mesh);
  constexpr int kSteps = 30;
  for (int s = 0; s < kSteps; ++s) ASSERT_TRUE(world.step(1.0 / 60).ok);
  const Strain strain = compute_strain(world.model(id), world.state(id));
  EXPECT_LT(std::max(strain.max, -strain.min), 2e-3);
  double farthest = 0;
  for (int i = 0; i < mesh.num_vertices(); ++i)
    farthest = std::max(farthest, (world.state(id).v.get(i) - Vec3(0, -9.81 * kSteps / 60, 0)).norm());
  EXPECT_LT(farthest, 1e-3) << "it falls as one";
}

TEST_P(NearAtRest, ALiningStaysWhereItIsWhenClothBecomesThicker) {
  World world = weightless_world();
  const ClothId id = add_cloth(world, "coat", lined_sheet());
  ClothMaterial material = world.model(id).material;
  material.thickness = kApart / 2;
  world.set_material(id, material);
  ASSERT_TRUE(world.step(1.0 / 60).ok);
  material.thickness = kThickness;
  world.set_material(id, material);
  for (int s = 0; s < 30; ++s) ASSERT_TRUE(world.step(1.0 / 60).ok);
  EXPECT_NEAR(least_distance(world, id, id, sheet().num_vertices()), kApart, 1e-6);
}

TEST_P(NearAtRest, TwoClothsAreSetApartByTheirThickness) {
  World world = weightless_world();
  TriangleMesh lower = sheet();
  for (Vec3& p : lower.positions) p.y() -= kApart;
  const ClothId shell = add_cloth(world, "shell", sheet()), lining = add_cloth(world, "lining", lower);
  for (int s = 0; s < 60; ++s) ASSERT_TRUE(world.step(1.0 / 60).ok);
  EXPECT_GT(least_distance(world, shell, lining, 0), 0.9 * kThickness);
}

INSTANTIATE_TEST_SUITE_P(Integrators, NearAtRest, testing::Values("newton", "implicit_euler", "xpbd"));

}  // namespace
}  // namespace weft::engine
