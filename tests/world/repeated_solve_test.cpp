/// The second solve of a step, with the contacts missing from the first.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <numeric>
#include <vector>

#include "tests/support.h"
#include "weft/world/measures.h"
#include "weft/world/world.h"

namespace weft::engine {
namespace {

constexpr double kFrame = 1.0 / 60;

TEST(RepeatedSolve, AFoldThatClosesFasterThanPredictedMakesLittleEnergy) {
  // Elasticity closes the lower corners of a falling sheet that hangs by the two others: inertia predicts one
  // contact of about a hundred.
  World world;
  world.set_division({.enabled = false});
  const ClothId sheet =
      world.add_cloth({.name = "sheet",
                       .topology = build_grid_topology(test::square(63), SpringModel::alternating),
                       .material = {.structural = 2000, .shear = 1000, .bend = 20}});
  world.set_pins(sheet, {Pin{.particles = {0, 63}}});
  double before = test::energy_of(world), rise = 0;
  const double start = before;
  int contacts = 0;
  for (int frame = 0; frame < 90; ++frame) {
    contacts += static_cast<int>(world.step(kFrame).work.active);
    const double now = test::energy_of(world);
    rise = std::max(rise, now - before);
    before = now;
  }
  EXPECT_GT(contacts, 100) << "or the test shows nothing";
  EXPECT_LT(rise, 0.05 * (start - before));
}

TEST(RepeatedSolve, AReleasedStripIsNotStretchedByTheClothInItsWay) {
  // A strip, pinned at both ends and drawn aside like a bowstring, is at rest: nothing predicts that it snaps
  // back through the sheet in its way within one step.
  World world;
  world.set_gravity(Vec3::Zero());
  world.set_division({.enabled = false});
  const auto strip = build_grid_topology({.size_x = 1, .size_z = 0.1, .cells_x = 40, .cells_z = 4},
                                         SpringModel::alternating);
  std::vector<Vec3> drawn = strip->mesh.positions;
  for (Vec3& p : drawn) p.y() = 0.1 * (1 - std::abs(2 * p.x() - 1));
  std::vector<int> ends;
  for (int i = 0; i < strip->num_particles(); ++i) {
    if (strip->mesh.positions[i].x() < 0.01 || strip->mesh.positions[i].x() > 0.99) ends.push_back(i);
  }
  const ClothId bow = world.add_cloth({.name = "strip",
                                       .topology = strip,
                                       .material = {.structural = 2000, .shear = 1000, .bend = 20},
                                       .positions = drawn});
  world.set_pins(bow, {Pin{.particles = ends}});
  const auto plate = build_grid_topology({.size_x = 0.3, .size_z = 0.3, .cells_x = 12, .cells_z = 12},
                                         SpringModel::alternating);
  std::vector<Vec3> places = plate->mesh.positions;
  for (Vec3& p : places) p += Vec3(0.35, 0.05, -0.1);
  const ClothId sheet = world.add_cloth({.name = "sheet", .topology = plate, .positions = places});
  std::vector<int> all(plate->num_particles());
  std::iota(all.begin(), all.end(), 0);
  world.set_pins(sheet, {Pin{.particles = all}});
  double strain = 0;
  for (int k = 0; k < 10; ++k) {
    world.step(kFrame);
    strain = std::max(strain, compute_strain(world.model(bow), world.state(bow)).max);
  }
  EXPECT_LT(strain, 0.03);
}

TEST(RepeatedSolve, IsRareWhileASheetDrapesOverAMesh) {
  // The taut part in the air pulls the part on the mesh along, which inertia alone does not predict.
  World world;
  const auto ball = std::make_shared<const TriangleMesh>(make_sphere_mesh(Vec3::Zero(), 0.15, 48));
  world.add_collider({.name = "ball", .shape = MeshShape{.mesh = ball}, .friction = 0.5});
  const auto topology = build_grid_topology(test::square(40, 0.5), SpringModel::alternating);
  std::vector<Vec3> places = topology->mesh.positions;
  for (Vec3& p : places) p += Vec3(-0.25, 0.16, -0.25);
  world.add_cloth({.name = "sheet",
                   .topology = topology,
                   .material = {.structural = 2000, .shear = 1000, .bend = 0.01},
                   .positions = places});
  int repeated = 0, touching = 0;
  for (int frame = 0; frame < 30; ++frame) {
    const StepReport report = world.step(kFrame);
    if (report.work.active == 0) continue;
    ++touching;
    constexpr int kOneSolve = 6;  // Newton steps at most
    repeated += report.iterations > kOneSolve * report.divisions;
  }
  EXPECT_GT(touching, 20) << "or the test shows nothing";
  EXPECT_LE(repeated, 2);
}

/// Fastest particle of two sheets that start 0.3 mm apart, with 1 mm of thickness, after one frame [m/s].
double separate(int steps) {
  World world;
  world.set_gravity(Vec3::Zero());
  world.set_division({.enabled = false});
  const auto topology = build_grid_topology(test::square(12, 0.3), SpringModel::alternating);
  for (const double height : {0.0, 3e-4}) {
    std::vector<Vec3> places = topology->mesh.positions;
    for (Vec3& p : places) p += Vec3(height, height, 0);
    world.add_cloth(
        {.name = "sheet", .topology = topology, .material = {.thickness = 1e-3}, .positions = places});
  }
  for (int s = 0; s < steps; ++s) world.step(kFrame / steps);
  double fastest = 0;
  for (int c = 0; c < 2; ++c) {
    const Vec3Array& v = world.state(world.cloth(c)).v;
    for (std::size_t i = 0; i < v.size(); ++i) fastest = std::max(fastest, v.get(i).norm());
  }
  return fastest;
}

TEST(Separation, IsNotFasterInShorterSteps) {
  const double whole = separate(1);
  EXPECT_GT(whole, 1e-3);
  EXPECT_LT(separate(16), 1.5 * whole);
}

}  // namespace
}  // namespace weft::engine
