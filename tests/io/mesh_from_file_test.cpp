/// Ear clipping against its definition.

#include "weft/io/mesh_from_file.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <numeric>

#include "weft/core/angle.h"
#include "weft/core/random.h"

namespace weft::engine {
namespace {

std::vector<Triangle> cut(const std::vector<Vec3>& corners) {
  MeshFromFile mesh{.mesh = {.positions = corners, .triangles = {}}};
  std::vector<int> polygon(corners.size());
  std::iota(polygon.begin(), polygon.end(), 0);
  append_polygon(polygon, {}, mesh);
  return mesh.mesh.triangles;
}

/// Clips the ear with the shortest cut, the first of equal ones, after a test of all corners against all vertices.
std::vector<Triangle> cut_by_brute_force(const std::vector<Vec3>& x) {
  Vec3 normal = Vec3::Zero();
  for (std::size_t k = 1; k + 1 < x.size(); ++k) normal += (x[k] - x[0]).cross(x[k + 1] - x[0]);
  const double tolerance = 1e-12 * normal.squaredNorm();
  const auto side = [&](int from, int to, int v) {
    return normal.dot((x[to] - x[from]).cross(x[v] - x[from]));
  };
  std::vector<int> left(x.size());
  std::iota(left.begin(), left.end(), 0);
  const auto is_ear = [&](const Triangle& t) {
    const auto [a, b, c] = t;
    if (!(side(a, b, c) > tolerance)) return false;
    return std::ranges::none_of(left, [&, a = a, b = b, c = c](int v) {
      if (x[v] == x[a] || x[v] == x[b] || x[v] == x[c]) return false;
      return std::min({side(a, b, v), side(b, c, v), side(c, a, v)}) >= -tolerance;
    });
  };
  std::vector<Triangle> triangles;
  while (left.size() > 3) {
    const std::size_t n = left.size();
    std::size_t best = 1;
    double shortest_sq = std::numeric_limits<double>::infinity();
    const auto at = [&](std::size_t tip) {
      return Triangle{left[(tip + n - 1) % n], left[tip], left[(tip + 1) % n]};
    };
    for (std::size_t tip = 0; tip < n; ++tip) {
      const Triangle ear = at(tip);
      const double cut_sq = (x[ear[0]] - x[ear[2]]).squaredNorm();
      if (cut_sq < shortest_sq && is_ear(ear)) {
        best = tip;
        shortest_sq = cut_sq;
      }
    }
    triangles.push_back(at(best));
    left.erase(left.begin() + static_cast<std::ptrdiff_t>(best));
  }
  triangles.push_back({left[0], left[1], left[2]});
  return triangles;
}

Vec3 random_point(Random& random) {
  return {random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)};
}

/// A star with rays of random length, in a random plane, up to `bend` out of it.
std::vector<Vec3> random_star(Random& random, int n, double bend) {
  const Vec3 u = random_point(random), v = random_point(random), w = u.cross(v),
             offset = 10 * random_point(random);
  std::vector<Vec3> corners;
  for (int k = 0; k < n; ++k) {
    const SinCos angle = sin_cos_deg(360.0 * (k + random.uniform(0, 0.3)) / n);
    corners.push_back(offset + random.uniform(0.1, 1) * (angle.cos * u + angle.sin * v) +
                      bend * random.uniform(-1, 1) * w);
  }
  return corners;
}

TEST(EarClipping, ClipsTheEarWithTheShortestCut) {
  Random random(1);
  for (int trial = 0; trial < 300; ++trial) {
    const std::vector<Vec3> corners = random_star(random, 4 + trial % 90, trial % 3 == 0 ? 0.3 : 0);
    EXPECT_EQ(cut(corners), cut_by_brute_force(corners)) << trial;
  }
}

TEST(EarClipping, ClipsTheSameOfPolygonsThatCrossThemselvesAndHaveEqualCorners) {
  Random random(2);
  for (int trial = 0; trial < 300; ++trial) {
    std::vector<Vec3> corners;
    const int n = 4 + trial % 80;
    for (int k = 0; k < n; ++k) {
      Vec3 p = random_point(random);
      if (trial % 2 == 0)
        p = (3 * p).array().round();  // a lattice: equal points, straight corners, equal cuts
      if (trial % 3 > 0) p.z() = 0;
      if (trial % 5 == 0) p.y() = 1e-7 * p.y();
      corners.push_back(p);
    }
    EXPECT_EQ(cut(corners), cut_by_brute_force(corners)) << trial;
  }
}

TEST(EarClipping, ClipsTheSameOfALongComb) {
  std::vector<Vec3> corners;
  for (int k = 0; k < 60; ++k) {
    corners.emplace_back(k, 0, 0);
    corners.emplace_back(k + 0.5, 40, 0);
  }
  corners.emplace_back(60, -1, 0);
  corners.emplace_back(0, -1, 0);
  std::ranges::reverse(corners);
  EXPECT_EQ(cut(corners), cut_by_brute_force(corners));
}

/// By brute force half a minute.
TEST(EarClipping, CutsAPolygonOfSixteenThousandCorners) {
  Random random(3);
  const std::vector<Vec3> corners = random_star(random, 16000, 0);
  Vec3 normal = Vec3::Zero(), sum = Vec3::Zero();
  for (std::size_t k = 1; k + 1 < corners.size(); ++k)
    normal += (corners[k] - corners[0]).cross(corners[k + 1] - corners[0]);
  double area = 0;
  const std::vector<Triangle> triangles = cut(corners);
  EXPECT_EQ(triangles.size(), 15998u);
  for (const auto& [a, b, c] : triangles) {
    const Vec3 twice = (corners[b] - corners[a]).cross(corners[c] - corners[a]);
    sum += twice;
    area += twice.norm();
  }
  EXPECT_NEAR(area, normal.norm(), 1e-9 * normal.norm()) << "an overlap would add to it";
}

}  // namespace
}  // namespace weft::engine
