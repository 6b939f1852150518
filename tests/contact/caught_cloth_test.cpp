/// Cloth caught between colliders that overlap: it is not torn, is listed, and is free when they part.

#include <gtest/gtest.h>

#include <algorithm>
#include <string>

#include "tests/support.h"
#include "weft/animation/mesh_sequence.h"
#include "weft/mesh/sample_meshes.h"
#include "weft/run/frame_checks.h"
#include "weft/world/measures.h"

namespace weft::engine {
namespace {

constexpr double kFrame = 1.0 / 60;
constexpr double kRadius = 0.1, kOverlap = 0.06;        // [m]
constexpr int kClosed = 20, kOpening = 40, kOpen = 60;  // frames

std::shared_ptr<const TriangleMesh> shared(TriangleMesh mesh) {
  return std::make_shared<const TriangleMesh>(std::move(mesh));
}

/// From 5 cm away to the overlap, and back; `slide`: meanwhile, how far upwards.
RigidMotion jaw_motion(double side, double slide) {
  const double way = -side * (0.05 + kOverlap / 2);
  return RigidMotion({{.time = 0},
                      {.time = kClosed * kFrame, .translation = {0, 0, way}},
                      {.time = (kClosed + kOpening) / 2 * kFrame, .translation = {0, slide, way}},
                      {.time = kOpening * kFrame, .translation = {0, 0, way}},
                      {.time = kOpen * kFrame}});
}

/// Two jaws, of a kind: "sphere", "capsule", "box", "mesh", "both" (a sphere and a mesh), or "limbs"
/// of one mesh.
void add_jaws(const std::string& kind, double slide, World& world) {
  if (kind == "limbs") {
    const TriangleMesh ball = build_geodesic_mesh(kRadius, 3);
    TriangleMesh both;
    const auto place = [&](double to_middle) {
      std::vector<Vec3> places;
      for (const double side : {1.0, -1.0}) {
        for (const Vec3& p : ball.positions) places.push_back(p + Vec3(0, 0, side * (kRadius + to_middle)));
      }
      return places;
    };
    both.positions = place(0.05);
    for (const int first : {0, ball.num_vertices()}) {
      for (const auto& [i, j, k] : ball.triangles)
        both.triangles.push_back({first + i, first + j, first + k});
    }
    MeshShape shape;
    shape.source = std::make_shared<const MeshSequence>(
        std::vector<MeshSequence::Key>{{0, both.positions},
                                       {kClosed * kFrame, place(-kOverlap / 2)},
                                       {kOpening * kFrame, place(-kOverlap / 2)},
                                       {kOpen * kFrame, both.positions}});
    shape.mesh = shared(std::move(both));
    world.add_collider({"limbs", shape, 0.4, {}});
    return;
  }
  for (const double side : {1.0, -1.0}) {
    const Vec3 center(0, 0, side * (kRadius + 0.05));
    ColliderShape shape = Sphere{center, kRadius};
    if (kind == "capsule") shape = Capsule{center - Vec3(0.1, 0, 0), center + Vec3(0.1, 0, 0), kRadius};
    if (kind == "box") shape = OrientedBox{center, {0.08, 0.08, kRadius}};
    if (kind == "mesh" || (kind == "both" && side > 0))
      shape = MeshShape{.mesh = shared(build_geodesic_mesh(kRadius, 3)), .translation = center};
    world.add_collider({"", shape, 0.4, jaw_motion(side, side > 0 ? slide : 0)});
  }
}

/// A sheet that hangs by two corners between them.
ClothId hang(World& world) {
  const auto topology = build_grid_topology(test::square(25, 0.5), SpringModel::alternating);
  std::vector<Vec3> positions;
  for (const Vec3& p : topology->mesh.positions) positions.emplace_back(p.x() - 0.25, 0.25 - p.z(), 0);
  const ClothId sheet =
      world.add_cloth({.name = "sheet",
                       .topology = topology,
                       .material = {.structural = 2000, .shear = 1000, .bend = 2, .damping = 0.05},
                       .positions = positions});
  world.set_pins(sheet, {Pin{.particles = {0, 25}}});
  return sheet;
}

class CaughtCloth : public testing::TestWithParam<const char*> {};

TEST_P(CaughtCloth, IsNotTornAndIsFreeWhenBodiesPart) {
  World world;
  add_jaws(GetParam(), 0, world);
  const ClothId sheet = hang(world);
  std::size_t most = 0, listed = 0, caught = 0;
  double strain = 0;
  int parts = 0;
  for (int frame = 1; frame <= kOpen + 30; ++frame) {
    const StepReport report = world.step(kFrame);
    ASSERT_TRUE(report.ok);
    listed += report.infeasible.size();
    caught += std::ranges::count(report.infeasible, InfeasibleKind::caught, &InfeasiblePair::kind);
    parts += report.divisions;
    most = std::max(most, world.state(sheet).caught.size());
    strain = std::max(strain, compute_yarn_strain(world.model(sheet), world.state(sheet)).max);
    if (frame < kOpen) continue;
    const FrameToCheck now = WorldFrames(world).now();
    const verify::FrameCheck check = verify::check_frame(now.frame, 1);
    ASSERT_EQ(check.intersections, 0) << frame;
    ASSERT_LE(check.penetration(), 1e-6) << frame;
  }
  EXPECT_GT(most, 20U) << "or the test shows nothing";
  EXPECT_GE(listed, most) << "each is reported";
  EXPECT_GE(caught, most) << "as caught";
  EXPECT_TRUE(world.state(sheet).caught.empty());
  EXPECT_LT(strain, 0.2);
  EXPECT_LT(parts, 2 * (kOpen + 30));
}

INSTANTIATE_TEST_SUITE_P(Jaws, CaughtCloth,
                         testing::Values("sphere", "capsule", "box", "mesh", "both", "limbs"));

TEST(CaughtCloth, IsNotTornByJawsThatSlideAlongEachOther) {
  for (const char* kind : {"sphere", "capsule", "mesh"}) {
    World world;
    add_jaws(kind, 0.05, world);
    const ClothId sheet = hang(world);
    double strain = 0;
    for (int frame = 1; frame <= kOpen + 10; ++frame) {
      ASSERT_TRUE(world.step(kFrame).ok);
      strain = std::max(strain, compute_yarn_strain(world.model(sheet), world.state(sheet)).max);
    }
    EXPECT_LT(strain, 0.2) << kind;
    EXPECT_EQ(verify::check_frame(WorldFrames(world).now().frame, 1).intersections, 0) << kind;
    EXPECT_TRUE(world.state(sheet).caught.empty()) << kind;
  }
}

TEST(CaughtCloth, IsHeldByFriction) {
  // Boxes that overlap by 4 mm lift a sheet that lies between them.
  World world;
  for (const double side : {1.0, -1.0}) {
    const double way = -side * 0.02;
    world.add_collider({"", OrientedBox{{0, 0, side * 0.038}, {0.1, 0.03, 0.02}}, 1.0,
                        RigidMotion({{.time = 0},
                                     {.time = 0.5, .translation = {0, 0, way}},
                                     {.time = 1, .translation = {0, 0, way}},
                                     {.time = 1.5, .translation = {0, 0.3, way}}})});
  }
  const ClothId sheet = hang(world);
  for (int frame = 1; frame <= 120; ++frame) {
    if (frame == 45) world.set_pins(sheet, {});
    ASSERT_TRUE(world.step(kFrame).ok);
  }
  double highest = -1;
  for (std::size_t i = 0; i < world.state(sheet).x.size(); ++i)
    highest = std::max(highest, world.state(sheet).position(i).y());
  EXPECT_GT(highest, 0.25) << "it was taken along by 0.3 m";
  EXPECT_LT(compute_yarn_strain(world.model(sheet), world.state(sheet)).max, 0.3);
}

TEST(CaughtCloth, ContinuesFromASnapshotForAnyNumberOfThreads) {
  std::uint64_t hash[2];
  for (const int threads : {1, 2}) {
    World world;
    world.set_jobs(make_jobs(threads));
    add_jaws("mesh", 0, world);
    const ClothId sheet = hang(world);
    for (int frame = 0; frame < 25; ++frame) world.step(kFrame);
    ASSERT_FALSE(world.state(sheet).caught.empty());
    const World::Snapshot middle = world.snapshot();
    for (int frame = 0; frame < 10; ++frame) world.step(kFrame);
    hash[threads - 1] = world.state_hash();
    world.restore(middle);
    for (int frame = 0; frame < 10; ++frame) world.step(kFrame);
    EXPECT_EQ(world.state_hash(), hash[threads - 1]);
  }
  EXPECT_EQ(hash[0], hash[1]);
}

TEST(CaughtCloth, IsForgottenByASnapshotFromBefore) {
  World world;
  add_jaws("sphere", 0, world);
  const ClothId sheet = hang(world);
  const World::Snapshot start = world.snapshot();
  world.step(kFrame);
  const std::uint64_t hash = world.state_hash();
  for (int frame = 1; frame < 25; ++frame) world.step(kFrame);
  ASSERT_FALSE(world.state(sheet).caught.empty());
  world.restore(start);
  world.step(kFrame);
  EXPECT_EQ(world.state_hash(), hash);
}

TEST(CaughtCloth, IsForgottenWithTheColliderThatHeldIt) {
  World world;
  add_jaws("sphere", 0, world);
  const ClothId sheet = hang(world);
  for (int frame = 0; frame < 25; ++frame) world.step(kFrame);
  ASSERT_FALSE(world.state(sheet).caught.empty());
  world.remove(world.collider(0));
  EXPECT_TRUE(world.state(sheet).caught.empty());
  EXPECT_TRUE(world.step(kFrame).ok);
}

TEST(CaughtCloth, IsNotClothThatWallsPushTogetherOnAFloor) {
  // The walls stand on the floor, or reach into it: between the two is no room, but cloth is beside the walls.
  for (const double below : {0.0, 0.05}) {
    for (const bool is_mesh : {false, true}) {
      SCOPED_TRACE(testing::Message() << (is_mesh ? "meshes" : "boxes") << " to " << below << " m below");
      World world;
      world.add_collider({"floor", OrientedBox{{0, -0.1, 0}, {0.6, 0.1, 0.6}}, 0.3, {}});
      for (const double side : {1.0, -1.0}) {
        const Vec3 center(side * 0.28, 0.1 - below, 0), half_size(0.02, 0.1, 0.4);
        ColliderShape wall = OrientedBox{center, half_size};
        if (is_mesh) wall = MeshShape{.mesh = shared(make_box_mesh(center, half_size, Mat3::Identity()))};
        world.add_collider(
            {"", wall, 0.3, RigidMotion({{.time = 0}, {.time = 1, .translation = {-side * 0.15, 0, 0}}})});
      }
      const auto topology = build_grid_topology(test::square(25, 0.5), SpringModel::alternating);
      std::vector<Vec3> positions;
      for (const Vec3& p : topology->mesh.positions)
        positions.emplace_back(p.x() - 0.25, 0.002, p.z() - 0.25);
      world.add_cloth({.name = "sheet",
                       .topology = topology,
                       .material = {.structural = 2000, .shear = 1000, .bend = 2, .damping = 0.05},
                       .positions = positions});
      for (int frame = 1; frame <= 60; ++frame) {
        ASSERT_TRUE(world.step(kFrame).infeasible.empty()) << frame;
        ASSERT_EQ(verify::check_frame(WorldFrames(world).now().frame, 1).penetration(), 0) << frame;
      }
    }
  }
}

TEST(CaughtCloth, PressedClothIsNotCaught) {
  // Jaws that leave exactly the room that the sheet needs.
  World world;
  for (const double side : {1.0, -1.0}) {
    world.add_collider({"", OrientedBox{{0, 0, side * 0.1}, {0.1, 0.1, 0.05}}, 0.4,
                        RigidMotion({{.time = 0}, {.time = 0.3, .translation = {0, 0, -side * 0.0495}}})});
  }
  const ClothId sheet = hang(world);
  for (int frame = 0; frame < 30; ++frame) {
    EXPECT_TRUE(world.step(kFrame).infeasible.empty()) << frame;
    EXPECT_TRUE(world.state(sheet).caught.empty()) << frame;
  }
}

}  // namespace
}  // namespace weft::engine
