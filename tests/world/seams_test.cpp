/// Panels that are sewn together: half sheets against a whole one, momentum, energy, contact, mistakes.

#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "tests/message_of.h"
#include "tests/same_continuation.h"
#include "weft/face/convert.h"
#include "weft/face/world_impl.h"
#include "weft/mesh/sample_meshes.h"
#include "weft/verify/crossings.h"
#include "weft/weft.h"
#include "weft/world/energy_audit.h"

namespace weft {
namespace {

constexpr double kStep = 1.0 / 60;

Fabric woven() {
  Fabric fabric = find_fabric("cotton_shirting");
  fabric.damping = 0.01;
  return fabric;
}

/// Grids in the x–z plane as pieces of one mesh, each moved by its offset.
struct Panels {
  TriangleMesh mesh;
  std::vector<int> first;  // vertex of each piece

  void add(const Grid& grid, const Vec3& offset) {
    first.push_back(static_cast<int>(mesh.positions.size()));
    const engine::TriangleMesh piece = engine::build_random_mesh(grid, first.size());
    for (const engine::Vec3& p : piece.positions) mesh.positions.push_back(engine::from_engine(p) + offset);
    for (const auto& [a, b, c] : piece.triangles)
      mesh.triangles.push_back({first.back() + a, first.back() + b, first.back() + c});
  }
};

/// Two half sheets side by side, `gap` apart along x; their borders are divided differently.
struct Halves {
  Panels panels;
  Seam seam;
  std::vector<int> corners;  // the outer ones at z = 0

  explicit Halves(double gap, int left_rows = 16, int right_rows = 21) {
    panels.add({0.25, 0.5, 8, left_rows}, {0, 0, 0});
    panels.add({0.25, 0.5, 8, right_rows}, {0.25 + gap, 0, 0});
    const int other = panels.first[1];
    seam = {{8, 9 * left_rows + 8}, {other, other + 9 * right_rows}};
    corners = {0, other + 8};
  }
};

ClothDesc describe(const Halves& halves, double time) {
  return {.shape = halves.panels.mesh,
          .fabric = woven(),
          .warp = Vec3{1, 0, 0},
          .seams = {halves.seam},
          .seam_time = time};
}

void settle(World& world, int steps) {
  for (int s = 0; s < steps; ++s) ASSERT_TRUE(world.step(kStep).ok);
}

/// Stitches of vertices that match one to one hang like a seam of the same borders.
TEST(Stitches, OfMatchingBordersHangLikeASeam) {
  const Halves halves(0.0005, 16, 16);
  const int other = halves.panels.first[1];
  const auto hang = [&](const ClothDesc& desc) {
    World world;
    ClothDesc upright = desc;
    upright.pose.rotation = rotation_about({1, 0, 0}, 90);
    const ClothId sheet = world.add_cloth(upright);
    world.add_pin(sheet, {.particles = halves.corners});
    settle(world, 150);
    return world.positions(sheet);
  };
  ClothDesc stitched = describe(halves, 0);
  stitched.seams.clear();
  for (int j = 0; j <= 16; ++j) stitched.stitches.push_back({9 * j + 8, other + 9 * j});
  const std::vector<Vec3> sewn = hang(describe(halves, 0)), found = hang(stitched);
  for (const int v : {16 * 9, other + 16 * 9 + 8, 8 * 9 + 8})
    EXPECT_LT(length(found[v] - sewn[v]), 0.25 / 24) << v;
  for (const auto& [a, b] : stitched.stitches) EXPECT_LT(length(found[a] - found[b]), 0.002);
}

/// Stitches join any vertices: a patch is sewn on a sheet by its border.
TEST(Stitches, SewAPatchOnASheet) {
  Panels panels;
  panels.add({0.4, 0.4, 16, 16}, {});
  panels.add({0.1, 0.1, 4, 4}, {0.15, 0.03, 0.15});
  const int patch = panels.first[1];
  ClothDesc desc{.shape = panels.mesh, .fabric = woven(), .warp = Vec3{1, 0, 0}, .seam_time = 0.3};
  for (int j = 0; j <= 4; ++j) {
    for (int i = 0; i <= 4; ++i) {
      if (i % 4 == 0 || j % 4 == 0) desc.stitches.push_back({patch + 5 * j + i, 17 * (6 + j) + 6 + i});
    }
  }
  World world;
  world.set_gravity({0, 0, 0});
  const ClothId cloth = world.add_cloth(desc);
  settle(world, 90);
  const std::vector<Vec3> x = world.positions(cloth);
  for (const auto& [a, b] : desc.stitches) EXPECT_LT(length(x[a] - x[b]), 0.003);
  EXPECT_EQ(world.notes(cloth).done.back(),
            "cloth \"cloth\": 0 seams and 16 stitches draw together, from up to 0.03144 m");
}

constexpr const char* kRefusal =
    "cloth \"cloth\" has seams, but paper does not support them; use newton, implicit_euler or xpbd";

TEST(Stitches, RefuseMistakes) {
  const Halves halves(0.02);
  ClothDesc desc = describe(halves, 0.2);
  desc.stitches = {{0, 1}, {2, 5000}};
  EXPECT_EQ(message_of([&] { World().add_cloth(desc); }),
            "cloth \"cloth\": stitch 1: vertex 5000 is not one of the shape's " +
                std::to_string(halves.panels.mesh.num_vertices()));
  World world;
  world.set_integrator({.integrator = "paper"});
  desc.fabric = Springs{};
  desc.stitches = {{8, halves.panels.first[1]}};
  desc.seams.clear();
  EXPECT_EQ(message_of([&] { world.add_cloth(desc); }), kRefusal);
}

/// Hung by two corners, with the seam between them: its lower corners hang where those of a whole sheet
/// hang, within a third of an edge.
TEST(Seams, TwoHalvesHangLikeAWholeSheet) {
  for (const char* integrator : {"newton", "implicit_euler", "xpbd"}) {
    const auto hang = [&](ClothDesc desc, const std::vector<int>& upper, const std::vector<int>& lower) {
      World world;
      world.set_integrator({.integrator = integrator});
      desc.pose.rotation = rotation_about({1, 0, 0}, 90);
      const ClothId sheet = world.add_cloth(desc);
      world.add_pin(sheet, {.particles = upper});
      settle(world, 150);
      std::vector<Vec3> found;
      for (const int v : lower) found.push_back(world.positions(sheet)[v]);
      return found;
    };
    Panels one;
    one.add({0.5, 0.5, 16, 18}, {});
    const std::vector<Vec3> whole =
        hang({.shape = one.mesh, .fabric = woven(), .warp = Vec3{1, 0, 0}}, {0, 16}, {18 * 17, 18 * 17 + 16});
    const Halves halves(0.0005);
    const int other = halves.panels.first[1];
    const std::vector<Vec3> sewn = hang(describe(halves, 0), halves.corners, {16 * 9, other + 21 * 9 + 8});
    for (int k : {0, 1}) EXPECT_LT(length(sewn[k] - whole[k]), 0.01) << integrator;
    EXPECT_LT(whole[0].y, -0.49);
  }
}

/// Free panels without gravity: half way at half time, closed at the end, and their centre stays.
TEST(Seams, DrawFreePanelsTogether) {
  const Halves halves(0.2);
  World world;
  world.set_gravity({0, 0, 0});
  const ClothId cloth = world.add_cloth(describe(halves, 2));
  const auto gap = [&] {
    const std::vector<Vec3> x = world.positions(cloth);
    return length(x[halves.seam.a[0]] - x[halves.seam.b[0]]);
  };
  const Vec3 start = world.center_of_mass(cloth);
  settle(world, 60);
  EXPECT_NEAR(gap(), 0.1, 0.01);
  settle(world, 120);
  const double thickness = woven().thickness;
  EXPECT_GT(gap(), 0.9 * thickness) << "contact keeps layers apart";
  EXPECT_LT(gap(), 1.5 * thickness);
  EXPECT_LT(length(world.center_of_mass(cloth) - start), 1e-5);
}

/// A strip whose ends are sewn: a tube without an open seam. Its faces do not cross.
TEST(Seams, MakeATubeOfAStrip) {
  const Grid grid{0.6, 0.2, 48, 12};
  World world;
  world.set_gravity({0, 0, 0});
  engine::TriangleMesh strip = engine::build_grid_mesh(grid, engine::GridDiagonals::alternating);
  for (engine::Vec3& p : strip.positions) {  // three quarters of a cylinder's wall
    const double angle = 1.5 * M_PI * p.x() / 0.6, radius = 0.6 / (1.5 * M_PI);
    p = {radius * std::cos(angle), radius * std::sin(angle), p.z()};
  }
  const ClothId cloth = world.add_cloth({.shape = engine::from_engine(strip, {}),
                                         .fabric = woven(),
                                         .warp = Vec3{0, 0, 1},
                                         .seams = {{{0, 12 * 49}, {48, 13 * 49 - 1}}}});
  settle(world, 180);
  const std::vector<Vec3> x = world.positions(cloth);
  const std::vector<engine::Vec3> points = engine::to_engine(x);
  EXPECT_TRUE(engine::verify::find_crossings(
                  std::vector<engine::verify::SurfaceView>{{points, world.triangles(cloth)}})
                  .empty());
  for (int row = 0; row <= 12; ++row)
    EXPECT_LT(length(x[49 * row] - x[49 * row + 48]), 2 * woven().thickness) << row;
}

/// The audit has the work of closing seams: nothing else moves these panels, and no energy is left over but what
/// damping takes.
TEST(Seams, WorkIsInTheEnergyAudit) {
  World world;
  world.set_gravity({0, 0, 0});
  world.set_integrator({.integrator = "implicit_euler"});
  world.set_contact({.enabled = false});
  world.add_cloth(describe(Halves(0.1), 0.5));
  double work = 0, kinetic = 0;
  for (int s = 0; s < 60; ++s) {
    const engine::World& inner = WorldAccess::engine(world);
    const engine::AuditStart start = engine::begin_energy_audit(inner);
    ASSERT_TRUE(world.step(1.0 / 120).ok);
    const engine::EnergyAudit audit = engine::finish_energy_audit(start, inner);
    EXPECT_LT(audit.left_over, 1e-6) << s;
    work += audit.work_hands;
    kinetic = std::max(kinetic, audit.energy.kinetic);
  }
  EXPECT_GT(kinetic, 1e-4);
  EXPECT_GT(work, kinetic);
}

TEST(Seams, ArePartOfSnapshotsAndOfSavedWorlds) {
  const Halves halves(0.1);
  World world;
  world.add_cloth(describe(halves, 0.5));
  settle(world, 10);
  expect_same_continuation(world, 10, kStep);
}

TEST(Seams, HaveTheSameBitsForAnyNumberOfThreads) {
  std::vector<std::uint64_t> hashes;
  for (const int threads : {1, 3}) {
    World world;
    world.set_jobs(make_jobs(threads));
    world.add_cloth(describe(Halves(0.05), 0.3));
    settle(world, 30);
    hashes.push_back(world.state_hash());
  }
  EXPECT_EQ(hashes[0], hashes[1]);
}

TEST(Seams, OnAGridNumberItsVerticesByRows) {
  World world;
  const ClothId cloth = world.add_cloth(
      {.shape = Grid{0.4, 0.2, 8, 4}, .fabric = woven(), .seams = {{{0, 36}, {8, 44}}}, .seam_time = 0.5});
  EXPECT_EQ(world.positions(cloth).size(), 45u);
  settle(world, 10);
}

TEST(Seams, MistakesAreRefused) {
  const auto message = [](const ClothDesc& desc, const char* integrator = "newton") {
    return message_of([&] {
      World world;
      world.set_integrator({.integrator = integrator});
      world.add_cloth(desc);
    });
  };
  const Halves halves(0.1);
  ClothDesc desc = describe(halves, 1);
  ClothDesc of_springs = desc;
  of_springs.fabric = Springs{};
  EXPECT_EQ(message(of_springs, "paper"), kRefusal);
  desc.seam_time = -1;
  EXPECT_EQ(message(desc), "cloth \"cloth\": seam_time must be 0 s or more");
  desc.seam_time = 1;
  desc.seams[0].a = {0, 20};
  EXPECT_EQ(message(desc), "cloth \"cloth\": seam 0: vertex 20 is not on the border of vertex 0");
  desc.seams[0].a = {0, 5000};
  EXPECT_EQ(message(desc), "cloth \"cloth\": seam 0: vertex 5000 is not one of the shape's 351");
  desc.seams[0] = {{0, 4}, {0, 4}};
  EXPECT_EQ(message(desc), "cloth \"cloth\": seam 0: its two stretches of border are the same");
  EXPECT_EQ(message({.shape = Grid{1, 1, 4, 4}, .fabric = Springs(), .seams = {{{0, 4}, {20, 24}}}}),
            "cloth \"cloth\": a grid of springs has no seams; give it a fabric");
}

}  // namespace
}  // namespace weft
