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

/// Whether a value is within two units in the last place of one in long doubles, or within an absolute error.
bool is_close(double value, long double exact, double absolute) {
  return std::abs(value - exact) <= std::max<long double>(4.5e-16L * std::abs(exact), absolute);
}

TEST(SinCos, AgreesWithLongDoubles) {
  for (double angle = -1000; angle < 1000; angle += 0.01237) {
    const SinCos r = sin_cos(angle);
    ASSERT_TRUE(is_close(r.sin, std::sin(static_cast<long double>(angle)), 2e-16)) << angle;
    ASSERT_TRUE(is_close(r.cos, std::cos(static_cast<long double>(angle)), 2e-16)) << angle;
  }
}

TEST(FindAngle, AgreesWithLongDoublesInEveryQuadrant) {
  for (double angle = -3.14; angle < 3.14; angle += 0.00037) {
    const double y = 3e-9 * std::sin(angle), x = 3e-9 * std::cos(angle);
    const auto exact =
        static_cast<double>(std::atan2(static_cast<long double>(y), static_cast<long double>(x)));
    ASSERT_NEAR(find_angle(y, x), exact, 1e-15 * std::abs(exact)) << angle;
  }
  EXPECT_EQ(find_angle(0, 0), 0);
  EXPECT_NEAR(find_angle(1e-200, 1e-200), 3.14159265358979323846 / 4, 1e-15);
  EXPECT_EQ(find_angle(0, 2), 0);
  EXPECT_NEAR(find_angle(0, -2), 3.14159265358979323846, 1e-15);
  EXPECT_NEAR(find_angle(-2, 0), -3.14159265358979323846 / 2, 1e-15);
}

}  // namespace
}  // namespace weft::engine
