/// Many worlds on one job system, and worlds on the program's threads.

#include <gtest/gtest.h>

#include <thread>

#include "weft/weft.h"

namespace weft {
namespace {

constexpr double kStep = 1.0 / 60;

/// A sheet that falls on a ball; the ball's position differs in each world.
World make_world(int n) {
  World world;
  world.add_collider({.shape = Sphere{.radius = 0.2}, .pose = {{0.1 * n, -0.25, 0.3}, {}}});
  world.add_cloth({.shape = Grid{.size_x = 0.6, .size_z = 0.6, .cells_x = 10, .cells_z = 10},
                   .fabric = Springs{.structural = 200, .shear = 80, .bend = 0.02}});
  return world;
}

std::vector<std::uint64_t> hashes_of(int threads, int steps) {
  WorldBatch batch(make_jobs(threads));
  for (int n = 0; n < 6; ++n) EXPECT_EQ(batch.add(make_world(n)), n);
  batch.add(batch[0].clone());
  for (int s = 0; s < steps; ++s) {
    for (const StepReport& report : batch.step(kStep)) EXPECT_TRUE(report.ok);
  }
  std::vector<std::uint64_t> hashes;
  for (int n = 0; n < batch.size(); ++n) hashes.push_back(batch[n].state_hash());
  return hashes;
}

TEST(WorldBatch, HasTheBitsOfItsWorldsForAnyNumberOfThreads) {
  constexpr int kSteps = 20;
  std::vector<std::uint64_t> expected;
  for (int n = 0; n < 6; ++n) {
    World world = make_world(n);
    for (int s = 0; s < kSteps; ++s) world.step(kStep);
    expected.push_back(world.state_hash());
  }
  expected.push_back(expected[0]);
  EXPECT_NE(expected[0], expected[1]);
  for (const int threads : {1, 2, 3}) EXPECT_EQ(hashes_of(threads, kSteps), expected) << threads;
}

TEST(WorldBatch, RefusesWhatCannotBe) {
  EXPECT_THROW(WorldBatch(nullptr), InputError);
  WorldBatch batch(make_serial_jobs());
  EXPECT_THROW(batch.step(0), InputError);
  EXPECT_TRUE(batch.step(kStep).empty());
}

TEST(WorldBatch, CallsAroundAStepSeeTheirWorld) {
  for (const int threads : {1, 3}) {
    WorldBatch batch(make_jobs(threads));
    for (int n = 0; n < 5; ++n) batch.add(make_world(n));
    std::vector<double> before(5, -1), after(5, -1);
    const BatchCalls calls{
        .before = [&](int n, World& world) { before[n] = world.time(); },
        .after = [&](int n, World& world,
                     const StepReport& report) { after[n] = report.ok ? world.time() : 0; }};
    batch.step(kStep, calls);
    EXPECT_EQ(before, std::vector<double>(5, 0));
    EXPECT_EQ(after, std::vector<double>(5, kStep));

    // The first error leaves when all worlds have had their turn.
    const BatchCalls failing{.before = [](int n, World&) {
      if (n == 1 || n == 3) throw InputError("world " + std::to_string(n));
    }};
    try {
      batch.step(kStep, failing);
      ADD_FAILURE() << "no error";
    } catch (const InputError& error) {
      EXPECT_STREQ(error.what(), "world 1");
    }
    for (const int n : {0, 2, 4}) EXPECT_EQ(batch[n].time(), 2 * kStep);
    for (const int n : {1, 3}) EXPECT_EQ(batch[n].time(), kStep);
  }
}

TEST(WorldBatch, ResetReturnsWorldsToTheirStartBitByBit) {
  WorldBatch batch(make_jobs(2));
  std::vector<std::uint64_t> start, end;
  for (int n = 0; n < 4; ++n) batch.add(make_world(n));
  for (int n = 0; n < 4; ++n) start.push_back(batch[n].state_hash());
  for (int s = 0; s < 15; ++s) batch.step(kStep);
  for (int n = 0; n < 4; ++n) end.push_back(batch[n].state_hash());
  const std::vector<int> some = {3, 1, 3};
  batch.reset(some);
  EXPECT_EQ(batch[1].state_hash(), start[1]);
  EXPECT_EQ(batch[3].state_hash(), start[3]);
  EXPECT_EQ(batch[0].state_hash(), end[0]);
  for (int s = 0; s < 15; ++s) batch.step(kStep);
  EXPECT_EQ(batch[1].state_hash(), end[1]);
  EXPECT_EQ(batch[3].state_hash(), end[3]);
  EXPECT_NE(batch[0].state_hash(), end[0]);

  const std::vector<int> wrong = {0, 4};
  EXPECT_THROW(batch.reset(wrong), InputError);
  batch[2].remove(batch[2].collider(0));
  const std::vector<int> changed = {2};
  EXPECT_THROW(batch.reset(changed), InputError);
}

/// The thread rules of world.h: different worlds concurrently, and const calls on one.
TEST(SameBitsThreads, WorldsRunBesideEachOther) {
  World original = make_world(1);
  World clone = original.clone();
  std::thread beside([&] {
    for (int s = 0; s < 10; ++s) clone.step(kStep);
  });
  for (int s = 0; s < 10; ++s) original.step(kStep);
  beside.join();
  EXPECT_EQ(clone.state_hash(), original.state_hash());

  const World& world = original;
  Energies here, there;
  std::thread reads([&] {
    there = world.energies();
    world.cast_ray({0.3, 5, 0.3}, {0, -1, 0});
    world.save();
  });
  here = world.energies();
  world.positions(world.cloth(0));
  const Snapshot snapshot = world.snapshot();
  reads.join();
  EXPECT_EQ(here.total(), there.total());
}

}  // namespace
}  // namespace weft
