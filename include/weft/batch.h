#pragma once
/// Many worlds, stepped in parallel: for data sets and reinforcement learning.
///
/// Each world is one job on one thread; its result is the same as when stepped by itself. Worlds share no
/// mutable state; a clone shares with its original the topology and material of cloth, which never change.

#include <functional>
#include <memory>
#include <span>
#include <vector>

#include "weft/export.h"
#include "weft/jobs.h"
#include "weft/report.h"
#include "weft/world.h"

namespace weft {

/// Calls around the step of each world, on the thread that steps it: to move pins before, to copy positions
/// after. Empty: none. Calls for different worlds run concurrently. The first exception leaves
/// WorldBatch::step() when every world has had its turn.
struct BatchCalls {
  std::function<void(int index, World& world)> before = {};
  std::function<void(int index, World& world, const StepReport& report)> after = {};
};

class WEFT_API WorldBatch {
 public:
  /// Throws InputError for a null job system.
  explicit WorldBatch(std::shared_ptr<JobSystem> jobs);

  /// Takes ownership of a world, which from now on steps on one thread; returns its index. Its present state
  /// is the start for reset().
  int add(World world);

  int size() const { return static_cast<int>(worlds_.size()); }
  World& operator[](int index) { return worlds_.at(static_cast<std::size_t>(index)); }
  const World& operator[](int index) const { return worlds_.at(static_cast<std::size_t>(index)); }

  /// Advances all worlds by dt > 0 [s]. Reports are indexed like the worlds.
  std::vector<StepReport> step(double dt, const BatchCalls& calls = {});

  /// Returns worlds to their start, bit by bit. Throws InputError for an index without a world, and for a
  /// world whose cloths or colliders have changed.
  void reset(std::span<const int> worlds);

 private:
  std::shared_ptr<JobSystem> jobs_;
  std::vector<World> worlds_;
  std::vector<Snapshot> starts_;  // (worlds)
};

}  // namespace weft
