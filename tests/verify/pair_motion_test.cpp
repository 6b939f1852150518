#include "weft/verify/pair_motion.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include "weft/core/random.h"
#include "weft/verify/inside.h"
#include "weft/verify/predicates.h"

namespace weft::engine::verify {
namespace {

using TriangleMotion = std::array<PointMotion, 3>;
using EdgeMotion = std::array<PointMotion, 2>;

Vec3 random_vector(Random& random, double size) {
  return {random.uniform(-size, size), random.uniform(-size, size), random.uniform(-size, size)};
}

/// Small whole numbers, so that every degeneracy occurs.
Vec3 random_grid_point(Random& random, int reach) {
  Vec3 p;
  for (int k = 0; k < 3; ++k)
    p[k] = static_cast<double>(random.next() % static_cast<std::uint64_t>(2 * reach + 1)) - reach;
  return p;
}

// ---- Slow reference: roots of the cubic, in long doubles ----

using Real = long double;
using Vec = Eigen::Matrix<Real, 3, 1>;
using Cubic = std::array<Real, 4>;  // coefficients by power

Vec at(const PointMotion& p, Real t) { return (1 - t) * p.start.cast<Real>() + t * p.end.cast<Real>(); }

Real value(const Cubic& c, Real t) { return c[0] + t * (c[1] + t * (c[2] + t * c[3])); }

/// det(a, b, c) of three vectors that are linear in time, interpolated from four of its values.
template <class Volume>
Cubic cubic_through(const Volume& volume) {
  const Real y0 = volume(0), y1 = volume(1), y2 = volume(2), y3 = volume(3);
  const Real d1 = y1 - y0, d2 = y2 - 2 * y1 + y0, d3 = y3 - 3 * y2 + 3 * y1 - y0;
  return {y0, d1 - d2 / 2 + d3 / 3, d2 / 2 - d3 / 2, d3 / 6};
}

/// In [0, 1], each bracketed by adjacent extrema; empty if one is nearly double, or close to an end.
std::optional<std::vector<Real>> simple_roots(const Cubic& c) {
  const Real size = std::abs(c[0]) + std::abs(c[1]) + std::abs(c[2]) + std::abs(c[3]), margin = 1e-9L * size;
  std::vector<Real> stops = {0};
  const Real p = c[2] / (3 * c[3]), discriminant = p * p - c[1] / (3 * c[3]);
  if (discriminant > 0) {
    for (const Real t : {-p - std::sqrt(discriminant), -p + std::sqrt(discriminant)})
      if (t > 0 && t < 1) stops.push_back(t);
  }
  stops.push_back(1);
  const auto is_above = [&](Real t) { return value(c, t) > 0; };
  std::vector<Real> roots;
  for (const Real t : stops) {
    if (std::abs(value(c, t)) < margin) return {};
  }
  for (std::size_t k = 0; k + 1 < stops.size(); ++k) {
    Real low = stops[k], high = stops[k + 1];
    if (is_above(low) == is_above(high)) continue;
    for (int i = 0; i < 200; ++i) {
      const Real middle = (low + high) / 2;
      (is_above(low) == is_above(middle) ? low : high) = middle;
    }
    roots.push_back((low + high) / 2);
  }
  return roots;
}

/// Parity of the roots at which the positions are in [0, 1]; empty if one is close to the border.
template <class Places>
std::optional<bool> is_odd(const Cubic& cubic, const Places& places) {
  constexpr Real kMargin = 1e-7L;
  const auto roots = simple_roots(cubic);
  if (!roots) return {};
  bool odd = false;
  for (const Real t : *roots) {
    const std::vector<Real> at_root = places(t);
    const Real least = *std::min_element(at_root.begin(), at_root.end());
    if (std::abs(least) < kMargin || !std::isfinite(least)) return {};
    odd ^= least > 0;
  }
  return odd;
}

std::optional<bool> passes_slowly(const PointMotion& p, const TriangleMotion& t) {
  const auto volume = [&](Real time) {
    const Vec a = at(t[0], time);
    return (at(t[1], time) - a).cross(at(t[2], time) - a).dot(at(p, time) - a);
  };
  return is_odd(cubic_through(volume), [&](Real time) -> std::vector<Real> {
    const Vec a = at(t[0], time), b = at(t[1], time) - a, c = at(t[2], time) - a, d = at(p, time) - a;
    const Vec n = b.cross(c);
    const Real v = d.cross(c).dot(n) / n.squaredNorm(), w = b.cross(d).dot(n) / n.squaredNorm();
    return {v, w, 1 - v - w};
  });
}

std::optional<bool> passes_slowly(const EdgeMotion& a, const EdgeMotion& b) {
  const auto volume = [&](Real time) {
    const Vec p = at(a[0], time);
    return (at(a[1], time) - p).cross(at(b[0], time) - p).dot(at(b[1], time) - p);
  };
  return is_odd(cubic_through(volume), [&](Real time) -> std::vector<Real> {
    const Vec u = at(a[1], time) - at(a[0], time), v = at(b[1], time) - at(b[0], time),
              d = at(b[0], time) - at(a[0], time);
    const Vec n = u.cross(v);
    const Real s = d.cross(v).dot(n) / n.squaredNorm(), r = d.cross(u).dot(n) / n.squaredNorm();
    return {s, 1 - s, r, 1 - r};
  });
}

PointMotion random_motion(Random& random, double size, double way) {
  const Vec3 start = random_vector(random, size);
  return {start, start + random_vector(random, way)};
}

TEST(PairMotion, AgreesWithTheRootsOfTheCubic) {
  Random random(1);
  int passing[2] = {}, clear[2] = {};
  for (int i = 0; i < 200000; ++i) {
    const double way = i % 3 == 0 ? 0.1 : i % 3 == 1 ? 1 : 10;
    std::array<PointMotion, 4> x;
    for (PointMotion& p : x) p = random_motion(random, 1, way);
    const TriangleMotion triangle = {x[1], x[2], x[3]};
    const EdgeMotion first = {x[0], x[1]}, second = {x[2], x[3]};
    if (const auto expected = passes_slowly(x[0], triangle)) {
      ++(*expected ? passing : clear)[0];
      ASSERT_EQ(test_vertex_triangle(x[0], triangle).passes, *expected) << i;
    }
    if (const auto expected = passes_slowly(first, second)) {
      ++(*expected ? passing : clear)[1];
      ASSERT_EQ(test_edge_edge(first, second).passes, *expected) << i;
    }
  }
  for (const int k : {0, 1}) {
    EXPECT_GT(passing[k], 5000);
    EXPECT_GT(clear[k], 50000);
  }
}

TEST(PairMotion, OfAPointAndAClosedSurfaceIsOddWhereItGoesInOrOut) {
  // A point and a tetrahedron with arbitrary corner motions, which may invert it. In integers, so that the
  // point goes through corners and edges, along faces, and so on, exactly.
  Random random(2);
  const std::vector<Triangle> faces = {{0, 1, 2}, {0, 2, 3}, {0, 3, 1}, {1, 3, 2}};
  int num_tested = 0, num_changed = 0, num_graze = 0;
  for (int i = 0; i < 100000; ++i) {
    const int reach = 1 + i % 3;
    std::array<PointMotion, 4> corner;
    std::vector<Vec3> start, end;
    for (PointMotion& c : corner) {
      c = {random_grid_point(random, reach), random_grid_point(random, reach)};
      if (i % 4 == 0) c.end = c.start;
      start.push_back(c.start);
      end.push_back(c.end);
    }
    const PointMotion p = {random_grid_point(random, reach), random_grid_point(random, reach)};
    int num_passed = 0;
    bool is_on_surface = false;
    for (const auto& [a, b, c] : faces) {
      const PairMotion motion = test_vertex_triangle(p, {corner[a], corner[b], corner[c]});
      num_passed += motion.passes;
      is_on_surface |= motion.touches_at_start || motion.touches_at_end;
    }
    if (is_on_surface) {
      ++num_graze;
      continue;
    }
    ++num_tested;
    const bool is_changed =
        InsideOfMesh(start, faces).contains(p.start) != InsideOfMesh(end, faces).contains(p.end);
    num_changed += is_changed;
    ASSERT_EQ(num_passed % 2 == 1, is_changed) << i;
  }
  EXPECT_GT(num_tested, 50000);
  EXPECT_GT(num_changed, 1000);
  EXPECT_GT(num_graze, 10000);
}

/// Number of crossings of one triangle's sides through the other, modulo 2; empty if anything touches.
std::optional<bool> are_linked(const std::array<Vec3, 3>& a, const std::array<Vec3, 3>& b) {
  bool odd = false;
  for (int k = 0; k < 3; ++k) {
    const Vec3 &p = a[k], &q = a[(k + 1) % 3];
    const int from = orient3d(b[0], b[1], b[2], p), to = orient3d(b[0], b[1], b[2], q);
    std::array<int, 3> sides;
    for (int l = 0; l < 3; ++l) sides[l] = orient3d(p, q, b[l], b[(l + 1) % 3]);
    if (from == 0 || to == 0 || std::ranges::find(sides, 0) != sides.end()) return {};
    odd ^= from != to && sides[0] == sides[1] && sides[1] == sides[2];
  }
  return odd;
}

TEST(PairMotion, OfTwoClosedLoopsIsOddWhereTheyAreLinkedOrFreed) {
  Random random(3);
  int num_tested = 0, num_changed = 0;
  for (int i = 0; i < 200000; ++i) {
    const int reach = 2 + i % 3;
    std::array<std::array<PointMotion, 3>, 2> loops;
    std::array<std::array<Vec3, 3>, 2> start, end;
    for (int s = 0; s < 2; ++s) {
      for (int k = 0; k < 3; ++k) {
        start[s][k] = random_grid_point(random, reach);
        end[s][k] = i % 2 == 0 ? random_grid_point(random, reach) : Vec3(start[s][k] + Vec3(s * 2, s, 0));
        loops[s][k] = {start[s][k], end[s][k]};
      }
    }
    const auto before = are_linked(start[0], start[1]), after = are_linked(end[0], end[1]);
    if (!before || !after) continue;
    int num_passed = 0;
    for (int k = 0; k < 3; ++k) {
      for (int l = 0; l < 3; ++l) {
        num_passed +=
            test_edge_edge({loops[0][k], loops[0][(k + 1) % 3]}, {loops[1][l], loops[1][(l + 1) % 3]}).passes;
      }
    }
    ++num_tested;
    num_changed += *before != *after;
    ASSERT_EQ(num_passed % 2 == 1, *before != *after) << i;
  }
  EXPECT_GT(num_tested, 20000);
  EXPECT_GT(num_changed, 2000);
}

}  // namespace
}  // namespace weft::engine::verify
