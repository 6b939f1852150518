#include "weft/animation/animation_curve.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "weft/core/random.h"

namespace weft::engine {
namespace {

std::vector<double> value_at(const AnimationCurve& curve, double time, std::size_t width) {
  std::vector<double> value(width);
  evaluate(curve, time, value);
  return value;
}

std::vector<double> random_numbers(Random& random, std::size_t count) {
  std::vector<double> numbers(count);
  for (double& x : numbers) x = random.uniform(-3, 3);
  return numbers;
}

/// Keys of a rotation about `axis`, with quaternions of the given signs and lengths.
AnimationCurve rotation_keys(const Vec3& axis, const std::vector<double>& angles,
                             const std::vector<double>& factors) {
  AnimationCurve curve;
  for (std::size_t k = 0; k < angles.size(); ++k) {
    curve.times.push_back(static_cast<double>(k));
    const Eigen::Vector4d q =
        factors[k] * Eigen::Quaterniond(Eigen::AngleAxisd(angles[k], axis.normalized())).coeffs();
    curve.values.insert(curve.values.end(), q.begin(), q.end());
  }
  return curve;
}

TEST(AnimationCurve, InterpolatesLinearlyBetweenKeysAndIsConstantOutside) {
  const AnimationCurve curve{.times = {1, 2, 4}, .values = {0, 1, 2, -1, 2, 7}};
  using Pair = std::vector<double>;
  EXPECT_EQ(value_at(curve, -100, 2), (Pair{0, 1}));
  EXPECT_EQ(value_at(curve, 1, 2), (Pair{0, 1}));
  EXPECT_EQ(value_at(curve, 1.25, 2), (Pair{0.5, 0.5}));
  EXPECT_EQ(value_at(curve, 2, 2), (Pair{2, -1}));
  EXPECT_EQ(value_at(curve, 3, 2), (Pair{2, 3}));
  EXPECT_EQ(value_at(curve, 4, 2), (Pair{2, 7}));
  EXPECT_EQ(value_at(curve, 1e300, 2), (Pair{2, 7}));
}

TEST(AnimationCurve, StepHoldsTheValueOfTheLastKey) {
  const AnimationCurve curve{.interpolation = Interpolation::step, .times = {1, 2, 4}, .values = {5, 6, 7}};
  for (const auto& [time, expected] : {std::pair{0.0, 5.0},
                                       {1.0, 5.0},
                                       {std::nextafter(2.0, 0.0), 5.0},
                                       {2.0, 6.0},
                                       {3.9, 6.0},
                                       {4.0, 7.0},
                                       {9.0, 7.0}}) {
    EXPECT_EQ(value_at(curve, time, 1)[0], expected) << time;
  }
}

TEST(AnimationCurve, CubicSplineIsTheFormulaOfTheSpecification) {
  Random random(3);
  constexpr std::size_t kWidth = 3;
  const AnimationCurve curve{.interpolation = Interpolation::cubic_spline,
                             .times = {-1, 0.5, 0.75, 3},
                             .values = random_numbers(random, 4 * 3 * kWidth)};
  // By key: in-tangents a, values v, out-tangents b.
  const auto part = [&](std::size_t key, std::size_t which, std::size_t k) {
    return curve.values[(3 * key + which) * kWidth + k];
  };
  for (int sample = 0; sample <= 400; ++sample) {
    const double time = -2 + 6.0 * sample / 400;
    const std::vector<double> value = value_at(curve, time, kWidth);
    for (std::size_t k = 0; k < kWidth; ++k) {
      double expected = time < 0 ? part(0, 1, k) : part(3, 1, k);
      for (std::size_t key = 0; key < 3; ++key) {
        const double td = curve.times[key + 1] - curve.times[key], t = (time - curve.times[key]) / td;
        if (t < 0 || t >= 1) continue;
        expected = (2 * std::pow(t, 3) - 3 * std::pow(t, 2) + 1) * part(key, 1, k) +
                   td * (std::pow(t, 3) - 2 * std::pow(t, 2) + t) * part(key, 2, k) +
                   (-2 * std::pow(t, 3) + 3 * std::pow(t, 2)) * part(key + 1, 1, k) +
                   td * (std::pow(t, 3) - std::pow(t, 2)) * part(key + 1, 0, k);
      }
      EXPECT_NEAR(value[k], expected, 1e-14) << time;  // four terms below 7, rounded to 4e-16 each
    }
  }
}

TEST(AnimationCurve, WithOneKeyIsConstant) {
  for (const Interpolation interpolation : {Interpolation::linear, Interpolation::step}) {
    const AnimationCurve curve{.interpolation = interpolation, .times = {1}, .values = {5}};
    for (const double time : {0.0, 1.0, 2.0}) EXPECT_EQ(value_at(curve, time, 1)[0], 5);
  }
  const AnimationCurve spline{
      .interpolation = Interpolation::cubic_spline, .times = {1}, .values = {8, 5, 9}};
  for (const double time : {0.0, 1.0, 2.0}) EXPECT_EQ(value_at(spline, time, 1)[0], 5);
}

/// The rotations of `curve` must be those about `axis` by from + share (to − from), at many times.
void expect_arc(const AnimationCurve& curve, const Vec3& axis, double from, double to) {
  for (int sample = 0; sample <= 1000; ++sample) {
    const double share = sample / 1000.0;
    const Eigen::Quaterniond q = evaluate_rotation(curve, share);
    EXPECT_NEAR(q.norm(), 1, 1e-15);
    const Mat3 expected = Eigen::AngleAxisd(from + share * (to - from), axis.normalized()).toRotationMatrix();
    // The keys are rounded to 1e-16, twice that as angles, and so are sines, cosines and products.
    EXPECT_LT((q.toRotationMatrix() - expected).cwiseAbs().maxCoeff(), 4e-15)
        << from << " to " << to << " at " << share;
  }
}

TEST(AnimationCurve, RotatesAtConstantSpeedAlongTheShortestArc) {
  const double turn = 2 * std::numbers::pi;
  const Vec3 axis(1, -2, 0.5);
  for (const double from : {0.0, 0.3, -2.0, 3.0}) {
    for (const double by : {1e-12, 1e-8, 1e-3, 0.1, 1.0, 0.25 * turn, 0.4 * turn, 0.499 * turn}) {
      for (const double sign : {1.0, -1.0}) {
        // Opposite quaternions are the same rotation, so that the arc must not depend on their signs.
        expect_arc(rotation_keys(axis, {from, from + sign * by}, {1, 1}), axis, from, from + sign * by);
        expect_arc(rotation_keys(axis, {from, from + sign * by}, {1, -1}), axis, from, from + sign * by);
        // More than half a turn: the rest of the turn, the other way.
        expect_arc(rotation_keys(axis, {from, from + sign * (turn - by)}, {1, 1}), axis, from,
                   from - sign * by);
      }
    }
  }
}

TEST(AnimationCurve, RotationKeysNeedNotBeUnitQuaternions) {
  expect_arc(rotation_keys(Vec3::UnitX(), {0.2, 1.7}, {0.01, 1e6}), Vec3::UnitX(), 0.2, 1.7);
  AnimationCurve step = rotation_keys(Vec3::UnitX(), {0.2, 1.7}, {3, 1});
  step.interpolation = Interpolation::step;
  EXPECT_NEAR(evaluate_rotation(step, 0.9).w(), std::cos(0.1), 1e-15);
  EXPECT_NEAR(evaluate_rotation(step, 0.9).x(), std::sin(0.1), 1e-15);
}

TEST(AnimationCurve, BetweenEqualRotationsRests) {
  const AnimationCurve curve = rotation_keys({1, 1, 1}, {0.7, 0.7, 0.7 + 2 * std::numbers::pi}, {1, 1, 1});
  for (const double time : {0.0, 0.5, 1.0, 1.5, 2.0}) {
    EXPECT_LT(evaluate_rotation(curve, time).angularDistance(evaluate_rotation(curve, 0)), 1e-15) << time;
  }
}

TEST(AnimationCurve, CubicSplineOfRotationsIsNormalised) {
  Random random(5);
  const AnimationCurve curve{.interpolation = Interpolation::cubic_spline,
                             .times = {0, 2},
                             .values = random_numbers(random, 2 * 3 * 4)};
  for (int sample = -10; sample <= 30; ++sample) {
    const double time = sample / 10.0;
    const Eigen::Vector4d expected = Eigen::Map<const Eigen::Vector4d>(value_at(curve, time, 4).data());
    const Eigen::Quaterniond q = evaluate_rotation(curve, time);
    EXPECT_NEAR(q.norm(), 1, 1e-15);
    EXPECT_LT((q.coeffs() - expected / expected.norm()).norm(), 1e-15) << time;
  }
  // From a quaternion to its opposite with flat tangents: zero halfway, and no NaN.
  const AnimationCurve through_zero{.interpolation = Interpolation::cubic_spline,
                                    .times = {0, 1},
                                    .values = {0, 0, 0, 0, 0, 0, 0, 1,  0, 0, 0, 0,  //
                                               0, 0, 0, 0, 0, 0, 0, -1, 0, 0, 0, 0}};
  EXPECT_EQ(evaluate_rotation(through_zero, 0.5).toRotationMatrix(), Mat3::Identity());
}

}  // namespace
}  // namespace weft::engine
