#include "bench/machine.h"

#include <algorithm>
#include <chrono>
#include <fstream>
#include <vector>

#ifdef __linux__
#include <unistd.h>
#endif

#include "weft/core/job_system.h"
#include "weft/core/simd.h"

namespace weft::bench {
namespace {

WEFT_ALWAYS_INLINE void stream_body(float* x, int count) {
  WEFT_IVDEP
  for (int i = 0; i < count; ++i) x[i] = 0.5f * x[i] + 1.0f;
}

WEFT_MULTIVERSION(stream, (float* x, int count), (x, count))

}  // namespace

double seconds_now() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

double resident_bytes() {
#ifdef __linux__
  // In pages: the program's size, and what of it is in memory.
  std::ifstream statm("/proc/self/statm");
  double size = 0, resident = 0;
  statm >> size >> resident;
  return resident * static_cast<double>(sysconf(_SC_PAGESIZE));
#else
  return 0;
#endif
}

double measure_bandwidth(std::size_t bytes, int num_threads) {
  const int count = static_cast<int>(std::max<std::size_t>(bytes / sizeof(float), 1024));
  std::vector<float> values(static_cast<std::size_t>(count), 1.0f);
  const auto jobs = make_jobs(num_threads);
  const int grain = std::max(1024, (count + num_threads - 1) / num_threads);
  const int rounds = std::max(4, 20'000'000 / count);
  double best = 0;
  for (int trial = 0; trial < 5; ++trial) {
    const double begin = seconds_now();
    for (int round = 0; round < rounds; ++round) {
      parallel_for(*jobs, count, grain, [&](int b, int e) { stream(values.data() + b, e - b); });
    }
    best = std::max(best, 2.0 * sizeof(float) * count * rounds / (seconds_now() - begin));
  }
  return best;
}

double measure_clock() {
#if defined(__x86_64__) && defined(__GNUC__)
  constexpr long kAdditions = 100'000'000;
  double best = 0;
  for (int trial = 0; trial < 3; ++trial) {
    const double begin = seconds_now();
    unsigned long x = 0;
    for (long i = 0; i < kAdditions / 8; ++i) {
      asm volatile(
          "add %1, %0\n add %1, %0\n add %1, %0\n add %1, %0\n"
          "add %1, %0\n add %1, %0\n add %1, %0\n add %1, %0\n"
          : "+r"(x)
          : "r"(1ul));  // from a register: some processors add constants for nothing
    }
    best = std::max(best, static_cast<double>(x) / (seconds_now() - begin));
  }
  return best;
#else
  return 0;
#endif
}

}  // namespace weft::bench
