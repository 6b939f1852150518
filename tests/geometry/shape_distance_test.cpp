#include "weft/geometry/shape_distance.h"

#include <gtest/gtest.h>

#include "tests/geometry/slow_distance.h"

namespace weft::engine {
namespace {

using Corners = std::vector<Vec3>;  // three corners

Vec3 at(const Vec3& w, const Corners& x) { return w[0] * x[0] + w[1] * x[1] + w[2] * x[2]; }

template <class Shape>
TriangleSignedDistance distance_of(const Shape& shape, const Corners& x, double reach = kNoReach) {
  return signed_distance(shape, x[0], x[1], x[2], reach);
}

Sphere random_sphere(Random& random) {
  return {.center = test::random_vector(random, 0.5), .radius = random.uniform(0.1, 1)};
}

Capsule random_capsule(Random& random) {
  const Vec3 a = test::random_vector(random, 1);
  const Vec3 b = test::pick(random, 10) == 0 ? a : test::random_vector(random, 1);
  return {.a = a, .b = b, .radius = random.uniform(0.01, 0.5)};
}

/// A slab, a rod, a cube, or any box; every other one upright.
OrientedBox random_box(Random& random) {
  OrientedBox box;
  box.center = test::random_vector(random, 0.3);
  for (int k = 0; k < 3; ++k) box.half_size[k] = test::pick(random, 3) == 0 ? 0.3 : random.uniform(0.05, 1);
  if (test::pick(random, 2) == 0) box.rotation = test::random_rotation(random);
  return box;
}

/// Small and large triangles, edges, points, and triangles flat on a face of the box or through its middle.
Corners random_triangle(Random& random, const OrientedBox& box) {
  if (test::pick(random, 4) == 0) return test::unlucky_points(random, 3);
  const double size = test::random_size(random, -2, 0.7);
  const Vec3 place = test::random_vector(random, 1.5);
  Corners x(3);
  for (Vec3& p : x) p = place + test::random_vector(random, size);
  const int kind = test::pick(random, 8);
  if (kind == 0) x[2] = x[0] + random.uniform(0, 1) * (x[1] - x[0]);
  if (kind == 1) x[1] = x[2] = x[0];
  if (kind == 2 || kind == 3) {
    const int k = test::pick(random, 3);
    for (Vec3& p : x) p[k] = kind == 2 ? box.half_size[k] : 0;
    for (Vec3& p : x) p = box.center + box.rotation * p;
  }
  return x;
}

// --- Points ---

TEST(PointSignedDistance, OfEveryShape) {
  const Capsule capsule{.a = {0, 0, 0}, .b = {2, 0, 0}, .radius = 0.5};
  EXPECT_EQ(signed_distance(capsule, Vec3(1, 2, 0)).distance, 1.5);
  EXPECT_EQ(signed_distance(capsule, Vec3(1, 0, 0.25)).distance, -0.25);
  EXPECT_EQ(signed_distance(capsule, Vec3(4, 0, 0)).distance, 1.5);
  EXPECT_EQ(signed_distance(capsule, Vec3(4, 0, 0)).normal, Vec3::UnitX());
  const OrientedBox box{.center = {1, 0, 0}, .half_size = {1, 2, 3}};
  EXPECT_EQ(signed_distance(box, Vec3(5, 0, 0)).distance, 3);
  EXPECT_EQ(signed_distance(box, Vec3(5, 6, 3)).distance, 5);
  EXPECT_EQ(signed_distance(box, Vec3(0.25, 0, 0)).distance, -0.25);
  EXPECT_EQ(signed_distance(box, Vec3(0.25, 0, 0)).normal, -Vec3::UnitX());
  EXPECT_EQ(signed_distance(Sphere{Vec3::Zero(), 1}, Vec3(0, 0, 3)).distance, 2);
  EXPECT_EQ(signed_distance(Plane{}, Vec3(7, -2, 0)).distance, -2);
}

TEST(PointSignedDistance, HasANormalWhereAllDirectionsAreAlike) {
  EXPECT_EQ(signed_distance(Sphere{}, Vec3(Vec3::Zero())).normal, Vec3::UnitY());
  EXPECT_EQ(signed_distance(OrientedBox{}, Vec3(Vec3::Zero())).normal, Vec3::UnitX());
  EXPECT_EQ(signed_distance(Capsule{}, Vec3(0, 0.5, 0)).normal, Vec3::UnitX()) << "across an upright axis";
  const Capsule lying{.a = {-1, 0, 0}, .b = {1, 0, 0}, .radius = 0.5};
  EXPECT_EQ(signed_distance(lying, Vec3(0.5, 0, 0)).normal, Vec3::UnitY());
  const Capsule none{.a = {0, 0, 0}, .b = {0, 0, 0}, .radius = 0.5};
  EXPECT_EQ(signed_distance(none, Vec3(Vec3::Zero())).normal, Vec3::UnitY());
}

/// Central differences of 1e-6 fail where the gradient jumps (inside a box): not met in these trials.
template <class Shape>
double normal_error(const Shape& shape, const Vec3& p) {
  constexpr double kDelta = 1e-6;
  const SignedDistance here = signed_distance(shape, p);
  Vec3 gradient;
  for (int k = 0; k < 3; ++k) {
    const Vec3 e = kDelta * Vec3::Unit(k);
    gradient[k] =
        (signed_distance(shape, Vec3(p + e)).distance - signed_distance(shape, Vec3(p - e)).distance) /
        (2 * kDelta);
  }
  return (gradient - here.normal).norm();
}

TEST(PointSignedDistance, NormalIsItsGradient) {
  constexpr double kTolerance =
      1e-4;  // 1e-6 over distances of at least 0.01 from an axis, a centre or an edge
  Random random(1);
  int num_off = 0;
  for (int trial = 0; trial < 100'000; ++trial) {
    const Vec3 p = test::random_vector(random, 2);
    const Sphere sphere = random_sphere(random);
    const Capsule capsule = random_capsule(random);
    const double d_axis = signed_distance(capsule, p).distance + capsule.radius;
    EXPECT_TRUE((p - sphere.center).norm() < 0.01 || normal_error(sphere, p) < kTolerance);
    EXPECT_TRUE(d_axis < 0.01 || normal_error(capsule, p) < kTolerance);
    num_off += normal_error(random_box(random), p) > kTolerance;
  }
  EXPECT_LT(num_off, 20) << "only within 1e-6 of where two faces are equally far, or 0.01 of a box's edge";
}

// --- Triangles, against a search that does not depend on the shape ---

/// Golden section search along each coordinate alternately: an upper bound for the minimum of a convex
/// function on the triangle.
template <class Function>
double golden_minimum(const Function& f, double high, double accuracy) {
  constexpr double kGolden = 0.6180339887498949;
  double low = 0, left = high * (1 - kGolden), right = high * kGolden;
  double f_left = f(left), f_right = f(right);
  double best = std::min({f(0.0), f(high), f_left, f_right});
  while (high - low > accuracy) {
    if (f_left < f_right) {
      high = right;
      right = left;
      f_right = f_left;
      left = low + (1 - kGolden) * (high - low);
      f_left = f(left);
      best = std::min(best, f_left);
    } else {
      low = left;
      left = right;
      f_left = f_right;
      right = low + kGolden * (high - low);
      f_right = f(right);
      best = std::min(best, f_right);
    }
  }
  return best;
}

template <class Shape>
double searched_minimum(const Shape& shape, const Corners& x, double accuracy) {
  const Vec3 e = x[1] - x[0], g = x[2] - x[0];
  return golden_minimum(
      [&](double s) {
        const Vec3 start = x[0] + s * e;
        return golden_minimum([&](double t) { return signed_distance(shape, Vec3(start + t * g)).distance; },
                              1 - s, accuracy);
      },
      1, accuracy);
}

/// Requirements on every result: the weights are a point of the triangle, the distance is that point's, the
/// normal is a unit vector.
template <class Shape>
void expect_honest(const Shape& shape, const Corners& x, const TriangleSignedDistance& d, double tolerance) {
  ASSERT_GE(d.weights.minCoeff(), 0);
  ASSERT_NEAR(d.weights.sum(), 1, 1e-15);  // a few roundings
  ASSERT_NEAR(d.normal.norm(), 1, 1e-14);
  ASSERT_NEAR(d.distance, signed_distance(shape, at(d.weights, x)).distance, tolerance);
}

/// The largest length involved for shapes of size 1.
double size_of(const Corners& x) { return 1 + std::max({x[0].norm(), x[1].norm(), x[2].norm()}); }

template <class Shape>
void expect_smallest(const Shape& shape, const Corners& x) {
  const TriangleSignedDistance d = distance_of(shape, x);
  const double size = size_of(x);
  expect_honest(shape, x, d, 2e-14 * size);
  // Never above the searched minimum, which exceeds the true one by no more than its accuracy.
  constexpr double kAccuracy = 1e-5;
  const double searched = searched_minimum(shape, x, kAccuracy);
  ASSERT_LE(d.distance, searched + 2e-14 * size);
  ASSERT_GE(d.distance, searched - 4 * kAccuracy * test::spread(x) - 2e-14 * size);
}

TEST(TriangleSignedDistance, OfASphereIsTheSmallestOfItsPoints) {
  Random random(2);
  for (int trial = 0; trial < 100'000; ++trial) {
    const Corners x = random_triangle(random, {});
    expect_smallest(random_sphere(random), x);
    if (HasFatalFailure()) FAIL() << trial;
  }
}

TEST(TriangleSignedDistance, OfACapsuleIsTheSmallestOfItsPoints) {
  Random random(3);
  for (int trial = 0; trial < 100'000; ++trial) {
    const Corners x = random_triangle(random, {});
    expect_smallest(random_capsule(random), x);
    if (HasFatalFailure()) FAIL() << trial;
  }
}

TEST(TriangleSignedDistance, OfABoxIsTheSmallestOfItsPoints) {
  Random random(4);
  for (int trial = 0; trial < 100'000; ++trial) {
    const OrientedBox box = random_box(random);
    expect_smallest(box, random_triangle(random, box));
    if (HasFatalFailure()) FAIL() << trial;
  }
}

TEST(TriangleSignedDistance, OfAPlaneIsThatOfTheLowestCorner) {
  Random random(5);
  for (int trial = 0; trial < 100'000; ++trial) {
    const Plane plane{.point = test::random_vector(random, 1), .normal = test::random_unit(random)};
    const Corners x = random_triangle(random, {});
    const TriangleSignedDistance d = distance_of(plane, x);
    expect_honest(plane, x, d, 2e-14 * size_of(x));
    for (const Vec3& p : x) ASSERT_LE(d.distance, signed_distance(plane, p).distance);
  }
}

// --- Triangles and boxes, against proofs ---

/// The smallest f with s p_k(w) − h_k <= f for all six faces, by trying all corners of that polytope: three
/// of its nine constraints (w_0, w_1, w_2 >= 0 and the faces) met exactly, the others not broken.
long double slow_depth(const Vec3& h, const Corners& x) {
  using Real = long double;
  struct Constraint {
    std::array<Real, 3> g;  // g0 w1 + g1 w2 + g2 f >= bound
    Real bound;
  };
  std::vector<Constraint> all = {{{1, 0, 0}, 0}, {{0, 1, 0}, 0}, {{-1, -1, 0}, -1}};
  for (int k = 0; k < 3; ++k) {
    for (const int sign : {-1, 1}) {
      const Real p0 = sign * Real(x[0][k]), p1 = sign * Real(x[1][k]), p2 = sign * Real(x[2][k]);
      all.push_back({{p0 - p1, p0 - p2, 1}, p0 - Real(h[k])});
    }
  }
  Real best = std::numeric_limits<Real>::infinity();
  const auto det = [](const auto& a, const auto& b, const auto& c) {
    return a[0] * (b[1] * c[2] - b[2] * c[1]) - a[1] * (b[0] * c[2] - b[2] * c[0]) +
           a[2] * (b[0] * c[1] - b[1] * c[0]);
  };
  for (int i = 0; i < 9; ++i) {
    for (int j = 0; j < i; ++j) {
      for (int k = 0; k < j; ++k) {
        const Constraint &a = all[i], &b = all[j], &c = all[k];
        const Real d = det(a.g, b.g, c.g);
        if (d == 0) continue;
        std::array<Real, 3> y;
        for (int m = 0; m < 3; ++m) {
          auto ga = a.g, gb = b.g, gc = c.g;
          ga[m] = a.bound, gb[m] = b.bound, gc[m] = c.bound;
          y[m] = det(ga, gb, gc) / d;
        }
        const bool keeps_all = std::all_of(all.begin(), all.end(), [&](const Constraint& e) {
          return e.g[0] * y[0] + e.g[1] * y[1] + e.g[2] * y[2] >= e.bound - 1e-15L;
        });
        if (keeps_all) best = std::min(best, y[2]);
      }
    }
  }
  return best;
}

TEST(TriangleAndBox, InsideDepthIsThatOfTheLinearProgramme) {
  Random random(6);
  int num_inside = 0;
  for (int trial = 0; trial < 100'000; ++trial) {
    OrientedBox box = random_box(random);
    box.center = Vec3::Zero();
    box.rotation = Mat3::Identity();
    Corners x(3);
    const double size = test::random_size(random, -1, 0.7);
    const Vec3 place = test::random_vector(random, 0.5);
    for (Vec3& p : x) p = place + test::random_vector(random, size);
    const TriangleSignedDistance d = distance_of(box, x);
    const double depth = static_cast<double>(slow_depth(box.half_size, x));
    if (depth > 0) {
      ASSERT_GT(d.distance, 0);
      continue;
    }
    ++num_inside;
    ASSERT_NEAR(d.distance, depth, 1e-14 * size_of(x)) << trial;  // roundings of the corners' coordinates
    // The normal is that of a face at that depth.
    int k;
    ASSERT_EQ(d.normal.cwiseAbs().maxCoeff(&k), 1);
    ASSERT_NEAR(at(d.weights, x)[k] * d.normal[k] - box.half_size[k], d.distance, 1e-11) << "ties are 1e-12";
  }
  EXPECT_GT(num_inside, 30'000);
}

/// A separating plane proves the distance: the triangle is beyond it by that much, the box is not.
TEST(TriangleAndBox, OutsideDistanceIsProvedByItsNormal) {
  Random random(7);
  int num_outside = 0, num_ties = 0;
  for (int trial = 0; trial < 200'000; ++trial) {
    const OrientedBox box = random_box(random);
    const Corners x = random_triangle(random, box);
    const TriangleSignedDistance d = distance_of(box, x);
    const double size = size_of(x);
    if (d.distance < 1e-4 * size) continue;
    ++num_outside;
    const double box_end =
        d.normal.dot(box.center) + (box.rotation.transpose() * d.normal).cwiseAbs().dot(box.half_size);
    const double triangle_start = std::min({d.normal.dot(x[0]), d.normal.dot(x[1]), d.normal.dot(x[2])});
    // The normal's error, a rounding of the size over the distance, enters times the size. Between two
    // features that are equally near to within a rounding, the normals may differ by its square root.
    const double error = std::abs(triangle_start - box_end - d.distance) / (size * size / d.distance);
    ASSERT_LT(error, 2e-8) << trial;
    num_ties += error > 1e-14;
  }
  EXPECT_GT(num_outside, 50'000);
  EXPECT_LT(num_ties, 20);
}

TEST(TriangleAndBox, CornerPokesThroughTheInterior) {
  // Across the corner (1, 1, 1), all three corners of the triangle outside.
  const OrientedBox box{.half_size = {1, 1, 1}};
  const auto d =
      distance_of(box, {{3.4, -0.4, -0.4}, {-0.4, 3.4, -0.4}, {-0.4, -0.4, 3.4}});  // x + y + z = 2.6
  EXPECT_NEAR(d.distance, 2.6 / 3 - 1, 1e-15);
  EXPECT_LT((d.weights - Vec3::Constant(1.0 / 3)).norm(), 1e-15);
  const auto away = distance_of(box, {{5, -1, -1}, {-1, 5, -1}, {-1, -1, 5}});  // x + y + z = 3: touches
  EXPECT_NEAR(away.distance, 0, 1e-15);
  const auto off = distance_of(box, {{6, -1, -1}, {-1, 6, -1}, {-1, -1, 6}});  // x + y + z = 4
  EXPECT_NEAR(off.distance, 1 / std::sqrt(3.0), 1e-15);
  EXPECT_LT((off.normal - Vec3::Constant(1 / std::sqrt(3.0))).norm(), 1e-15);
}

TEST(TriangleAndBox, EdgesCross) {
  // The box's edge x = y = 1 and the triangle's across it, at 0.1 inside and at √2/2 outside.
  const OrientedBox box{.half_size = {1, 1, 1}};
  const auto inside = distance_of(box, {{2, -0.2, 0}, {-0.2, 2, 0}, {4, 4, 3}});
  EXPECT_NEAR(inside.distance, -0.1, 1e-15);
  EXPECT_LT((inside.weights - Vec3(0.5, 0.5, 0)).norm(), 1e-15);
  const auto outside = distance_of(box, {{3, 0, 0}, {0, 3, 0}, {4, 4, 3}});
  EXPECT_NEAR(outside.distance, std::sqrt(0.5), 1e-15);
  EXPECT_LT((outside.normal - Vec3(1, 1, 0).normalized()).norm(), 1e-15);
}

TEST(TriangleAndBox, WhollyInside) {
  const OrientedBox box{.half_size = {1, 2, 3}};
  const auto d = distance_of(box, {{0.5, 0, 0}, {0.7, 1, 0}, {0.6, 0, 1}});
  EXPECT_NEAR(d.distance, -0.5, 1e-15);
  EXPECT_EQ(d.weights, Vec3::UnitX());
  EXPECT_EQ(d.normal, Vec3::UnitX());
}

TEST(TriangleAndBox, FlatOnAFace) {
  const OrientedBox box{.half_size = {1, 1, 1}};
  for (const double height : {1.0, 1.25, 0.75}) {
    for (const double size : {0.3, 30.0}) {
      const auto d = distance_of(box, {{-size, height, -size}, {size, height, -size}, {0, height, size}});
      EXPECT_NEAR(d.distance, height - 1, 1e-14) << "rounding of 30";
      EXPECT_EQ(d.normal, Vec3::UnitY());
    }
  }
}

TEST(TriangleAndBox, ThroughTheMiddleIsAsDeepAsTheBoxIsThin) {
  const OrientedBox box{.half_size = {0.2, 1, 1}};
  const auto d = distance_of(box, {{-9, -9, 0.1}, {9, -9, 0.1}, {0, 9, 0.1}});
  EXPECT_NEAR(d.distance, -0.2, 1e-14);
}

TEST(TriangleAndBox, LeavesByTheShortestWayWhereFacesAreEquallyNear) {
  // A flap over the box's edge, deepest where x and y faces are equally near: 0.1 below the top, 4 from the
  // side.
  const OrientedBox box{.half_size = {1, 1, 1}};
  const auto d = distance_of(box, {{-3, 0.9, 0}, {3, 0.9, 0.1}, {0, 3, 0}});
  EXPECT_NEAR(d.distance, -0.1, 1e-14);
  EXPECT_EQ(d.normal, Vec3::UnitY());
}

// --- Triangles and round shapes ---

TEST(TriangleAndSphere, CentreOnTheTriangleHasItsNormal) {
  const auto d = distance_of(Sphere{Vec3::Zero(), 2}, {{-1, 0, -1}, {0, 0, 1}, {1, 0, -1}});
  EXPECT_EQ(d.distance, -2);
  EXPECT_EQ(d.normal, Vec3::UnitY());
  EXPECT_EQ(distance_of(Sphere{}, {Vec3::Zero(), Vec3::Zero(), Vec3::Zero()}).normal, Vec3::UnitY());
}

TEST(TriangleAndCapsule, AxisThroughTheTriangleIsPushedOffItsShorterPart) {
  const Corners x = {{-1, 0, -1}, {0, 0, 1}, {1, 0, -1}};
  for (const double sign : {1.0, -1.0}) {
    const Capsule up{.a = {0, -2 * sign, 0}, .b = {0, 1 * sign, 0}, .radius = 0.5};
    for (const auto& turned : {x, Corners{x[1], x[0], x[2]}}) {
      const auto d = distance_of(up, turned);
      EXPECT_EQ(d.distance, -0.5);
      EXPECT_LT((d.normal - sign * Vec3::UnitY()).norm(), 1e-15);
    }
    const Capsule down{.a = up.b, .b = up.a, .radius = 0.5};
    EXPECT_LT((distance_of(down, x).normal - sign * Vec3::UnitY()).norm(), 1e-15);
  }
}

TEST(TriangleAndCapsule, TheAxisCanBeNearestToAnEdgeACornerOrTheFace) {
  const Corners x = {{-1, 0, -1}, {0, 0, 1}, {1, 0, -1}};
  EXPECT_NEAR(distance_of(Capsule{.a = {-3, 0.5, -2}, .b = {3, 0.5, -2}, .radius = 0.1}, x).distance,
              std::sqrt(1.25) - 0.1, 1e-15);
  EXPECT_NEAR(distance_of(Capsule{.a = {-3, 0, 2}, .b = {3, 0, 2}, .radius = 0.1}, x).distance, 0.9, 1e-15);
  const auto face = distance_of(Capsule{.a = {0, 0.25, 0}, .b = {0, 3, 0}, .radius = 0.5}, x);
  EXPECT_NEAR(face.distance, -0.25, 1e-15);
  EXPECT_LT((face.normal + Vec3::UnitY()).norm(), 1e-15);
}

// --- Properties of all distances ---

/// ∂d/∂x_i = w_i normal where the deepest point moves smoothly: for almost all triangles outside.
template <class Shape>
double gradient_error(const Shape& shape, Corners x) {
  constexpr double kDelta = 1e-6;
  const TriangleSignedDistance d = distance_of(shape, x);
  double worst = 0;
  for (int i = 0; i < 3; ++i) {
    for (int k = 0; k < 3; ++k) {
      const double here = x[i][k];
      x[i][k] = here + kDelta;
      const double above = distance_of(shape, x).distance;
      x[i][k] = here - kDelta;
      const double below = distance_of(shape, x).distance;
      x[i][k] = here;
      worst = std::max(worst, std::abs((above - below) / (2 * kDelta) - d.weights[i] * d.normal[k]));
    }
  }
  return worst;
}

TEST(TriangleSignedDistance, GradientIsTheWeightsTimesTheNormal) {
  Random random(8);
  int num_checked = 0, num_off = 0;
  const auto check = [&](const auto& shape, const Corners& x) {
    if (distance_of(shape, x).distance < 0.1) return;
    ++num_checked;
    num_off += gradient_error(shape, x) > 1e-3;  // 1e-6 over distances of 0.1, angles of 0.01
  };
  for (int trial = 0; trial < 20'000; ++trial) {
    const Corners x = test::random_points(random, 3);
    check(random_sphere(random), x);
    check(random_capsule(random), x);
    check(random_box(random), x);
  }
  EXPECT_GT(num_checked, 10'000);
  EXPECT_LT(num_off, num_checked / 1000) << "only edges almost parallel to a box's or to an axis";
}

TEST(TriangleSignedDistance, IsTheSameAfterARigidMotion) {
  Random random(9);
  for (int trial = 0; trial < 20'000; ++trial) {
    const Mat3 rotation = test::random_rotation(random);
    const Vec3 translation = test::random_vector(random, 10);
    const auto moved = [&](const Vec3& p) { return Vec3(rotation * p + translation); };
    const Corners x = test::random_points(random, 3);
    const Corners y = {moved(x[0]), moved(x[1]), moved(x[2])};
    constexpr double kMotion = 2e-14;  // the motion's own rounding, of coordinates up to 12
    const Sphere sphere = random_sphere(random);
    EXPECT_NEAR(distance_of(sphere, x).distance,
                distance_of(Sphere{moved(sphere.center), sphere.radius}, y).distance, kMotion);
    const Capsule capsule = random_capsule(random);
    EXPECT_NEAR(distance_of(capsule, x).distance,
                distance_of(Capsule{moved(capsule.a), moved(capsule.b), capsule.radius}, y).distance,
                kMotion);
    const OrientedBox box = random_box(random);
    const OrientedBox moved_box{moved(box.center), box.half_size, rotation * box.rotation};
    EXPECT_NEAR(distance_of(box, x).distance, distance_of(moved_box, y).distance, kMotion);
  }
}

/// No point is beyond it, and one is on it.
TEST(Support, IsThePlaneThatTouchesTheShape) {
  Random random(21);
  for (int trial = 0; trial < 2000; ++trial) {
    const Vec3 normal = test::random_vector(random, 1).normalized();
    const OrientedBox box = random_box(random);
    const Capsule capsule = random_capsule(random);
    const Sphere sphere = random_sphere(random);
    const auto check = [&](const auto& shape) {
      const double most = support(shape, normal);
      for (int n = 0; n < 20; ++n) {
        const Vec3 p = test::random_vector(random, 2);
        ASSERT_TRUE(signed_distance(shape, p).distance > 0 || normal.dot(p) <= most + 1e-12);
      }
      const Vec3 far = 1e4 * normal;  // its nearest point is the support point, or almost
      const SignedDistance d = signed_distance(shape, far);
      ASSERT_NEAR(normal.dot(far - d.distance * d.normal), most, 1e-3);
    };
    check(box);
    check(capsule);
    check(sphere);
  }
}

TEST(TriangleSignedDistance, WithinReachIsTheSameAndBeyondItIsBeyond) {
  Random random(10);
  for (int trial = 0; trial < 50'000; ++trial) {
    const OrientedBox box = random_box(random);
    const Capsule capsule = random_capsule(random);
    const Sphere sphere = random_sphere(random);
    const Corners x = random_triangle(random, box);
    const double reach = random.uniform(-0.1, 0.5);
    const auto check = [&](const auto& shape) {
      const double exact = distance_of(shape, x).distance, found = distance_of(shape, x, reach).distance;
      if (exact <= reach) {
        ASSERT_EQ(found, exact);
      } else {
        ASSERT_GT(found, reach);
        ASSERT_LE(found, exact + 1e-14 * size_of(x)) << "a lower bound, but for rounding";
      }
    };
    check(box);
    check(capsule);
    check(sphere);
  }
}

}  // namespace
}  // namespace weft::engine
