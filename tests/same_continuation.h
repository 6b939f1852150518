#pragma once
/// Snapshots and saved worlds: what of a world determines its next steps.

#include <gtest/gtest.h>

#include <functional>

#include "weft/world.h"

namespace weft {

/// From its present state the world, a saved and loaded copy, and the world restored after these steps and `change` take
/// `steps` steps to the same bits. The world ends there.
inline void expect_same_continuation(
    World& world, int steps, double step, const std::function<void()>& change = [] {}) {
  const Snapshot snapshot = world.snapshot();
  World loaded = World::load(world.save());
  const auto advance = [&](World& which) {
    for (int s = 0; s < steps; ++s) ASSERT_TRUE(which.step(step).ok);
  };
  advance(world);
  const std::uint64_t hash = world.state_hash();
  advance(loaded);
  EXPECT_EQ(loaded.state_hash(), hash);
  change();
  world.restore(snapshot);
  advance(world);
  EXPECT_EQ(world.state_hash(), hash);
}

}  // namespace weft
