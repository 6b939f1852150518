#include "weft/verify/predicates.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdint>

#include "weft/core/random.h"

namespace weft::engine::verify {
namespace {

__extension__ typedef __int128 Integer;
using Point = std::array<std::int64_t, 3>;

int sign(Integer x) { return (x > 0) - (x < 0); }

/// The determinant in integers. With coordinates below 2^38 nothing overflows.
int exact_orient3d(const Point& a, const Point& b, const Point& c, const Point& d) {
  const auto minus = [&](const Point& p, int k) { return static_cast<Integer>(p[k] - d[k]); };
  const Integer x = minus(b, 1) * minus(c, 2) - minus(b, 2) * minus(c, 1);
  const Integer y = minus(b, 2) * minus(c, 0) - minus(b, 0) * minus(c, 2);
  const Integer z = minus(b, 0) * minus(c, 1) - minus(b, 1) * minus(c, 0);
  return sign(minus(a, 0) * x + minus(a, 1) * y + minus(a, 2) * z);
}

int exact_orient2d(const Point& a, const Point& b, const Point& c) {
  return sign(static_cast<Integer>(a[0] - c[0]) * (b[1] - c[1]) -
              static_cast<Integer>(a[1] - c[1]) * (b[0] - c[0]));
}

Vec3 to_vec(const Point& p, double scale = 1) {
  return scale * Vec3(static_cast<double>(p[0]), static_cast<double>(p[1]), static_cast<double>(p[2]));
}

Eigen::Vector2d flat(const Point& p) { return to_vec(p).head<2>(); }

class Integers {
 public:
  std::int64_t draw(std::int64_t reach) {
    const auto width = static_cast<std::uint64_t>(2 * reach + 1);
    return static_cast<std::int64_t>(((std::uint64_t{bits()} << 32) | bits()) % width) - reach;
  }
  Point point(std::int64_t reach) { return {draw(reach), draw(reach), draw(reach)}; }

 private:
  std::uint32_t bits() { return static_cast<std::uint32_t>(state_.next() >> 32); }
  Random state_{1};
};

TEST(Orient3d, IsThatOfIntegersNearThePlane) {
  // d is an integer combination of a, b, c, within one unit: in or next to their plane, where rounding in
  // doubles (2^36 cubed has 108 bits) is inconclusive.
  Integers integers;
  int zeros = 0;
  for (int i = 0; i < 1000000; ++i) {
    const Point a = integers.point(std::int64_t{1} << 33), b = integers.point(std::int64_t{1} << 33);
    const Point c = integers.point(std::int64_t{1} << 33);
    const std::int64_t s = integers.draw(2), t = integers.draw(2);
    Point d;
    for (int k = 0; k < 3; ++k) d[k] = a[k] + s * (b[k] - a[k]) + t * (c[k] - a[k]);
    if (i % 2 == 0) d[i % 3] += integers.draw(1);
    const int expected = exact_orient3d(a, b, c, d);
    zeros += expected == 0;
    ASSERT_EQ(orient3d(to_vec(a), to_vec(b), to_vec(c), to_vec(d)), expected) << i;
  }
  EXPECT_GT(zeros, 400000);
}

TEST(Orient3d, IsThatOfSmallIntegers) {
  Integers integers;
  for (int i = 0; i < 1000000; ++i) {
    const Point a = integers.point(2), b = integers.point(2), c = integers.point(2), d = integers.point(2);
    ASSERT_EQ(orient3d(to_vec(a), to_vec(b), to_vec(c), to_vec(d)), exact_orient3d(a, b, c, d)) << i;
  }
}

TEST(Orient3d, HoldsFromTheLeastFloatToTheGreatest) {
  // Scaling by powers of two keeps the sign, even where a naive product would under- or overflow.
  Integers integers;
  for (int i = 0; i < 100000; ++i) {
    const Point a = integers.point(3), b = integers.point(3), c = integers.point(3), d = integers.point(3);
    const int expected = exact_orient3d(a, b, c, d);
    for (const double scale : {0x1p-298, 0x1p-149, 0x1p126, 0x1p297}) {
      ASSERT_EQ(orient3d(to_vec(a, scale), to_vec(b, scale), to_vec(c, scale), to_vec(d, scale)), expected)
          << scale;
    }
  }
}

TEST(Orient3d, SeesTheLastBitOfNumbersOfUnequalSize) {
  // The plane through a, b, c is x = 1; d is off it by less than the resolution of differences in doubles.
  const Vec3 a(1, 0, 0), b(1, 1e30, 0), c(1, 0, 1e30);
  EXPECT_EQ(orient3d(a, b, c, {1, 1e-40, 1e-40}), 0);
  EXPECT_EQ(orient3d(a, b, c, {std::nextafter(1.0, 2.0), 3, 5}), -1);
  EXPECT_EQ(orient3d(a, b, c, {std::nextafter(1.0, 0.0), 3, 5}), 1);
  EXPECT_EQ(orient3d({1e-60, 0, 0}, {0, 1e20, 0}, {0, 0, 1e20}, {0, 0, 0}), 1);
  EXPECT_EQ(orient3d({1e20, 1e20, 1e-60}, {1e20, 0, 0}, {0, 1e20, 0}, {0, 0, 0}), 1);
}

TEST(Orient3d, ChangesSignWithEveryExchange) {
  Integers integers;
  for (int i = 0; i < 10000; ++i) {
    const Vec3 a = to_vec(integers.point(1 << 30), 0.1), b = to_vec(integers.point(1 << 30), 0.3);
    const Vec3 c = to_vec(integers.point(1 << 30), 0.7),
               d = 0.25 * a + 0.25 * b + 0.5 * c;  // nearly in the plane
    const int s = orient3d(a, b, c, d);
    EXPECT_EQ(orient3d(b, a, c, d), -s);
    EXPECT_EQ(orient3d(a, c, b, d), -s);
    EXPECT_EQ(orient3d(a, b, d, c), -s);
  }
}

TEST(Orient2d, IsThatOfIntegersNearTheLine) {
  Integers integers;
  for (int i = 0; i < 1000000; ++i) {
    const Point a = integers.point(std::int64_t{1} << 50), b = integers.point(std::int64_t{1} << 50);
    Point c;
    const std::int64_t s = integers.draw(3);
    for (int k = 0; k < 3; ++k) c[k] = a[k] + s * (b[k] - a[k]) + (i % 2) * integers.draw(1);
    ASSERT_EQ(orient2d(flat(a), flat(b), flat(c)), exact_orient2d(a, b, c)) << i;
  }
}

}  // namespace
}  // namespace weft::engine::verify
