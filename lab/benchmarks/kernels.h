#pragma once
/// `weft bench kernels`: time of each kernel of `newton` on grids against the limits of the machine.

#include <vector>

namespace weft::engine::lab {

struct KernelBenchOptions {
  std::vector<int> sizes = {64, 128, 256};  // particles per side
  std::vector<int> threads = {1};
  double seconds = 0.3;  // per measurement
};

/// Prints for every kernel its nanoseconds per particle and three lower bounds: bytes moved, vector loads and
/// arithmetic. The counts are made by hand; the machine's rates are measured in the same run.
void bench_kernels(const KernelBenchOptions& options);

}  // namespace weft::engine::lab
