#pragma once
/// Many worlds, stepped together: for data sets and reinforcement learning.
///
/// Each world is one job: it steps on one thread, and its result is the one it would have by itself. Worlds share
/// nothing that changes; a clone shares with its original the topology and material of cloth, which never change.

#include <memory>
#include <vector>

#include "weft/export.h"
#include "weft/jobs.h"
#include "weft/report.h"
#include "weft/world.h"

namespace weft {

class WEFT_API WorldBatch {
 public:
  /// Throws InputError without a job system.
  explicit WorldBatch(std::shared_ptr<JobSystem> jobs);

  /// Takes over a world, which steps on one thread from now on; returns its index.
  int add(World world);

  int size() const { return static_cast<int>(worlds_.size()); }
  World& operator[](int index) { return worlds_.at(static_cast<std::size_t>(index)); }
  const World& operator[](int index) const { return worlds_.at(static_cast<std::size_t>(index)); }

  /// Advances all worlds by dt > 0 [s]; reports by index.
  std::vector<StepReport> step(double dt);

 private:
  std::shared_ptr<JobSystem> jobs_;
  std::vector<World> worlds_;
};

}  // namespace weft
