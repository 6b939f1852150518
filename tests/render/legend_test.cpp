#include "weft/render/legend.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "weft/render/color_map.h"

namespace weft::engine {
namespace {

double luminance(const std::array<double, 3>& c) {
  return 0.2126 * std::pow(c[0], 2.2) + 0.7152 * std::pow(c[1], 2.2) + 0.0722 * std::pow(c[2], 2.2);
}

TEST(ColorMap, IsViridis) {
  // Entries 0, 64, 128, 192 and 255 of viridis.
  const std::array<std::array<double, 3>, 5> expected = {{{0.267, 0.005, 0.329},
                                                          {0.229, 0.322, 0.546},
                                                          {0.128, 0.567, 0.551},
                                                          {0.369, 0.789, 0.383},
                                                          {0.993, 0.906, 0.144}}};
  for (int k = 0; k < 5; ++k) {
    const std::array<double, 3> color = map_color(std::min(64.0 * k, 255.0) / 255);
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(color[c], expected[k][c], 0.015) << k << ' ' << c;
  }
}

TEST(ColorMap, BecomesBrighterAllTheWay) {
  for (int k = 0; k < 100; ++k)
    EXPECT_GT(luminance(map_color((k + 1) / 100.0)), luminance(map_color(k / 100.0))) << k;
  EXPECT_EQ(map_color(-3), map_color(0));
  EXPECT_EQ(map_color(7), map_color(1));
}

TEST(Legend, TicksAreRoundAndWithinTheRange) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> exponent(-4, 4), share(-1, 1);
  for (int k = 0; k < 1000; ++k) {
    const double low = share(random) * std::pow(10, exponent(random)), span = std::pow(10, exponent(random));
    const std::vector<double> ticks = find_ticks({low, low + span});
    EXPECT_GE(ticks.size(), 3u);
    EXPECT_LE(ticks.size(), 11u);
    for (std::size_t t = 0; t < ticks.size(); ++t) {
      EXPECT_GE(ticks[t], low - 1e-6 * span);
      EXPECT_LE(ticks[t], low + span + 1e-6 * span);
      if (t > 0) {
        EXPECT_NEAR(ticks[t] - ticks[t - 1], ticks[1] - ticks[0], 1e-9 * (std::abs(low) + span));
      }
    }
  }
  EXPECT_EQ(find_ticks({0, 5}), (std::vector<double>{0, 1, 2, 3, 4, 5}));
  EXPECT_EQ(find_ticks({2, 2}), (std::vector<double>{2}));
}

TEST(Legend, ChangesOnlyItsCorner) {
  Image image(640, 480);
  draw_legend(image, {"speed [m/s]", {0, 2}});
  int changed = 0;
  for (int y = 0; y < image.height; ++y) {
    for (int x = 0; x < image.width; ++x) {
      if (image.pixel(x, y)[3] == 0) continue;
      ++changed;
      EXPECT_LT(x, 220);
      EXPECT_GT(y, 480 - 70);
    }
  }
  EXPECT_GT(changed, 5000);
  Image small(100, 60);
  draw_legend(small, {"speed [m/s]", {0, 2}});
  EXPECT_EQ(small.rgba, Image(100, 60).rgba) << "no room";
}

}  // namespace
}  // namespace weft::engine
