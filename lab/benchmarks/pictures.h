#pragma once
/// `weft bench pictures`: time of drawing.

#include <vector>

#include "weft/render/picture.h"

namespace weft::engine::lab {

struct PictureBenchOptions {
  std::vector<int> triangles = {8192, 32768, 131072};  // about
  PictureSize size;
  int repeats = 9;  // for the median
};

/// Prints a table to standard output: a sheet on a ball, complete, and without each part of the picture.
/// Throws GraphicsError without graphics.
void bench_pictures(const PictureBenchOptions& options);

}  // namespace weft::engine::lab
