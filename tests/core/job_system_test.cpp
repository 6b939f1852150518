#include "weft/core/job_system.h"

#include <gtest/gtest.h>

#include <vector>

namespace weft::engine {
namespace {

TEST(ParallelFor, VisitsEveryIndexOnceForAnyNumberOfThreads) {
  for (const int threads : {1, 2, 3}) {
    const auto jobs = make_jobs(threads);
    for (const int count : {0, 1, 7, 64, 1000}) {
      std::vector<int> visits(static_cast<std::size_t>(count), 0);
      parallel_for(*jobs, count, 7, [&](int begin, int end) {
        for (int i = begin; i < end; ++i) ++visits[i];
      });
      EXPECT_EQ(visits, std::vector<int>(static_cast<std::size_t>(count), 1)) << threads << " threads";
    }
  }
}

TEST(ParallelFor, UsesTheCallersJobSystem) {
  struct Backwards : JobSystem {
    int calls = 0;
    int num_threads() const override { return 4; }
    void run(int num_jobs, const Job& job) override {
      ++calls;
      for (int i = num_jobs - 1; i >= 0; --i) job(i);
    }
  } jobs;
  int sum = 0;
  parallel_for(jobs, 10, 3, [&](int begin, int end) { sum += end - begin; });
  EXPECT_EQ(sum, 10);
  EXPECT_EQ(jobs.calls, 1);
}

}  // namespace
}  // namespace weft::engine
