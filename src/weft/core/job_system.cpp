#include "weft/core/job_system.h"

#if WEFT_PLAIN_THREADS
#include <thread>
#include <vector>
#elif WEFT_WITH_TBB
#include <tbb/global_control.h>
#include <tbb/info.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <optional>
#endif

namespace weft::engine {
namespace {

class SerialJobs final : public JobSystem {
 public:
  int num_threads() const override { return 1; }
  void run(int num_jobs, const Job& job) override {
    for (int i = 0; i < num_jobs; ++i) job(i);
  }
};

#if WEFT_PLAIN_THREADS
/// Threads for the thread sanitizer, which does not see oneTBB's synchronisation. Each thread runs every
/// num_threads-th job, synchronised only at start and end: neighbouring jobs that access the same memory are
/// detected independently of timing.
class PlainThreads final : public JobSystem {
 public:
  explicit PlainThreads(int num_threads) : num_threads_(num_threads) {}

  int num_threads() const override { return num_threads_; }

  void run(int num_jobs, const Job& job) override {
    const auto share = [&](int first) {
      for (int i = first; i < num_jobs; i += num_threads_) job(i);
    };
    std::vector<std::thread> others;
    for (int t = 1; t < num_threads_; ++t) others.emplace_back(share, t);
    share(0);
    for (std::thread& other : others) other.join();
  }

 private:
  int num_threads_;
};
#elif WEFT_WITH_TBB
class TbbJobs final : public JobSystem {
 public:
  explicit TbbJobs(int num_threads) : num_threads_(num_threads), arena_(num_threads) {
    if (num_threads > tbb::info::default_concurrency())
      more_than_processors_.emplace(tbb::global_control::max_allowed_parallelism, num_threads);
  }

  int num_threads() const override { return num_threads_; }

  void run(int num_jobs, const Job& job) override {
    arena_.execute([&] { tbb::parallel_for(0, num_jobs, job, tbb::static_partitioner{}); });
  }

 private:
  int num_threads_;
  std::optional<tbb::global_control> more_than_processors_;  // else oneTBB ignores them, with a warning
  tbb::task_arena arena_;
};
#endif

}  // namespace

}  // namespace weft::engine

namespace weft {

std::unique_ptr<JobSystem> make_serial_jobs() { return std::make_unique<engine::SerialJobs>(); }

std::unique_ptr<JobSystem> make_jobs(int num_threads) {
#if WEFT_PLAIN_THREADS
  if (num_threads > 1) return std::make_unique<engine::PlainThreads>(num_threads);
#elif WEFT_WITH_TBB
  if (num_threads > 1) return std::make_unique<engine::TbbJobs>(num_threads);
#endif
  (void)num_threads;
  return make_serial_jobs();
}

}  // namespace weft
