#include "weft/geometry/distance.h"

#include <gtest/gtest.h>

#include "tests/geometry/slow_distance.h"

namespace weft::engine {
namespace {

using test::Quad;

constexpr double kRounding = 1e-15;  // a few roundings of numbers of size 1

/// The length of the weighted sum of points in extended precision: the true distance between the pair of
/// points that signed weights represent.
double pair_distance(const std::vector<Vec3>& x, const std::vector<double>& weights) {
  Quad sum = 0;
  for (int k = 0; k < 3; ++k) {
    Quad d = 0;  // relative to one point: the weights sum to 0 up to rounding
    for (std::size_t i = 0; i < x.size(); ++i) d += Quad(weights[i]) * (Quad(x[i][k]) - Quad(x[0][k]));
    sum += d * d;
  }
  return std::sqrt(static_cast<double>(sum));
}

/// Requirements on every result: weights that are a pair of points on the features, the pair's distance, and
/// none smaller.
struct Claim {
  double worst_value = 0;  // |distance − the pair's| and distance − the smallest, over the largest length
  double worst_minimum = 0;
  double worst_sum = 0;  // of the weights
  bool weights_in_range = true;

  template <class Real>
  void check(const std::vector<Vec3>& x, int num_first, double distance_sq,
             const std::vector<double>& weights) {
    const double size = test::spread(x);
    if (size == 0) {
      weights_in_range = weights_in_range && distance_sq == 0;
      return;
    }
    const std::vector<Vec3> a(x.begin(), x.begin() + num_first), b(x.begin() + num_first, x.end());
    const double distance = std::sqrt(distance_sq);
    const double least = std::sqrt(static_cast<double>(test::slow_distance_sq<Real>(a, b)));
    worst_value = std::max(worst_value, std::abs(distance - pair_distance(x, weights)) / size);
    worst_minimum = std::max(worst_minimum, std::abs(distance - least) / size);
    double sum_a = 0, sum_b = 0;
    for (int i = 0; i < static_cast<int>(x.size()); ++i) {
      const double w = i < num_first ? weights[i] : -weights[i];
      weights_in_range = weights_in_range && w >= 0 && w <= 1;
      (i < num_first ? sum_a : sum_b) += w;
    }
    worst_sum = std::max({worst_sum, std::abs(sum_a - 1), std::abs(sum_b - 1)});
  }

  void expect() const {
    EXPECT_LT(worst_value, kDistanceTolerance);
    EXPECT_LT(worst_minimum, kDistanceTolerance);
    EXPECT_LT(worst_sum, kRounding);
    EXPECT_TRUE(weights_in_range);
    ::testing::Test::RecordProperty("worst_value", std::to_string(worst_value * 1e16) + "e-16");
    ::testing::Test::RecordProperty("worst_minimum", std::to_string(worst_minimum * 1e16) + "e-16");
  }
};

template <class Real>
void check_point_triangle(Claim& claim, const std::vector<Vec3>& x) {
  const auto d = point_triangle_distance(x[0], x[1], x[2], x[3]);
  claim.check<Real>(x, 1, d.distance_sq, {1, -d.weights[0], -d.weights[1], -d.weights[2]});
}

template <class Real>
void check_edge_edge(Claim& claim, const std::vector<Vec3>& x) {
  const auto d = edge_edge_distance(x[0], x[1], x[2], x[3]);
  claim.check<Real>(x, 2, d.distance_sq, {1 - d.s, d.s, -(1 - d.t), -d.t});
}

template <class Real>
void check_segment_triangle(Claim& claim, const std::vector<Vec3>& x) {
  const auto d = segment_triangle_distance(x[0], x[1], x[2], x[3], x[4]);
  claim.check<Real>(x, 2, d.distance_sq, {1 - d.s, d.s, -d.weights[0], -d.weights[1], -d.weights[2]});
}

// --- Points and segments ---

TEST(PointSegment, EveryRegion) {
  const Vec3 a(1, 0, 0), b(3, 0, 0);
  const auto before = point_segment_distance({0, 2, 0}, a, b);
  EXPECT_EQ(before.region, EdgeRegion::start);
  EXPECT_EQ(before.distance_sq, 5);
  const auto after = point_segment_distance({4, 0, 2}, a, b);
  EXPECT_EQ(after.region, EdgeRegion::end);
  EXPECT_EQ(after.distance_sq, 5);
  const auto between = point_segment_distance({1.5, 2, 0}, a, b);
  EXPECT_EQ(between.region, EdgeRegion::interior);
  EXPECT_EQ(between.t, 0.25);
  EXPECT_EQ(between.distance(), 2);
}

TEST(PointSegment, OfNoLengthIsAPoint) {
  EXPECT_EQ(point_segment_distance({3, 4, 0}, Vec3::Zero(), Vec3::Zero()).distance(), 5);
  EXPECT_EQ(point_segment_distance({3, 4, 0}, Vec3::Zero(), {1e-170, 0, 0}).distance(), 5)
      << "its square is 0";
}

// --- Points and triangles ---

/// Points constructed in a region: above a point of the feature, outwards within the cone of directions for
/// which the feature is closest.
TEST(PointTriangle, EveryVoronoiRegion) {
  Random random(1);
  for (int trial = 0; trial < 1000; ++trial) {
    const auto x = test::random_points(random, 3);
    const Vec3 n = (x[1] - x[0]).cross(x[2] - x[0]);
    if (n.norm() < 0.1) continue;  // thin ones have their own test
    const auto out_of = [&](int i) { return Vec3((x[(i + 1) % 3] - x[i]).cross(n).normalized()); };
    const double height = random.uniform(-1, 1), out = random.uniform(0.01, 1),
                 more = random.uniform(0.01, 1);
    for (int i = 0; i < 3; ++i) {
      const int j = (i + 1) % 3;
      const double t = random.uniform(0.01, 0.99);
      const Vec3 on_edge = (1 - t) * x[i] + t * x[j];
      const Vec3 over_edge = on_edge + out * out_of(i) + height * n;
      const auto edge = point_triangle_distance(over_edge, x[0], x[1], x[2]);
      EXPECT_EQ(edge.region, static_cast<TriangleRegion>(3 + i));
      EXPECT_NEAR(edge.weights[j], t, 1e-13) << "rounding over an edge length of 0.1";
      EXPECT_NEAR(edge.distance(), (over_edge - on_edge).norm(), kDistanceTolerance * 5);

      // The cone at corner j: the way out of both sides there, widened by their own directions.
      const Vec3 over_corner = x[j] + out * out_of(i) + more * out_of(j) + height * n;
      const auto corner = point_triangle_distance(over_corner, x[0], x[1], x[2]);
      EXPECT_EQ(corner.region, static_cast<TriangleRegion>(j));
      EXPECT_EQ(corner.weights, Vec3::Unit(j));
      EXPECT_NEAR(corner.distance(), (over_corner - x[j]).norm(), kDistanceTolerance * 5);
    }
    Vec3 w(random.uniform(0.01, 1), random.uniform(0.01, 1), random.uniform(0.01, 1));
    w /= w.sum();
    const auto face = point_triangle_distance(point_at(w, x[0], x[1], x[2]) + height * n, x[0], x[1], x[2]);
    EXPECT_EQ(face.region, TriangleRegion::face);
    EXPECT_LT((face.weights - w).norm(), 1e-12) << "rounding over an area of 0.05";
    EXPECT_NEAR(face.distance(), std::abs(height) * n.norm(), kDistanceTolerance * 5);
  }
}

TEST(PointTriangle, IsExactlyZeroAtTheCorners) {
  Random random(2);
  for (int trial = 0; trial < 1000; ++trial) {
    const auto x = test::unlucky_points(random, 3);
    for (const Vec3& p : x) EXPECT_EQ(point_triangle_distance(p, x[0], x[1], x[2]).distance_sq, 0);
  }
}

TEST(PointTriangle, AgreesWithTheSlowSearch) {
  Claim claim;
  Random random(3);
  for (int trial = 0; trial < 1'000'000; ++trial) {
    check_point_triangle<long double>(claim, test::random_points(random, 4));
  }
  claim.expect();
}

TEST(PointTriangle, AgreesWithTheSlowSearchOnUnluckyInput) {
  Claim claim;
  Random random(4);
  for (int trial = 0; trial < 200'000; ++trial)
    check_point_triangle<Quad>(claim, test::unlucky_points(random, 4));
  claim.expect();
}

/// Needles of all aspect ratios with points over them: areas lose digits there.
TEST(PointTriangle, AgreesWithTheSlowSearchOnNeedles) {
  Claim claim;
  Random random(5);
  for (int trial = 0; trial < 100'000; ++trial) {
    auto x = test::random_points(random, 4);
    const double thin = test::random_size(random, -18, 0);
    const int tip = 1 + test::pick(random, 3);
    const Vec3 &base0 = x[1 + tip % 3], &base1 = x[1 + (tip + 1) % 3];
    x[tip] = base0 + random.uniform(-0.2, 1.2) * (base1 - base0) + test::random_vector(random, thin);
    Vec3 w(random.uniform(0, 1), random.uniform(0, 1), random.uniform(0, 1));
    w /= w.sum();
    x[0] = point_at(w, x[1], x[2], x[3]) + test::random_vector(random, test::random_size(random, -18, 1));
    check_point_triangle<Quad>(claim, x);
  }
  claim.expect();
}

// --- Edges ---

/// Edges placed at the ends of a common perpendicular n: a feature's interior is closest if the edge is
/// across n, an end if the edge leads away from the other.
TEST(EdgeEdge, EveryPairOfRegions) {
  Random random(6);
  for (int trial = 0; trial < 1000; ++trial) {
    const Mat3 frame = test::random_rotation(random);
    const Vec3 n = frame.col(0);
    const double d = random.uniform(0.1, 2), angle = random.uniform(0.3, 2.8);
    const Vec3 u = frame.col(1), v = std::cos(angle) * frame.col(1) + std::sin(angle) * frame.col(2);
    const Vec3 qa = test::random_vector(random, 1), qb = qa + d * n;
    const auto edge = [&](EdgeRegion region, const Vec3& q, const Vec3& along, const Vec3& away, double t) {
      if (region == EdgeRegion::interior) return std::pair<Vec3, Vec3>(q - t * along, q + (1 - t) * along);
      const Vec3 far = q + along + random.uniform(0.01, 1) * away;
      return region == EdgeRegion::start ? std::pair(q, far) : std::pair(far, q);
    };
    for (const EdgeRegion region_a : {EdgeRegion::start, EdgeRegion::end, EdgeRegion::interior}) {
      for (const EdgeRegion region_b : {EdgeRegion::start, EdgeRegion::end, EdgeRegion::interior}) {
        const double s = random.uniform(0.01, 0.99), t = random.uniform(0.01, 0.99);
        const auto [a0, a1] = edge(region_a, qa, u, -n, s);
        const auto [b0, b1] = edge(region_b, qb, v, n, t);
        const EdgeEdgeDistance found = edge_edge_distance(a0, a1, b0, b1);
        EXPECT_EQ(found.region_a, region_a);
        EXPECT_EQ(found.region_b, region_b);
        EXPECT_NEAR(found.distance(), d, kDistanceTolerance * 5);
        // The tolerance is rounding over sin 0.3.
        EXPECT_NEAR(found.s, region_a == EdgeRegion::interior ? s : region_a == EdgeRegion::end, 1e-13);
        EXPECT_NEAR(found.t, region_b == EdgeRegion::interior ? t : region_b == EdgeRegion::end, 1e-13);
      }
    }
  }
}

TEST(EdgeEdge, AgreesWithTheSlowSearch) {
  Claim claim;
  Random random(7);
  for (int trial = 0; trial < 1'000'000; ++trial) {
    check_edge_edge<long double>(claim, test::random_points(random, 4));
  }
  claim.expect();
}

TEST(EdgeEdge, AgreesWithTheSlowSearchOnUnluckyInput) {
  Claim claim;
  Random random(8);
  for (int trial = 0; trial < 120'000; ++trial) check_edge_edge<Quad>(claim, test::unlucky_points(random, 4));
  claim.expect();
}

/// Angles from 1e-18 to 1, at distances from 1e-18 to 10, edges of lengths from 1e-6 to 1.
TEST(EdgeEdge, AgreesWithTheSlowSearchCloseToParallel) {
  Claim claim;
  Random random(9);
  for (int trial = 0; trial < 100'000; ++trial) {
    auto x = test::random_points(random, 4);
    const Vec3 u = x[1] - x[0];
    const double length = test::random_size(random, -6, 0);
    const Vec3 v = random.uniform(-1, 1) * u + test::random_vector(random, test::random_size(random, -18, 0));
    const Vec3 middle =
        x[0] + random.uniform(-0.5, 1.5) * u + test::random_vector(random, test::random_size(random, -18, 1));
    const double t = random.uniform(0, 1);
    x[2] = middle - t * length * v;
    x[3] = middle + (1 - t) * length * v;
    check_edge_edge<Quad>(claim, x);
  }
  claim.expect();
}

TEST(EdgeEdge, OfParallelEdgesTakesTheMiddleOfTheirOverlap) {
  const Vec3 a0(0, 0, 0), a1(4, 0, 0), b0(3, 1, 0), b1(9, 1, 0);  // overlapping for 3 <= x <= 4
  for (const bool turn_a : {false, true}) {
    for (const bool turn_b : {false, true}) {
      const auto d =
          edge_edge_distance(turn_a ? a1 : a0, turn_a ? a0 : a1, turn_b ? b1 : b0, turn_b ? b0 : b1);
      EXPECT_EQ(turn_a ? 1 - d.s : d.s, 3.5 / 4);
      EXPECT_NEAR(turn_b ? 1 - d.t : d.t, 0.5 / 6, kRounding);
      EXPECT_NEAR(d.distance(), 1, kRounding);
    }
  }
  const auto apart = edge_edge_distance(a0, a1, {7, 4, 0}, {9, 4, 0});
  EXPECT_EQ(apart.region_a, EdgeRegion::end);
  EXPECT_EQ(apart.region_b, EdgeRegion::start);
  EXPECT_EQ(apart.distance(), 5);
}

TEST(EdgeEdge, OfNoLengthArePoints) {
  const Vec3 p(1, 2, 3), a(0, 0, 3), b(2, 0, 3);
  EXPECT_EQ(edge_edge_distance(p, p, a, b).distance(), 2);
  EXPECT_EQ(edge_edge_distance(p, p, a, b).t, 0.5);
  EXPECT_EQ(edge_edge_distance(a, b, p, p).s, 0.5);
  EXPECT_EQ(edge_edge_distance(p, p, a, a).distance_sq, 5);
  EXPECT_EQ(edge_edge_distance(p, p, p, p).distance_sq, 0);
}

// --- Segments and triangles ---

TEST(SegmentTriangle, IsExactlyZeroWhereTheyCross) {
  Random random(10);
  for (int trial = 0; trial < 100'000; ++trial) {
    const auto x = test::random_points(random, 4);
    Vec3 w(random.uniform(0, 1), random.uniform(0, 1), random.uniform(0, 1));
    w /= w.sum();
    const Vec3 q = point_at(w, x[0], x[1], x[2]);
    const double t = random.uniform(0.1, 0.9);
    const auto d = segment_triangle_distance(q - t * x[3], q + (1 - t) * x[3], x[0], x[1], x[2]);
    ASSERT_EQ(d.distance_sq, 0);
  }
}

TEST(SegmentTriangle, AgreesWithTheSlowSearch) {
  Claim claim;
  Random random(11);
  for (int trial = 0; trial < 200'000; ++trial) {
    check_segment_triangle<long double>(claim, test::random_points(random, 5));
  }
  claim.expect();
}

TEST(SegmentTriangle, AgreesWithTheSlowSearchOnUnluckyInput) {
  Claim claim;
  Random random(12);
  for (int trial = 0; trial < 30'000; ++trial)
    check_segment_triangle<Quad>(claim, test::unlucky_points(random, 5));
  claim.expect();
}

// --- Properties of all distances ---

/// The largest difference between w_i n and the central difference of the distance, over all corners.
template <class Distance>
double gradient_error(std::vector<Vec3> x, const std::vector<double>& weights, const Distance& distance) {
  constexpr double kDelta = 1e-6;
  Vec3 n = Vec3::Zero();
  for (std::size_t i = 0; i < x.size(); ++i) n += weights[i] * x[i];
  n.normalize();
  double worst = 0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    for (int k = 0; k < 3; ++k) {
      const double here = x[i][k];
      x[i][k] = here + kDelta;
      const double above = distance(x);
      x[i][k] = here - kDelta;
      const double below = distance(x);
      x[i][k] = here;
      worst = std::max(worst, std::abs((above - below) / (2 * kDelta) - weights[i] * n[k]));
    }
  }
  return worst;
}

/// Rounding 1e-16/1e-6, and the curvature's jump between regions, 1e-6 over distances and (for edges, sines
/// of) sizes of at least 0.1.
constexpr double kGradientTolerance = 1e-4;

TEST(PointTriangle, GradientIsTheWeightsTimesTheDirection) {
  Random random(13);
  for (int trial = 0; trial < 20'000; ++trial) {
    const auto x = test::random_points(random, 4);
    const auto d = point_triangle_distance(x[0], x[1], x[2], x[3]);
    if (d.distance() < 0.1 || (x[2] - x[1]).cross(x[3] - x[1]).norm() < 0.1) continue;
    const double error = gradient_error(
        x, {1, -d.weights[0], -d.weights[1], -d.weights[2]},
        [](const auto& y) { return point_triangle_distance(y[0], y[1], y[2], y[3]).distance(); });
    EXPECT_LT(error, kGradientTolerance);
  }
}

TEST(EdgeEdge, GradientIsTheWeightsTimesTheDirection) {
  Random random(14);
  for (int trial = 0; trial < 20'000; ++trial) {
    const auto x = test::random_points(random, 4);
    const auto d = edge_edge_distance(x[0], x[1], x[2], x[3]);
    if (d.distance() < 0.1 || (x[1] - x[0]).cross(x[3] - x[2]).norm() < 0.1) continue;
    const double error = gradient_error(x, {1 - d.s, d.s, d.t - 1, -d.t}, [](const auto& y) {
      return edge_edge_distance(y[0], y[1], y[2], y[3]).distance();
    });
    EXPECT_LT(error, kGradientTolerance);
  }
}

TEST(Distances, DoNotDependOnTheOrderOfCorners) {
  Random random(15);
  for (int trial = 0; trial < 20'000; ++trial) {
    const auto x = test::unlucky_points(random, 5);
    const double tolerance = 2 * kDistanceTolerance * test::spread(x);
    const double triangle = point_triangle_distance(x[0], x[1], x[2], x[3]).distance();
    std::array<int, 3> order = {1, 2, 3};
    while (std::next_permutation(order.begin(), order.end())) {
      const auto d = point_triangle_distance(x[0], x[order[0]], x[order[1]], x[order[2]]);
      EXPECT_NEAR(d.distance(), triangle, tolerance);
    }
    const double edges = edge_edge_distance(x[0], x[1], x[2], x[3]).distance();
    EXPECT_NEAR(edge_edge_distance(x[2], x[3], x[0], x[1]).distance(), edges, tolerance);
    EXPECT_NEAR(edge_edge_distance(x[1], x[0], x[3], x[2]).distance(), edges, tolerance);
    const double through = segment_triangle_distance(x[0], x[1], x[2], x[3], x[4]).distance();
    EXPECT_NEAR(segment_triangle_distance(x[1], x[0], x[4], x[3], x[2]).distance(), through, tolerance);
  }
}

TEST(Distances, AreTheSameAtEverySizeToTheBit) {
  Random random(17);
  for (int trial = 0; trial < 20'000; ++trial) {
    const auto x = test::random_points(random, 5);
    for (const double size : {0x1p-199, 0x1p-30, 0x1p20, 0x1p199}) {  // 1e-60 … 1e60
      auto y = x;
      for (Vec3& p : y) p *= size;
      const auto point = point_triangle_distance(x[0], x[1], x[2], x[3]);
      const auto point_scaled = point_triangle_distance(y[0], y[1], y[2], y[3]);
      EXPECT_EQ(point_scaled.distance(), size * point.distance());
      EXPECT_EQ(point_scaled.weights, point.weights);
      const auto edge = edge_edge_distance(x[0], x[1], x[2], x[3]);
      const auto edge_scaled = edge_edge_distance(y[0], y[1], y[2], y[3]);
      EXPECT_EQ(edge_scaled.distance(), size * edge.distance());
      EXPECT_EQ(edge_scaled.s, edge.s);
      const auto segment = segment_triangle_distance(x[0], x[1], x[2], x[3], x[4]);
      const auto segment_scaled = segment_triangle_distance(y[0], y[1], y[2], y[3], y[4]);
      EXPECT_EQ(segment_scaled.distance(), size * segment.distance());
      EXPECT_EQ(segment_scaled.s, segment.s);
    }
  }
}

TEST(Distances, AreTheSameAfterARigidMotion) {
  Random random(16);
  for (int trial = 0; trial < 20'000; ++trial) {
    const auto x = test::random_points(random, 5);
    const Mat3 rotation = test::random_rotation(random);
    const Vec3 translation = test::random_vector(random, 10);
    auto y = x;
    for (Vec3& p : y) p = rotation * p + translation;
    constexpr double kMotion = 2e-14;  // the motion's own rounding, of coordinates up to 12
    EXPECT_NEAR(point_triangle_distance(x[0], x[1], x[2], x[3]).distance(),
                point_triangle_distance(y[0], y[1], y[2], y[3]).distance(), kMotion);
    EXPECT_NEAR(edge_edge_distance(x[0], x[1], x[2], x[3]).distance(),
                edge_edge_distance(y[0], y[1], y[2], y[3]).distance(), kMotion);
    EXPECT_NEAR(segment_triangle_distance(x[0], x[1], x[2], x[3], x[4]).distance(),
                segment_triangle_distance(y[0], y[1], y[2], y[3], y[4]).distance(), kMotion);
  }
}

}  // namespace
}  // namespace weft::engine
