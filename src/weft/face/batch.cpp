#include "weft/batch.h"

#include <cmath>

namespace weft {

WorldBatch::WorldBatch(std::shared_ptr<JobSystem> jobs) : jobs_(std::move(jobs)) {
  if (!jobs_) throw InputError("a batch requires a job system; make_serial_jobs() makes one without threads");
}

int WorldBatch::add(World world) {
  world.set_jobs(make_serial_jobs());
  worlds_.push_back(std::move(world));
  return size() - 1;
}

std::vector<StepReport> WorldBatch::step(double dt) {
  if (!std::isfinite(dt) || dt <= 0)
    throw InputError("the time step must be a finite number of seconds above 0");
  std::vector<StepReport> reports(worlds_.size());
  jobs_->run(size(), [&](int w) { reports[w] = worlds_[w].step(dt); });
  return reports;
}

}  // namespace weft
