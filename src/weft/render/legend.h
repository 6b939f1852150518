#pragma once
/// Legends of colours in pictures.

#include <array>
#include <string>

#include "weft/render/image.h"

namespace weft::engine {

struct Legend {
  std::string title;              // ASCII, with the unit, as in "speed [m/s]"
  std::array<double, 2> range{};  // of the values, in ascending order
};

/// Draws a scale with the map's colours and at least three round numbers into the lower left corner, on a light
/// panel. Its size follows the picture's; a picture too small for it stays as it is.
void draw_legend(Image& image, const Legend& legend);

/// Round numbers in a range, in ascending order: multiples of 1, 2 or 5 times a power of ten, three to
/// eleven of them. A range without width has its one number.
std::vector<double> find_ticks(const std::array<double, 2>& range);

}  // namespace weft::engine
