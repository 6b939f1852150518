#pragma once
/// `weft bench kernels`: how far each kernel of `newton` on grids runs from what the machine allows.

#include <vector>

namespace weft::engine::lab {

struct KernelBenchOptions {
  std::vector<int> sizes = {64, 128, 256};  // particles per side
  std::vector<int> threads = {1};
  double seconds = 0.3;  // per measurement
};

/// Prints for every kernel its nanoseconds per particle and three bounds: the bytes that it must move, its
/// vector loads and its arithmetic, counted by hand, over what the machine was measured to do in the same
/// run.
void bench_kernels(const KernelBenchOptions& options);

}  // namespace weft::engine::lab
