/// Step division.

#include <gtest/gtest.h>

#include "tests/support.h"
#include "weft/error.h"
#include "weft/mesh/sample_meshes.h"
#include "weft/world/measures.h"
#include "weft/world/world.h"

namespace weft::engine {
namespace {

constexpr double kFrame = 1.0 / 60;

/// A tilted sheet of stiff springs above a floor: its lowest corner hits first.
World make_landing(const StepDivision& division = {}) {
  World world;
  world.set_division(division);
  const auto topology = build_grid_topology(test::square(20), SpringModel::alternating);
  std::vector<Vec3> positions;
  const Mat3 turn = rotation_from_angles_deg({20, 0, 15});
  for (const Vec3& p : topology->mesh.positions) positions.push_back(turn * p + Vec3(0, 1.2, 0));
  world.add_cloth({.name = "sheet",
                   .topology = topology,
                   .material = {.structural = 2000, .shear = 1000, .bend = 20, .damping = 0.002},
                   .positions = positions});
  world.add_collider({"floor", Plane{}, 0.4, {}});
  return world;
}

struct Landing {
  double rise = 0;  // largest rise of energy in a frame, over the total fall [1]
  double strain = 0;
  int divisions = 0, retries = 0;
};

Landing land(const StepDivision& division) {
  World world = make_landing(division);
  Landing landing;
  const double start = test::energy_of(world);
  double before = start, most = 0;
  for (int frame = 0; frame < 60; ++frame) {
    const StepReport report = world.step(kFrame);
    EXPECT_TRUE(report.ok);
    landing.divisions += report.divisions;
    landing.retries += report.retries;
    const double now = test::energy_of(world);
    most = std::max(most, now - before);
    before = now;
    landing.strain = std::max(landing.strain,
                              compute_strain(world.model(world.cloth(0)), world.state(world.cloth(0))).max);
  }
  landing.rise = most / (start - before);
  return landing;
}

TEST(StepDivision, ALandingMakesNoEnergyAndStretchesLittle) {
  const Landing whole = land({.enabled = false}), divided = land({});
  EXPECT_GT(whole.rise, 0.1) << "or the test shows nothing";
  EXPECT_LT(divided.rise, 0.01);
  EXPECT_LT(divided.strain, 0.5 * whole.strain);
  EXPECT_GT(divided.retries, 0);
  EXPECT_LT(divided.divisions, 8 * 60) << "only where it must";
}

TEST(StepDivision, WhatIsNotDividedHasTheSameBits) {
  World with = make_landing(), without = make_landing({.enabled = false});
  for (int frame = 0; frame < 20; ++frame) {
    EXPECT_EQ(with.step(kFrame).divisions, 1);
    without.step(kFrame);
  }
  EXPECT_EQ(with.state_hash(), without.state_hash());
}

/// A landing up to just before its first divided step.
World make_before_impact(int& frames, const StepDivision& division = {}) {
  World world = make_landing(division);
  World::Snapshot before;
  for (frames = 0; frames < 60; ++frames) {
    before = world.snapshot();
    if (world.step(kFrame).divisions > 1) break;
  }
  world.restore(before);
  return world;
}

TEST(StepDivision, ADividedStepIsThatOfShorterSteps) {
  // The attempt has no effect: manual steps of the final length are bit-identical.
  int frames = 0;
  World world = make_before_impact(frames, {.shortest = kFrame / 2});
  ASSERT_LT(frames, 60);
  World by_hand = make_landing({.enabled = false});
  by_hand.restore(world.snapshot());
  const StepReport report = world.step(kFrame);
  ASSERT_GT(report.retries, 0);
  ASSERT_EQ(report.divisions, 2);
  for (int part = 0; part < report.divisions; ++part) by_hand.step(kFrame / report.divisions);
  for (std::size_t i = 0; i < world.state(world.cloth(0)).x.size(); ++i) {
    ASSERT_EQ(world.state(world.cloth(0)).x.get(i), by_hand.state(by_hand.cloth(0)).x.get(i)) << i;
    ASSERT_EQ(world.state(world.cloth(0)).v.get(i), by_hand.state(by_hand.cloth(0)).v.get(i)) << i;
  }
}

TEST(StepDivision, ASnapshotHoldsTheDivisionInForce) {
  int frames = 0;
  World world = make_before_impact(frames);
  world.step(kFrame);
  const World::Snapshot divided = world.snapshot();
  EXPECT_GT(divided.part, 0);
  World other = make_landing();
  for (int frame = 0; frame < 3; ++frame) other.step(kFrame);
  other.restore(divided);
  for (int frame = 0; frame < 5; ++frame) {
    EXPECT_EQ(world.step(kFrame).divisions, other.step(kFrame).divisions);
    EXPECT_EQ(world.state_hash(), other.state_hash());
  }
}

TEST(StepDivision, HasTheSameBitsForAnyNumberOfThreads) {
  World one = make_landing(), three = make_landing();
  three.set_jobs(make_jobs(3));
  int divisions = 0;
  for (int frame = 0; frame < 36; ++frame) {
    divisions += one.step(kFrame).divisions;
    three.step(kFrame);
  }
  EXPECT_GT(divisions, 36);
  EXPECT_EQ(one.state_hash(), three.state_hash());
}

TEST(StepDivision, SaysWhenTheShortestPartIsTooLong) {
  World world = make_landing({.shortest = kFrame / 2});
  World::Snapshot fast = world.snapshot();
  for (std::size_t i = 0; i < fast.states[0].v.size(); ++i) fast.states[0].v.set(i, {0, -40, 0});
  world.restore(fast);
  bool is_reported = false;
  for (int frame = 0; frame < 10; ++frame) {
    const StepReport report = world.step(kFrame);
    EXPECT_LE(report.divisions, 2);
    for (const StepWarning& w : report.warnings) is_reported |= w.code == WarningCode::cap_reached;
  }
  EXPECT_TRUE(is_reported);
}

TEST(StepDivision, JoinsAgainWhenCalm) {
  World world = make_landing();
  int divided = 0, last = 0;
  for (int frame = 0; frame < 240; ++frame) {
    last = world.step(kFrame).divisions;
    divided += last > 1;
  }
  EXPECT_GT(divided, 0);
  EXPECT_EQ(last, 1);
}

TEST(StepDivision, ClothAtRestIsNotDivided) {
  // Stiff cloth in a heap: contacts settle within a share of their gaps, and the springs store that.
  for (int seed = 1; seed <= 4; ++seed) {
    World world;
    const auto topology = build_mesh_topology(build_random_mesh(test::square(14, 0.5), seed));
    std::vector<Vec3> positions;
    const Mat3 turn = rotation_from_angles_deg({80, 0, 15});
    for (const Vec3& p : topology->mesh.positions) positions.push_back(turn * p + Vec3(0, 0.55, 0));
    const ClothMaterial stiff{
        .density = 0.12, .structural = 4e4, .bend = 0.2, .damping = 1e-3, .thickness = 4e-4};
    world.add_cloth({.name = "sheet", .topology = topology, .material = stiff, .positions = positions});
    world.add_collider({"floor", Plane{}, 0.4, {}});
    int divided = 0;
    for (int frame = 0; frame < 240; ++frame) {
      const bool is_divided = world.step(kFrame).divisions > 1;
      if (frame >= 180) divided += is_divided;
    }
    EXPECT_LT(divided, 10) << seed;
  }
}

TEST(StepDivision, RefusesWhatCannotBe) {
  World world;
  EXPECT_THROW(world.set_division({.shortest = 0}), InputError);
  world.set_integrator({.integrator = "paper"});
  EXPECT_NO_THROW(world.set_division({}));
  EXPECT_THROW(world.set_division({.enabled = true}), InputError);
  world.set_integrator({.integrator = "implicit_euler"});
  EXPECT_NO_THROW(world.set_division({.enabled = true}));
}

}  // namespace
}  // namespace weft::engine
