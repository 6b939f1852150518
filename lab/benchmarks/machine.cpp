#include "lab/benchmarks/machine.h"

#include <algorithm>
#include <chrono>
#include <fstream>
#include <vector>

#ifdef __linux__
#include <unistd.h>
#endif

#include "weft/core/job_system.h"
#include "weft/core/pack.h"

namespace weft::engine::lab {
namespace {

WEFT_ALWAYS_INLINE void stream_body(float* x, int count) {
  WEFT_IVDEP
  for (int i = 0; i < count; ++i) x[i] = 0.5f * x[i] + 1.0f;
}

WEFT_MULTIVERSION(stream, (float* x, int count), (x, count))

constexpr int kLoaded = 2048;  // floats, in the first-level cache

/// The maximum in each lane, in four chains: as many loads as comparisons.
template <int W>
WEFT_ALWAYS_INLINE void load_many_body(const float* values, int rounds, float* sum) {
  for (int round = 0; round < rounds; ++round) {
    Pack<W> a = broadcast<W>(0), b = a, c = a, d = a;
    for (int i = 0; i < kLoaded; i += 8 * W) {
      a = larger(a, larger(load<W>(values + i), load<W>(values + i + W)));
      b = larger(b, larger(load<W>(values + i + 2 * W), load<W>(values + i + 3 * W)));
      c = larger(c, larger(load<W>(values + i + 4 * W), load<W>(values + i + 5 * W)));
      d = larger(d, larger(load<W>(values + i + 6 * W), load<W>(values + i + 7 * W)));
    }
    store(sum, larger(larger(a, b), larger(c, d)));
  }
}

WEFT_MULTIVERSION_PACKS(load_many, (const float* values, int rounds, float* sum), (values, rounds, sum))

constexpr int kChains = 10;  // of dependent operations

template <int W>
WEFT_ALWAYS_INLINE void compute_many_body(float* values, int rounds) {
  Pack<W> chain[kChains];
  for (int c = 0; c < kChains; ++c) chain[c] = load<W>(values + c * kPackLanes);
  const Pack<W> factor = broadcast<W>(0.999f), addend = broadcast<W>(0.001f);
  for (int round = 0; round < rounds; ++round) {
    for (int c = 0; c < kChains; ++c) chain[c] = chain[c] * factor + addend;
  }
  for (int c = 0; c < kChains; ++c) store(values + c * kPackLanes, chain[c]);
}

WEFT_MULTIVERSION_PACKS(compute_many, (float* values, int rounds), (values, rounds))

template <int W>
WEFT_ALWAYS_INLINE void divide_many_body(float* values, int rounds) {
  Pack<W> chain[kChains];
  for (int c = 0; c < kChains; ++c) chain[c] = load<W>(values + c * kPackLanes);
  for (int round = 0; round < rounds; ++round) {
    for (int c = 0; c < kChains; ++c) chain[c] = 1.0f / square_root(chain[c]);
  }
  for (int c = 0; c < kChains; ++c) store(values + c * kPackLanes, chain[c]);
}

WEFT_MULTIVERSION_PACKS(divide_many, (float* values, int rounds), (values, rounds))

int simd_lanes() {
  switch (simd_level()) {
    case SimdLevel::avx512:
      return 16;
    case SimdLevel::avx2:
      return 8;
    case SimdLevel::baseline:
      break;
  }
  return 4;
}

}  // namespace

double measure_loads() {
  constexpr int kRounds = 20'000;
  std::vector<float> values(kLoaded, 1.0f), sum(kPackLanes, 0.0f);
  double best = 0;
  for (int trial = 0; trial < 5; ++trial) {
    const double begin = seconds_now();
    load_many(values.data(), kRounds, sum.data());
    best = std::max(best, static_cast<double>(kLoaded) * kRounds / (seconds_now() - begin));
  }
  return best;
}

namespace {

/// Operations per second of a kernel with two operations per chain and round.
template <class Run>
double operations_per_second(const Run& run, int rounds) {
  std::vector<float> values(kChains * kPackLanes, 0.5f);
  double best = 0;
  for (int trial = 0; trial < 5; ++trial) {
    const double begin = seconds_now();
    run(values.data(), rounds);
    best = std::max(best, 2.0 * kChains * simd_lanes() * rounds / (seconds_now() - begin));
  }
  return best;
}

}  // namespace

double measure_arithmetic() { return operations_per_second(compute_many, 2'000'000); }

double measure_roots_and_divisions() { return operations_per_second(divide_many, 200'000); }

double seconds_now() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

double resident_bytes() {
#ifdef __linux__
  // In pages: program size, resident set size.
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
          : "r"(1ul));  // from a register: some processors add constants at no cost
    }
    best = std::max(best, static_cast<double>(x) / (seconds_now() - begin));
  }
  return best;
#else
  return 0;
#endif
}

}  // namespace weft::engine::lab
