#pragma once
/// `weft bench collision`: what it costs to find close pairs, and to hold them apart.

#include <vector>

namespace weft::engine::lab {

struct CollisionBenchOptions {
  std::vector<int> sizes = {1000, 8192, 32768, 131072, 1000000};  // triangles, about
  std::vector<int> threads = {1, 2};
  int cells = 48;        // per side of the sheets that are held apart
  double seconds = 0.5;  // per measurement, at least [s]
};

/// Prints tables to standard output. Tree, uniform grid and brute force must find the same pairs, whatever
/// the number of threads: returns false, and says so, if they do not.
bool bench_collision(const CollisionBenchOptions& options);

}  // namespace weft::engine::lab
