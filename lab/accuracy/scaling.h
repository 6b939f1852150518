#pragma once
/// `weft bench scaling`: how the cost of `newton` grows with the cloth, at the same accuracy.

#include <string>
#include <vector>

namespace weft::engine::lab {

struct ScalingBenchOptions {
  std::vector<int> sizes = {32, 64, 128, 256, 512, 1024};  // particles per side
  std::vector<int> threads = {1, 2};
  std::string model = "simplified";  // of springs; "mesh": the same cloth as a triangle mesh
  /// Of conjugate gradients. 10 make the same error at 64², 128² and 256² (`weft bench frontier`) [1].
  int iterations = 10;
  int steps = 10;       // per measurement
  bool motion = false;  // tells as well how far each size moves from the one before it
};

/// Prints time and memory per step of 1/60 s of the hanging sheet for each size, and the exponent with which
/// they grow; with `motion` also the RMS distance of each size's sheet from that of the size before, mean
/// over a second. Throws InputError for a model that does not exist.
void bench_scaling(const ScalingBenchOptions& options);

}  // namespace weft::engine::lab
