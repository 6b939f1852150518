#include "weft/render/color_map.h"

#include <algorithm>

namespace weft::engine {

std::array<double, 3> map_color(double share) {
  const double t = std::clamp(share, 0.0, 1.0);
  std::array<double, 3> color = {};
  for (auto row = kColorMap.rbegin(); row != kColorMap.rend(); ++row) {
    for (std::size_t c = 0; c < 3; ++c) color[c] = color[c] * t + (*row)[c];
  }
  for (double& c : color) c = std::clamp(c, 0.0, 1.0);
  return color;
}

}  // namespace weft::engine
