#include "weft/batch.h"

#include <algorithm>
#include <cmath>
#include <exception>
#include <string>

namespace weft {
namespace {

/// Runs all jobs, then throws the first error in the order of their indices.
template <class Call>
void run_all(JobSystem& jobs, int count, const Call& call) {
  std::vector<std::exception_ptr> errors(static_cast<std::size_t>(count));
  jobs.run(count, [&](int n) {
    try {
      call(n);
    } catch (...) {
      errors[n] = std::current_exception();
    }
  });
  for (const std::exception_ptr& error : errors) {
    if (error) std::rethrow_exception(error);
  }
}

}  // namespace

WorldBatch::WorldBatch(std::shared_ptr<JobSystem> jobs) : jobs_(std::move(jobs)) {
  if (!jobs_) throw InputError("a batch requires a job system; make_serial_jobs() makes one without threads");
}

int WorldBatch::add(World world) {
  world.set_jobs(make_serial_jobs());
  starts_.push_back(world.snapshot());
  worlds_.push_back(std::move(world));
  return size() - 1;
}

std::vector<StepReport> WorldBatch::step(double dt, const BatchCalls& calls) {
  if (!std::isfinite(dt) || dt <= 0)
    throw InputError("the time step must be a finite number of seconds above 0");
  std::vector<StepReport> reports(worlds_.size());
  run_all(*jobs_, size(), [&](int w) {
    if (calls.before) calls.before(w, worlds_[w]);
    reports[w] = worlds_[w].step(dt);
    if (calls.after) calls.after(w, worlds_[w], reports[w]);
  });
  return reports;
}

void WorldBatch::reset(std::span<const int> worlds) {
  std::vector<int> chosen(worlds.begin(), worlds.end());
  std::ranges::sort(chosen);
  chosen.erase(std::unique(chosen.begin(), chosen.end()), chosen.end());
  for (const int w : chosen) {
    if (w < 0 || w >= size())
      throw InputError("there is no world " + std::to_string(w) + " in a batch of " + std::to_string(size()));
  }
  run_all(*jobs_, static_cast<int>(chosen.size()),
          [&](int n) { worlds_[chosen[n]].restore(starts_[chosen[n]]); });
}

}  // namespace weft
