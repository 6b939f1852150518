#pragma once
/// `weft bench collision`: time of finding close pairs, and of contact response.

#include <vector>

namespace weft::engine::lab {

struct CollisionBenchOptions {
  std::vector<int> sizes = {1000, 8192, 32768, 131072, 1000000};  // triangles, about
  std::vector<int> threads = {1, 2};
  int cells = 48;        // per side of the sheets for contact response
  double seconds = 0.5;  // per measurement, minimum [s]
};

/// Prints tables to standard output. Tree, uniform grid and brute force must find the same pairs for every
/// number of threads; returns false and prints an error otherwise.
bool bench_collision(const CollisionBenchOptions& options);

}  // namespace weft::engine::lab
