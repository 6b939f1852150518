#pragma once
/// Many worlds, stepped in parallel: for data sets and reinforcement learning.
///
/// Each world is one job on one thread; its result is the same as when stepped by itself. Worlds share no
/// mutable state; a clone shares with its original the topology and material of cloth, which never change.

#include <memory>
#include <vector>

#include "weft/export.h"
#include "weft/jobs.h"
#include "weft/report.h"
#include "weft/world.h"

namespace weft {

class WEFT_API WorldBatch {
 public:
  /// Throws InputError for a null job system.
  explicit WorldBatch(std::shared_ptr<JobSystem> jobs);

  /// Takes ownership of a world, which from now on steps on one thread; returns its index.
  int add(World world);

  int size() const { return static_cast<int>(worlds_.size()); }
  World& operator[](int index) { return worlds_.at(static_cast<std::size_t>(index)); }
  const World& operator[](int index) const { return worlds_.at(static_cast<std::size_t>(index)); }

  /// Advances all worlds by dt > 0 [s]. Reports are indexed like the worlds.
  std::vector<StepReport> step(double dt);

 private:
  std::shared_ptr<JobSystem> jobs_;
  std::vector<World> worlds_;
};

}  // namespace weft
