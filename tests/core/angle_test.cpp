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

}  // namespace
}  // namespace weft::engine
