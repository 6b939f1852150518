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
