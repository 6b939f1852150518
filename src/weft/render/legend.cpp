#include "weft/render/legend.h"

#include <stb_easy_font.h>

#include <algorithm>
#include <cmath>
#include <sstream>

#include "weft/render/color_map.h"

namespace weft::engine {
namespace {

struct Panel {
  int left, top, width, height;
};

void blend(Image& image, const Panel& panel, const std::array<double, 3>& color, double share) {
  for (int y = std::max(panel.top, 0); y < std::min(panel.top + panel.height, image.height); ++y) {
    for (int x = std::max(panel.left, 0); x < std::min(panel.left + panel.width, image.width); ++x) {
      std::uint8_t* pixel = image.pixel(x, y);
      for (int c = 0; c < 3; ++c)
        pixel[c] = static_cast<std::uint8_t>(std::lround((1 - share) * pixel[c] + share * 255 * color[c]));
      pixel[3] = static_cast<std::uint8_t>(std::lround((1 - share) * pixel[3] + share * 255));
    }
  }
}

int text_width(const std::string& text, int scale) {
  std::string copy = text;
  return scale * stb_easy_font_width(copy.data());
}

void write(Image& image, const std::string& text, int left, int top, int scale) {
  constexpr std::array<double, 3> kInk = {0.12, 0.12, 0.14};
  struct Corner {
    float x, y, z;
    std::uint8_t color[4];
  };
  std::vector<Corner> corners(4 * 270);  // a quad of four corners is at most 64 bytes
  std::string copy = text;
  const int num_quads = stb_easy_font_print(0, 0, copy.data(), nullptr, corners.data(),
                                            static_cast<int>(corners.size() * sizeof(Corner)));
  for (int q = 0; q < num_quads; ++q) {
    const Corner &a = corners[4 * q], &b = corners[4 * q + 2];
    blend(image,
          {left + scale * static_cast<int>(a.x), top + scale * static_cast<int>(a.y),
           scale * static_cast<int>(b.x - a.x), scale * static_cast<int>(b.y - a.y)},
          kInk, 1);
  }
}

std::string to_text(double number) {
  std::ostringstream text;
  text << number;
  return text.str();
}

}  // namespace

std::vector<double> find_ticks(const std::array<double, 2>& range) {
  const double span = range[1] - range[0];
  if (!(span > 0)) return {range[0]};
  const double power = std::pow(10, std::floor(std::log10(span)));
  for (const double step : {power, power / 2, power / 5}) {
    std::vector<double> ticks;
    const double first = std::ceil(range[0] / step - 1e-9), last = std::floor(range[1] / step + 1e-9);
    for (double k = first; k <= last; ++k) ticks.push_back(k == 0 ? 0 : k * step);
    if (ticks.size() >= 3) return ticks;
  }
  return {range[0], range[1]};
}

void draw_legend(Image& image, const Legend& legend) {
  constexpr int kWidth = 190, kHeight = 46, kMargin = 10, kInset = 10, kBar = 9;
  const int scale = std::max(1, image.height / 360);
  if (image.width < scale * (kWidth + 2 * kMargin) || image.height < scale * (kHeight + 2 * kMargin)) return;
  const Panel panel{scale * kMargin, image.height - scale * (kMargin + kHeight), scale * kWidth,
                    scale * kHeight};
  blend(image, panel, {1, 1, 1}, 0.72);
  const int left = panel.left + scale * kInset, width = panel.width - 2 * scale * kInset;
  write(image, legend.title, left, panel.top + 6 * scale, scale);
  const int top = panel.top + 18 * scale;
  for (int x = 0; x < width; ++x)
    blend(image, {left + x, top, 1, scale * kBar}, map_color((x + 0.5) / width), 1);
  const double span = legend.range[1] - legend.range[0];
  for (const double tick : find_ticks(legend.range)) {
    const double share = span > 0 ? (tick - legend.range[0]) / span : 0;
    const int x = left + static_cast<int>(std::lround(share * (width - scale)));
    blend(image, {x, top + scale * kBar, scale, 3 * scale}, {0.12, 0.12, 0.14}, 1);
    const std::string text = to_text(tick);
    const int text_left = std::clamp(x - text_width(text, scale) / 2, panel.left + 2 * scale,
                                     panel.left + panel.width - 2 * scale - text_width(text, scale));
    write(image, text, text_left, top + scale * (kBar + 5), scale);
  }
}

}  // namespace weft::engine
