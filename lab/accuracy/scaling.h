#pragma once
/// `weft bench scaling`: cost of `newton` against size, at the same accuracy.

#include <string>
#include <vector>

namespace weft::engine::lab {

struct ScalingBenchOptions {
  std::vector<int> sizes = {32, 64, 128, 256, 512, 1024};  // particles per side
  std::vector<int> threads = {1, 2};
  std::string model = "simplified";  // of springs; "mesh": the same cloth as a triangle mesh
  /// Of conjugate gradients. With 10 the error is the same at 64², 128² and 256² (`weft bench frontier`) [1].
  int iterations = 10;
  int steps = 10;       // per measurement
  bool motion = false;  // also reports the distance between the motions of consecutive sizes
};

/// Prints time and memory per step of 1/60 s of the hanging sheet for each size, and the exponent of growth.
/// With `motion` also the RMS distance of each size's sheet from that of the previous size, mean over a
/// second. Throws InputError for a model that does not exist.
void bench_scaling(const ScalingBenchOptions& options);

}  // namespace weft::engine::lab
