/// Run-time control between two steps: kinematic colliders, removal of bodies, cloned worlds.

#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <type_traits>

#include "tests/support.h"
#include "weft/animation/mesh_sequence.h"
#include "weft/core/job_system.h"
#include "weft/mesh/triangle_mesh.h"
#include "weft/world/measures.h"
#include "weft/world/world.h"

namespace weft::engine {
namespace {

using test::square;

constexpr double kStep = 1.0 / 64;  // exact in binary, so that times are exact
const ClothMaterial kSoft{.density = 0.2, .structural = 200, .shear = 80, .bend = 0.02, .friction = 0.3};

static_assert(std::is_nothrow_move_constructible_v<World> && std::is_move_assignable_v<World>);
static_assert(!std::is_copy_constructible_v<World> && !std::is_copy_assignable_v<World>);

/// A sheet hung by two corners, upright, in the plane x = 0, centred at the origin.
ClothId hang_sheet(World& world) {
  const Grid grid = square(16, 0.6);
  std::vector<Vec3> positions;
  const auto topology = build_grid_topology(grid, SpringModel::alternating);
  for (const Vec3& p : topology->mesh.positions) positions.emplace_back(0, 0.3 - p.x(), p.z() - 0.3);
  const ClothId sheet =
      world.add_cloth({.name = "sheet", .topology = topology, .material = kSoft, .positions = positions});
  world.set_pins(sheet, {{.particles = {grid.index(0, 0), grid.index(0, 16)}}});
  return sheet;
}

double mean_x(const World& world, ClothId cloth) {
  return compute_center_of_mass(world.model(cloth), world.state(cloth)).x();
}

/// Displacement of the ball of 0.15 m that pushes the sheet [m].
double way(double time) { return 3 * time; }

TEST(ByHand, ACollidersPosePerFrameIsTheSameAsKeyFrames) {
  std::vector<KeyFrame> keys;
  for (int k = 0; k <= 40; ++k)
    keys.push_back({.time = k * kStep, .translation = Vec3(way(k * kStep), 0, 0)});
  World by_keys, by_hand;
  hang_sheet(by_keys);
  const ClothId sheet = hang_sheet(by_hand);
  const Sphere ball{Vec3(-0.25, 0, 0), 0.15};
  by_keys.add_collider({.name = "ball", .shape = ball, .motion = RigidMotion(keys)});
  const ColliderId hand = by_hand.add_collider({.name = "ball", .shape = ball});
  int parts = 0;
  double farthest = 0;
  for (int k = 1; k <= 40; ++k) {
    by_hand.move_collider(hand, {.translation = Vec3(way(k * kStep), 0, 0)});
    parts += by_hand.step(kStep).divisions;
    farthest = std::max(farthest, mean_x(by_hand, sheet));
    ASSERT_TRUE(by_keys.step(kStep).ok);
    ASSERT_EQ(by_hand.state_hash(), by_keys.state_hash()) << k;
  }
  EXPECT_GT(farthest, 0.05) << "the ball pushes";
  EXPECT_GT(parts, 40) << "through parts of steps, too";
}

TEST(ByHand, AMeshsVerticesPerFrameAreTheSameAsASequence) {
  const TriangleMesh box = make_box_mesh(Vec3(-0.25, 0, 0), Vec3(0.1, 0.1, 0.1), Mat3::Identity());
  const auto mesh = std::make_shared<const TriangleMesh>(box);
  const auto bent = [&](double time) {
    std::vector<Vec3> positions = box.positions;
    for (Vec3& p : positions) p.x() += way(time) * (1 + 0.5 * p.y());
    return positions;
  };
  std::vector<MeshSequence::Key> keys;
  for (int k = 0; k <= 32; ++k) keys.push_back({k * kStep, bent(k * kStep)});
  World by_keys, by_hand;
  hang_sheet(by_keys);
  const ClothId sheet = hang_sheet(by_hand);
  by_keys.add_collider(
      {.name = "box",
       .shape = MeshShape{.mesh = mesh, .source = std::make_shared<const MeshSequence>(keys)}});
  const ColliderId hand = by_hand.add_collider({.name = "box", .shape = MeshShape{.mesh = mesh}});
  for (int k = 1; k <= 32; ++k) {
    by_hand.move_vertices(hand, bent(k * kStep));
    ASSERT_TRUE(by_hand.step(kStep).ok);
    ASSERT_TRUE(by_keys.step(kStep).ok);
    ASSERT_EQ(by_hand.state_hash(), by_keys.state_hash()) << k;
  }
  EXPECT_GT(mean_x(by_hand, sheet), 0.05) << "the box pushes";
}

TEST(ByHand, WhatIsNotToldAgainStandsStill) {
  World world;
  hang_sheet(world);
  const ColliderId ball = world.add_collider({.shape = Sphere{Vec3(2, 0, 0), 0.1}});
  world.move_collider(ball,
                      {.translation = Vec3(0.25, 0, 0), .rotation = rotation_from_angles_deg({0, 40, 0})});
  ASSERT_TRUE(world.step(kStep).ok);
  const Pose there = world.pose(ball);
  EXPECT_EQ(there.translation, Vec3(0.25, 0, 0));
  EXPECT_EQ(there.rotation, rotation_from_angles_deg({0, 40, 0}));
  for (int n = 0; n < 3; ++n) ASSERT_TRUE(world.step(kStep).ok);
  EXPECT_EQ(world.pose(ball).translation, there.translation);
  EXPECT_EQ(world.pose(ball).rotation, there.rotation);
  EXPECT_FALSE(world.is_driven());
}

TEST(ByHand, APlacedColliderDoesNotSweep) {
  // Through the sheet from one side to the other: once placed, once moved within a step.
  World placed, moved;
  const ClothId sheet = hang_sheet(placed);
  hang_sheet(moved);
  const Sphere ball{Vec3(-0.3, 0, 0), 0.15};
  const ColliderId a = placed.add_collider({.name = "ball", .shape = ball}),
                   b = moved.add_collider({.name = "ball", .shape = ball});
  for (World* world : {&placed, &moved}) ASSERT_TRUE(world->step(kStep).ok);
  placed.place_collider(a, {.translation = Vec3(0.6, 0, 0)});
  moved.move_collider(b, {.translation = Vec3(0.6, 0, 0)});
  for (World* world : {&placed, &moved}) ASSERT_TRUE(world->step(kStep).ok);
  EXPECT_LT(std::abs(mean_x(placed, sheet)), 1e-3);
  EXPECT_GT(mean_x(moved, moved.cloth(0)), 0.09);
}

TEST(ByHand, ATeleportedClothKeepsItsMotion) {
  World world, still;
  const ClothId sheet = hang_sheet(world);
  hang_sheet(still);
  world.set_gravity(Vec3::Zero());
  still.set_gravity(Vec3::Zero());
  for (World* w : {&world, &still}) {
    w->set_pins(w->cloth(0), {});
    std::vector<Vec3> velocities;
    for (int i = 0; i < w->model(w->cloth(0)).num_particles(); ++i)
      velocities.emplace_back(0.1 * std::sin(i), 0.3, 0.2);
    w->set_velocities(w->cloth(0), velocities);
    // A plate on the way, which must not sweep it.
    w->add_collider({.shape = OrientedBox{Vec3(5, 0, 0), Vec3(0.05, 2, 2), Mat3::Identity()}});
    for (int n = 0; n < 4; ++n) ASSERT_TRUE(w->step(kStep).ok);
  }
  const Mat3 turn = rotation_from_angles_deg({0, 90, 0});
  const Vec3 before = compute_momentum(world.model(sheet), world.state(sheet));
  world.teleport(sheet, {.translation = Vec3(10, 0, 0), .rotation = turn});
  EXPECT_LT((compute_momentum(world.model(sheet), world.state(sheet)) - turn * before).norm(),
            1e-6 * before.norm());
  for (int n = 0; n < 16; ++n) {
    ASSERT_TRUE(world.step(kStep).ok);
    ASSERT_TRUE(still.step(kStep).ok);
  }
  const Vec3 here = compute_center_of_mass(still.model(still.cloth(0)), still.state(still.cloth(0)));
  const Vec3 there = compute_center_of_mass(world.model(sheet), world.state(sheet));
  EXPECT_LT((there - (turn * here + Vec3(10, 0, 0))).norm(), 1e-4);
}

TEST(ByHand, PinsHoldWhereTheirParticlesArePut) {
  World world;
  const ClothId sheet = hang_sheet(world);
  ASSERT_TRUE(world.step(kStep).ok);
  world.teleport(sheet, {.translation = Vec3(0, 3, 0)});
  const Vec3 corner = world.state(sheet).position(0);
  EXPECT_NEAR(corner.y(), 3.3, 1e-6);
  for (int n = 0; n < 8; ++n) ASSERT_TRUE(world.step(kStep).ok);
  EXPECT_LT((world.state(sheet).position(0) - corner).norm(), 1e-6);
}

/// Checks free fall: no force except gravity.
void expect_free_fall(World& world, ClothId cloth) {
  const Vec3 before = compute_momentum(world.model(cloth), world.state(cloth));
  constexpr int kSteps = 6;
  for (int n = 0; n < kSteps; ++n) ASSERT_TRUE(world.step(kStep).ok);
  double mass = 0;
  for (const double m : world.model(cloth).mass) mass += m;
  const Vec3 gained = compute_momentum(world.model(cloth), world.state(cloth)) - before;
  EXPECT_LT((gained - mass * kSteps * kStep * world.gravity()).norm(), 1e-3 * mass);
}

ClothId lay_sheet(World& world, const std::string& name, double height) {
  const auto topology = build_grid_topology(square(12, 0.4), SpringModel::alternating);
  std::vector<Vec3> positions = topology->mesh.positions;
  for (Vec3& p : positions) p += Vec3(-0.2, height, -0.2);
  return world.add_cloth({.name = name, .topology = topology, .material = kSoft, .positions = positions});
}

TEST(Removal, OfWhatClothLiesOnLeavesNoGhost) {
  World world;
  world.track_contacts(true);
  const ColliderId other = world.add_collider({.name = "other", .shape = Sphere{Vec3(3, 0, 0), 0.2}});
  const ColliderId ball = world.add_collider({.name = "ball", .shape = Sphere{Vec3(0, -0.2, 0), 0.2}});
  const ColliderId box =
      world.add_collider({.name = "box",
                          .shape = MeshShape{.mesh = std::make_shared<const TriangleMesh>(make_box_mesh(
                                                 Vec3(0, -0.6, 0), Vec3(1, 0.1, 1), Mat3::Identity()))}});
  const ClothId upper = lay_sheet(world, "upper", 0.02), lower = lay_sheet(world, "lower", 0.01);
  for (int n = 0; n < 12; ++n) ASSERT_TRUE(world.step(kStep).ok);
  ASSERT_FALSE(world.contact_points().empty());
  world.remove(lower);
  for (int n = 0; n < 8; ++n) ASSERT_TRUE(world.step(kStep).ok);
  ASSERT_FALSE(world.contact_points().empty()) << "the ball still holds the upper one";
  world.remove(ball);
  EXPECT_TRUE(world.contains(other));
  EXPECT_EQ(world.collider(box).name, "box");
  EXPECT_EQ(world.num_colliders(), 2);
  expect_free_fall(world, upper);
  for (int n = 0; n < 60; ++n) ASSERT_TRUE(world.step(kStep).ok);
  EXPECT_GT(compute_lowest_y(world.state(upper)), -0.51) << "what was added later still holds";
}

TEST(Removal, KeepsRulesWithThoseTheyAreOf) {
  World world;
  const ColliderId first = world.add_collider({.name = "first", .shape = Sphere{Vec3(3, 0, 0), 0.2}});
  world.add_collider({.name = "floor", .shape = Plane{Vec3(0, -0.05, 0), Vec3::UnitY()}});
  const ClothId gone = lay_sheet(world, "gone", 1);
  const ClothId passing = lay_sheet(world, "passing", 0), held = lay_sheet(world, "held", 0.5);
  world.set_collision("passing", "floor", false);
  world.set_collision("gone", "floor", false);
  world.remove(gone);
  world.remove(first);
  EXPECT_EQ(world.non_colliding_pairs(), (std::vector<std::array<std::string, 2>>{{"passing", "floor"}}));
  for (int n = 0; n < 64; ++n) ASSERT_TRUE(world.step(kStep).ok);
  EXPECT_LT(compute_lowest_y(world.state(passing)), -1);
  EXPECT_GT(compute_lowest_y(world.state(held)), -0.06);
}

/// In contact with a kinematic ball, half on its way.
World make_busy_world() {
  World world;
  hang_sheet(world);
  lay_sheet(world, "flat", 0.7);
  const ColliderId ball = world.add_collider({.name = "ball", .shape = Sphere{Vec3(-0.25, 0, 0), 0.15}});
  for (int k = 1; k <= 20; ++k) {
    world.move_collider(ball, {.translation = Vec3(way(k * kStep), 0, 0)});
    EXPECT_TRUE(world.step(kStep).ok);
  }
  world.move_collider(ball, {.translation = Vec3(way(21 * kStep), 0, 0)});
  return world;
}

std::uint64_t hash_after(World& world, int steps) {
  for (int n = 0; n < steps; ++n) EXPECT_TRUE(world.step(kStep).ok);
  return world.state_hash();
}

TEST(Worlds, CloneAndMoveGoOnWithTheSameBits) {
  World world = make_busy_world();
  World clone = world.clone();
  const ColliderId ball = world.collider(0);
  EXPECT_TRUE(clone.contains(ball)) << "ids hold for the clone";
  clone.set_jobs(make_jobs(2));
  const std::uint64_t expected = hash_after(world, 12);
  EXPECT_EQ(hash_after(clone, 12), expected);

  World other = make_busy_world();
  const World::Snapshot snapshot = other.snapshot();
  World moved = std::move(other);
  EXPECT_EQ(hash_after(moved, 12), expected);
  moved.restore(snapshot);
  EXPECT_EQ(hash_after(moved, 12), expected) << "with what was told to the ball";
  other = std::move(moved);
  other.restore(snapshot);
  EXPECT_EQ(hash_after(other, 12), expected);
}

TEST(Worlds, CloneSharesNoState) {
  World world = make_busy_world();
  World clone = world.clone();
  const std::uint64_t before = world.state_hash();
  clone.place_collider(clone.collider(0), {.translation = Vec3(0, 5, 0)});
  clone.set_gravity(Vec3::Zero());
  clone.remove(clone.cloth(1));
  hash_after(clone, 4);
  EXPECT_EQ(world.state_hash(), before);
  EXPECT_EQ(world.num_cloths(), 2);
  EXPECT_NE(world.pose(world.collider(0)).translation.y(), 5);
  World again = make_busy_world();
  EXPECT_EQ(hash_after(world, 8), hash_after(again, 8));
}

}  // namespace
}  // namespace weft::engine
