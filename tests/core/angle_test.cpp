#include "weft/core/angle.h"

#include <gtest/gtest.h>

#include <cmath>

namespace weft::engine {
namespace {

TEST(SinCosDeg, IsExactAtRightAngles) {
  for (int quarter = -9; quarter <= 9; ++quarter) {
    const SinCos r = sin_cos_deg(90.0 * quarter);
    const double sine[] = {0, 1, 0, -1}, cosine[] = {1, 0, -1, 0};
    EXPECT_EQ(r.sin, sine[((quarter % 4) + 4) % 4]) << quarter;
    EXPECT_EQ(r.cos, cosine[((quarter % 4) + 4) % 4]) << quarter;
  }
}

TEST(SinCosDeg, AgreesWithTheCLibraryToRounding) {
  for (double angle = -720; angle <= 720; angle += 0.37) {
    const double radians = angle * 3.14159265358979323846 / 180;
    // The conversion to radians by itself costs up to |radians| · 2⁻⁵³, about 1.4e-15 at two turns.
    EXPECT_NEAR(sin_cos_deg(angle).sin, std::sin(radians), 3e-15) << angle;
    EXPECT_NEAR(sin_cos_deg(angle).cos, std::cos(radians), 3e-15) << angle;
  }
}

TEST(FindAngleDeg, AgreesWithTheCLibraryToRounding) {
  for (double angle = 0; angle <= 90; angle += 0.037) {
    const double radians = angle * 3.14159265358979323846 / 180;
    const double y = 2 * std::sin(radians), x = 2 * std::cos(radians);
    const double expected = std::atan2(y, x) * 180 / 3.14159265358979323846;
    EXPECT_NEAR(find_angle_deg(y, x), expected, 1e-15 * expected) << angle;  // some five roundings of 1.1e-16
  }
  EXPECT_EQ(find_angle_deg(0, 3), 0);
  EXPECT_NEAR(find_angle_deg(3, 0), 90, 3e-14);
  EXPECT_NEAR(find_angle_deg(1e-9, 1), 1e-9 * 180 / 3.14159265358979323846, 1e-22);
}

}  // namespace
}  // namespace weft::engine
