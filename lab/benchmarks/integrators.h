#pragma once
/// `weft bench integrators`: time of a step for each integrator and size.

#include <string>
#include <vector>

namespace weft::engine::lab {

struct IntegratorBenchOptions {
  std::vector<std::string> integrators;              // empty: all
  std::vector<int> sizes = {32, 64, 128, 256, 512};  // particles per side
  std::vector<int> threads = {1, 2};
  std::string model = "simplified";  // of springs; "mesh": the same cloth as a triangle mesh
  double seconds = 0.5;              // per measurement, minimum [s]
};

/// Prints a table to standard output. Throws InputError for names that do not exist.
void bench_integrators(const IntegratorBenchOptions& options);

}  // namespace weft::engine::lab
