#include "weft/geometry/time_of_impact.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "tests/support.h"
#include "weft/geometry/distance.h"

namespace weft::engine {
namespace {

using Points = std::array<Vec3, 4>;

constexpr ImpactLimit kLimit{.separation = 1e-3, .floor = 1e-5, .rounding = 1e-7};

Points at(const Points& start, const Points& end, double t) {
  Points x;
  for (int k = 0; k < 4; ++k) x[k] = start[k] + t * (end[k] - start[k]);
  return x;
}

double vertex_triangle(const Points& x) { return point_triangle_distance(x[3], x[0], x[1], x[2]).distance(); }
double edge_edge(const Points& x) { return edge_edge_distance(x[0], x[1], x[2], x[3]).distance(); }

TEST(TimeOfImpact, OfAVertexThatFallsThroughATriangle) {
  const Points start = {Vec3(0, 0, 0), Vec3(0, 0, 1), Vec3(1, 0, 0), Vec3(0.2, 1, 0.3)};
  Points end = start;
  end[3].y() = -1;
  const std::optional<Impact> impact = find_vertex_triangle_impact(start, end, kLimit);
  ASSERT_TRUE(impact);
  EXPECT_LE(impact->time, 0.4995);
  EXPECT_GE(impact->time, 0.4995 - 1e-4) << "within the tolerance of the separation";
  EXPECT_NEAR(impact->normal.y(), 1, 1e-9);
  EXPECT_NEAR(impact->weights[3], 1, 0);
  EXPECT_NEAR(impact->weights[0] + impact->weights[1] + impact->weights[2], -1, 1e-12);
  end[3].y() = 0.01;
  EXPECT_FALSE(find_vertex_triangle_impact(start, end, kLimit)) << "it stops before";
}

TEST(TimeOfImpact, OfACommonMotionIsNone) {
  Random random(3);
  for (int i = 0; i < 1000; ++i) {
    Points start, end;
    const Vec3 shift = test::random_vector(random, 100);
    for (int k = 0; k < 4; ++k) start[k] = test::random_vector(random, 1), end[k] = start[k] + shift;
    EXPECT_FALSE(find_vertex_triangle_impact(start, end, kLimit));
    EXPECT_FALSE(find_edge_edge_impact(start, end, kLimit));
  }
}

TEST(TimeOfImpact, KeepsThatFeaturesMayPartAgain) {
  // Much nearer than the separation at the start: parting and resting are free; approaching is not.
  const Points start = {Vec3(0, 0, 0), Vec3(0, 0, 1), Vec3(1, 0, 0), Vec3(0.2, 2e-5, 0.3)};
  for (const double y : {2e-5, 3e-5, 1.0}) {
    Points end = start;
    end[3].y() = y;
    EXPECT_FALSE(find_vertex_triangle_impact(start, end, kLimit)) << y;
  }
  Points end = start;
  end[3].y() = 0.9e-5;
  EXPECT_TRUE(find_vertex_triangle_impact(start, end, kLimit));
}

TEST(TimeOfImpact, KeepsAFloorUnderTheGap) {
  double distance = 1e-3;
  for (int step = 0; step < 60; ++step) distance = kLimit.gap(distance);
  EXPECT_GT(distance, 0.4 * kLimit.floor) << "halving it every step would have left 1e-21";
}

/// 20,000, or the value of the environment variable WEFT_CASES.
int num_cases() {
  const char* cases = std::getenv("WEFT_CASES");
  return cases ? std::max(20000, std::atoi(cases)) : 20000;
}

/// Random and degenerate pairs, against small time steps: no impact is missed or late, and none is reported
/// for features that keep their distance.
template <class Find, class Distance>
void compare_with_a_walk(const Find& find, const Distance& distance, std::uint64_t seed) {
  constexpr int kSteps = 400;
  Random random(seed);
  int hits = 0, misses = 0, grazing = 0;
  for (int i = 0; i < num_cases(); ++i) {
    Points start, end;
    const double size = i % 3 == 0 ? 0.1 : 1;
    for (int k = 0; k < 4; ++k) {
      start[k] = test::random_vector(random, size);
      end[k] = start[k] + test::random_vector(random, 0.7);
    }
    if (i % 7 == 0) start[1] = start[0], end[1] = end[0];        // no length or area
    if (i % 11 == 0) start[3] = start[2] + start[1] - start[0];  // parallel, in one plane
    if (i % 13 == 0)
      for (int k = 0; k < 4; ++k) start[k].y() = 0, end[k].y() = 0;  // all in one plane
    const double at_start = distance(start);
    if (at_start < 1e-6) continue;
    const std::optional<Impact> impact = find(start, end, kLimit);
    const double gap = kLimit.gap(at_start), tolerance = kLimit.tolerance(at_start);
    const double until = impact ? impact->time : 1;
    for (int s = 0; s <= kSteps; ++s)
      ASSERT_GE(distance(at(start, end, until * s / kSteps)), gap - 1e-12) << "case " << i << " step " << s;
    if (!impact) {
      ++misses;
      continue;
    }
    ++hits;
    const Points x = at(start, end, impact->time);
    if (distance(x) > gap + tolerance + 1e-12) ++grazing;
    Vec3 offset = Vec3::Zero();
    for (int k = 0; k < 4; ++k) offset += impact->weights[k] * x[k];
    EXPECT_NEAR(impact->normal.dot(offset), distance(x), 1e-12) << "case " << i;
  }
  EXPECT_LT(grazing, num_cases() / 4000) << "those that graze each other for very long are the exception";
  EXPECT_GT(hits, 1000);
  EXPECT_GT(misses, 1000);
}

TEST(TimeOfImpact, OfVerticesAndTrianglesIsNeverLateAndNeverInvented) {
  compare_with_a_walk(find_vertex_triangle_impact, vertex_triangle, 1);
}

TEST(TimeOfImpact, OfEdgesIsNeverLateAndNeverInvented) {
  compare_with_a_walk(find_edge_edge_impact, edge_edge, 2);
}

}  // namespace
}  // namespace weft::engine
