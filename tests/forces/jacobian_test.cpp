/// Jacobians of forces and gradients of energies against central differences.

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>

#include "tests/support.h"
#include "weft/forces/damping.h"
#include "weft/forces/gravity.h"
#include "weft/forces/spring.h"
#include "weft/forces/wind.h"

namespace weft::engine {
namespace {

constexpr double kDelta = 1e-6;

/// Central difference of a vector function of a vector.
template <class F>
Mat3 difference(const F& f, const Vec3& x) {
  Mat3 jacobian;
  for (int c = 0; c < 3; ++c) {
    const Vec3 e = kDelta * Vec3::Unit(c);
    jacobian.col(c) = (f(Vec3(x + e)) - f(Vec3(x - e))) / (2 * kDelta);
  }
  return jacobian;
}

template <class F>
Vec3 gradient(const F& f, const Vec3& x) {
  Vec3 g;
  for (int c = 0; c < 3; ++c) {
    const Vec3 e = kDelta * Vec3::Unit(c);
    g[c] = (f(Vec3(x + e)) - f(Vec3(x - e))) / (2 * kDelta);
  }
  return g;
}

/// The differences' own error: rounding 1e-16/1e-6 and curvature 1e-12, times values up to some thousands.
constexpr double kTolerance = 2e-5;

TEST(SpringForce, IsTheGradientOfItsEnergy) {
  Random random(7);
  for (int trial = 0; trial < 100; ++trial) {
    const Vec3 d = test::random_vector(random, 1);
    if (d.norm() < 0.1) continue;
    const Vec3 expected = gradient([](const Vec3& x) { return spring_energy(200, 0.7, x); }, d);
    EXPECT_LT((spring_force(200, 0.7, d) - expected).norm(), kTolerance);
  }
}

TEST(SpringJacobian, AgreesWithDifferencesStretchedAndCompressed) {
  Random random(7);
  for (int trial = 0; trial < 100; ++trial) {
    const Vec3 d = test::random_vector(random, 1);
    if (d.norm() < 0.1) continue;
    const Mat3 expected = difference([](const Vec3& x) { return spring_force(200, 0.7, x); }, d);
    EXPECT_LT((spring_jacobian(200, 0.7, d) - expected).norm(), kTolerance * 10);
  }
}

TEST(SpringJacobian, ClampedIsTheSameWhenStretchedAndNeverIndefinite) {
  Random random(9);
  for (int trial = 0; trial < 100; ++trial) {
    const Vec3 d = test::random_vector(random, 1);
    if (d.norm() > 0.7) {
      EXPECT_LT((spring_jacobian_clamped(200, 0.7, d) - spring_jacobian(200, 0.7, d)).norm(), 1e-9);
    }
    const Eigen::SelfAdjointEigenSolver<Mat3> eigen(spring_jacobian_clamped(200, 0.7, d));
    EXPECT_GT(eigen.eigenvalues().minCoeff(), -1e-10);
  }
}

TEST(SpringForce, OfCoincidentEndsIsZeroNotNaN) {
  EXPECT_EQ(spring_force(200, 0.7, Vec3::Zero()), Vec3::Zero());
  EXPECT_TRUE(spring_jacobian(200, 0.7, Vec3::Zero()).allFinite());
  EXPECT_TRUE(spring_jacobian_clamped(200, 0.7, Vec3::Zero()).allFinite());
  EXPECT_EQ(projected_damping_force(3, Vec3::Zero(), Vec3::Ones()), Vec3::Zero());
  EXPECT_EQ(projected_damping_jacobian(3, Vec3::Zero()), Mat3::Zero());
}

TEST(Damping, JacobiansAgreeWithDifferences) {
  Random random(11);
  for (int trial = 0; trial < 100; ++trial) {
    const Vec3 d = test::random_vector(random, 1), w = test::random_vector(random, 1);
    const Mat3 plain = difference([](const Vec3& v) { return plain_damping_force(3, v); }, w);
    const Mat3 projected = difference([&](const Vec3& v) { return projected_damping_force(3, d, v); }, w);
    EXPECT_LT((plain_damping_jacobian(3) - plain).norm(), kTolerance);
    EXPECT_LT((projected_damping_jacobian(3, d) - projected).norm(), kTolerance);
  }
}

TEST(Damping, OpposesTheRelativeVelocity) {
  const Vec3 d(1, 2, 0), w(0.3, -0.2, 0.5);  // the force on i pulls it along with j
  EXPECT_GT(plain_damping_force(3, w).dot(w), 0);
  EXPECT_GT(projected_damping_force(3, d, w).dot(w), 0);
}

TEST(Damping, ProjectedLeavesARigidRotationAlone) {
  const Vec3 d(1, 2, 0), omega(0.3, 0.4, -2);
  const Vec3 w = omega.cross(d);
  EXPECT_LT(projected_damping_force(3, d, w).norm(), 1e-12);
  EXPECT_GT(plain_damping_force(3, w).norm(), 1);
}

TEST(Wind, JacobianAgreesWithDifferences) {
  const Wind wind{.velocity = {3, 1, -2}, .drag = 0.4};
  const Mat3 expected = difference([&](const Vec3& v) { return wind_force(wind, 0.02, v); }, Vec3(1, 2, 3));
  EXPECT_LT((wind_jacobian(wind, 0.02) - expected).norm(), kTolerance);
}

TEST(Gravity, IsTheGradientOfItsEnergy) {
  const Vec3 g(0.5, -9.81, 0.1);
  const Vec3 expected = -gradient([&](const Vec3& x) { return gravity_energy(0.3, g, x); }, Vec3(1, 2, 3));
  EXPECT_LT((gravity_force(0.3, g) - expected).norm(), kTolerance);
}

}  // namespace
}  // namespace weft::engine
