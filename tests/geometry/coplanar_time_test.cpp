#include "weft/geometry/coplanar_time.h"

#include <gtest/gtest.h>

#include "tests/support.h"

namespace weft::engine {
namespace {

using Points = std::array<Vec3, 4>;

double volume(const Points& start, const Points& end, double t) {
  Points x;
  for (int k = 0; k < 4; ++k) x[k] = start[k] + t * (end[k] - start[k]);
  return (x[1] - x[0]).cross(x[2] - x[0]).dot(x[3] - x[0]);
}

TEST(CoplanarTime, OfAPointThroughATriangle) {
  const Points start = {Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(0, 0, 1), Vec3(0.2, 3, 0.2)};
  Points end = start;
  end[3].y() = -1;
  EXPECT_NEAR(find_coplanar_time(start, end).value(), 0.75, 2e-9);
  EXPECT_NEAR(find_coplanar_time(end, start).value(), 0.25, 2e-9);
  end[3].y() = 1;
  EXPECT_FALSE(find_coplanar_time(start, end)) << "not yet there";
  EXPECT_FALSE(find_coplanar_time(start, start)) << "at rest";
}

TEST(CoplanarTime, OfCommonMotionIsNone) {
  Random random(2);
  for (int i = 0; i < 1000; ++i) {
    Points start, end;
    const Vec3 shift = test::random_vector(random, 10);
    for (int k = 0; k < 4; ++k) start[k] = test::random_vector(random, 1), end[k] = start[k] + shift;
    if (std::abs(volume(start, end, 0)) < 1e-6) continue;
    EXPECT_FALSE(find_coplanar_time(start, end));
  }
}

/// Against a search in a thousand steps.
TEST(CoplanarTime, IsTheFirstChangeOfSign) {
  Random random(1);
  int found = 0, several = 0;
  for (int i = 0; i < 20000; ++i) {
    Points start, end;
    for (int k = 0; k < 4; ++k)
      start[k] = test::random_vector(random, 1), end[k] = test::random_vector(random, 1);
    constexpr int kSteps = 1000;
    double first = -1;
    int changes = 0;
    for (int s = 0; s < kSteps; ++s) {
      if ((volume(start, end, s / double{kSteps}) < 0) == (volume(start, end, (s + 1) / double{kSteps}) < 0))
        continue;
      if (changes++ == 0) first = s / double{kSteps};
    }
    const std::optional<double> time = find_coplanar_time(start, end);
    if (first < 0) {
      // Two changes within one step escape the stepwise search, but not the bisection.
      EXPECT_LT(std::abs(volume(start, end, time.value_or(0))), time ? 1e-5 : 1e9);
      continue;
    }
    ++found;
    several += changes > 1;
    ASSERT_TRUE(time);
    EXPECT_LE(*time, first + 1.0 / kSteps + 1e-9);
    EXPECT_LT(std::abs(volume(start, end, *time)), 1e-6) << "1e-9 of a volume's speed below a thousand";
  }
  EXPECT_GT(found, 5000);
  EXPECT_GT(several, 500) << "cubics with more than one root must be among them";
}

}  // namespace
}  // namespace weft::engine
