#pragma once
/// `weft bench pictures`: what it costs to draw.

#include <vector>

#include "weft/render/picture.h"

namespace weft::engine::lab {

struct PictureBenchOptions {
  std::vector<int> triangles = {8192, 32768, 131072};  // about
  PictureSize size;
  int repeats = 9;  // median of so many
};

/// Prints a table to standard output: a sheet on a ball, with everything, and with each thing left out.
/// Throws GraphicsError where nothing can be drawn.
void bench_pictures(const PictureBenchOptions& options);

}  // namespace weft::engine::lab
