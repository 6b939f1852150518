/// The triangle membrane: against finite differences, under rigid motion, and its given stiffness recovered.

#include "tests/forces/single_membrane.h"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>

#include "tests/forces/sheets.h"
#include "tests/support.h"

namespace weft::engine {
namespace {

using test::membrane_block;
using test::membrane_energy;
using test::membrane_force;
using test::membrane_hessian;
using test::MembraneHessian;

using test::SheetKind;

Mat3 make_stiffness(double c11, double c22, double c12, double g) {
  Mat3 c = Mat3::Zero();
  c(0, 0) = c11;
  c(1, 1) = c22;
  c(0, 1) = c(1, 0) = c12;
  c(2, 2) = g;
  return c;
}

const Mat3 kDenim = make_stiffness(410.7, 2027.8, 20.5, 53.4);
const RestTriangle kRest = make_rest_triangle({0, 0}, {0.9, 0.2}, {0.3, 0.8});

/// Stretched by up to a third, at random positions.
TriangleCorners random_corners(Random& random) {
  const Mat3 turn = Eigen::Quaterniond(1, random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1))
                        .normalized()
                        .toRotationMatrix();
  TriangleCorners x = {Vec3(0, 0, 0), Vec3(0.9, 0.2, 0), Vec3(0.3, 0.8, 0)};
  for (Vec3& p : x) p = turn * (p + test::random_vector(random, 0.15)) + Vec3(3, -2, 1);
  return x;
}

/// Central difference of a function of the corners along one coordinate.
template <class F>
auto difference(const F& f, TriangleCorners x, int corner, int component) -> decltype(f(x)) {
  constexpr double kDelta = 1e-5;
  x[corner][component] += kDelta;
  const auto above = f(x);
  x[corner][component] -= 2 * kDelta;
  const auto below = f(x);
  return ((above - below) / (2 * kDelta));
}

/// Error of the differences: curvature of the energy (1e3 N/m) times 1e-10, and rounding 1e-16/1e-5 times
/// 1e2.
constexpr double kTolerance = 1e-6;

TEST(Membrane, ForceIsTheGradientOfItsEnergy) {
  Random random(3);
  for (int trial = 0; trial < 50; ++trial) {
    const TriangleCorners x = random_corners(random), force = membrane_force(kRest, kDenim, x);
    const auto energy = [](const TriangleCorners& y) { return membrane_energy(kRest, kDenim, y); };
    for (int c = 0; c < 3; ++c) {
      for (int k = 0; k < 3; ++k) EXPECT_NEAR(force[c][k], -difference(energy, x, c, k), kTolerance);
    }
  }
}

TEST(Membrane, ExactHessianIsTheDerivativeOfItsForce) {
  Random random(4);
  for (int trial = 0; trial < 50; ++trial) {
    const TriangleCorners x = random_corners(random);
    const MembraneHessian hessian = membrane_hessian(kRest, kDenim, x);
    for (int a = 0; a < 3; ++a) {
      const auto force = [&](const TriangleCorners& y) { return membrane_force(kRest, kDenim, y)[a]; };
      for (int b = 0; b < 3; ++b) {
        const Mat3 block = membrane_block(hessian, a, b, StressFilter::exact);
        for (int k = 0; k < 3; ++k) {
          EXPECT_LT((block.col(k) + difference(force, x, b, k)).norm(), 10 * kTolerance);
        }
      }
    }
  }
}

/// All nine rows and columns.
Eigen::Matrix<double, 9, 9> full(const MembraneHessian& hessian, StressFilter filter) {
  Eigen::Matrix<double, 9, 9> h;
  for (int a = 0; a < 3; ++a) {
    for (int b = 0; b < 3; ++b) h.block<3, 3>(3 * a, 3 * b) = membrane_block(hessian, a, b, filter);
  }
  return h;
}

TEST(Membrane, FilteredHessianIsNeverIndefiniteAndExactUnderTension) {
  Random random(5);
  for (int trial = 0; trial < 50; ++trial) {
    TriangleCorners x = random_corners(random);
    for (Vec3& p : x) p *= 0.6;  // compressed: the exact one is indefinite
    const MembraneHessian hessian = membrane_hessian(kRest, kDenim, x);
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix<double, 9, 9>> exact(
        full(hessian, StressFilter::exact)),
        filtered(full(hessian, StressFilter::absolute));
    EXPECT_LT(exact.eigenvalues().minCoeff(), -1);
    EXPECT_GT(filtered.eigenvalues().minCoeff(), -1e-9) << "zero to rounding of 1e3";
  }
  // A right triangle under tension along its legs: all edge weights are positive, and nothing changes.
  const RestTriangle right = make_rest_triangle({0, 0}, {1, 0}, {0, 1});
  const TriangleCorners pulled = {Vec3(0, 0, 0), Vec3(1.1, 0, 0), Vec3(0, 1.1, 0)};
  const MembraneHessian hessian = membrane_hessian(right, make_stiffness(100, 100, 0, 30), pulled);
  EXPECT_EQ(full(hessian, StressFilter::exact), full(hessian, StressFilter::absolute));
}

TEST(Membrane, RigidMotionMakesNoForce) {
  Random random(6);
  const Mat3 turn = Eigen::Quaterniond(0.3, -0.5, 0.7, 0.1).normalized().toRotationMatrix();
  const TriangleCorners x = {turn * Vec3(0, 0, 0) + Vec3(5, 6, 7), turn * Vec3(0.9, 0.2, 0) + Vec3(5, 6, 7),
                             turn * Vec3(0.3, 0.8, 0) + Vec3(5, 6, 7)};
  // Rounding of positions of 10 m, 1e-15, over a triangle of 1 m, times 2000 N/m.
  for (const Vec3& f : membrane_force(kRest, kDenim, x)) EXPECT_LT(f.norm(), 1e-11);
}

TEST(Membrane, ForcesAndMomentsSumToZero) {
  Random random(7);
  for (int trial = 0; trial < 50; ++trial) {
    const TriangleCorners x = random_corners(random), force = membrane_force(kRest, kDenim, x);
    Vec3 sum = Vec3::Zero(), moment = Vec3::Zero();
    for (int c = 0; c < 3; ++c) {
      sum += force[c];
      moment += x[c].cross(force[c]);
    }
    EXPECT_LT(sum.norm(), 1e-12) << "forces of 100 N, rounded";
    EXPECT_LT(moment.norm(), 1e-11) << "forces of 100 N, arms of 5 m";
  }
}

TEST(Membrane, PrincipalStretchesAreThoseOfTheMap) {
  const Mat3 turn = Eigen::Quaterniond(0.3, -0.5, 0.7, 0.1).normalized().toRotationMatrix();
  const auto map = [&](double u, double v) { return Vec3(turn * Vec3(1.3 * u, 0.4 * v, 0)); };
  const auto [low, high] = principal_stretches(kRest, {map(0, 0), map(0.9, 0.2), map(0.3, 0.8)});
  EXPECT_NEAR(low, 0.4, 1e-14);
  EXPECT_NEAR(high, 1.3, 1e-14);
}

/// Elastic energy per area of a sheet whose every vertex follows a homogeneous strain (ε11, ε22, γ) of the
/// axes (warp, weft), which are at `angle` from the sheet's x and z.
double energy_density(const TriangleMesh& mesh, const Vec3& strain, double angle, const Mat3& stiffness) {
  const double c = std::cos(angle), s = std::sin(angle);
  const auto to_fabric = [&](const Vec3& p) { return Vec2(c * p.x() + s * p.z(), c * p.z() - s * p.x()); };
  const auto map = [&](const Vec3& p) {
    const Vec2 q = to_fabric(p);
    return Vec3(q.x() + strain[0] * q.x() + 0.5 * strain[2] * q.y(), 0,
                q.y() + strain[1] * q.y() + 0.5 * strain[2] * q.x());
  };
  double energy = 0, area = 0;
  for (const auto& [a, b, d] : mesh.triangles) {
    const RestTriangle rest = make_rest_triangle(to_fabric(mesh.positions[a]), to_fabric(mesh.positions[b]),
                                                 to_fabric(mesh.positions[d]));
    energy += membrane_energy(rest, stiffness,
                              {map(mesh.positions[a]), map(mesh.positions[b]), map(mesh.positions[d])});
    area += rest.area;
  }
  return energy / area;
}

TEST(Membrane, StiffnessIsRecoveredOnEveryMeshInEveryDirection) {
  // Strain of 1e-4: the quartic part of the energy is 1e-4 of it. The element is exact for a homogeneous
  // strain on any mesh; the requirement is 1 % on grids and 2 % on random meshes.
  constexpr double kStrain = 1e-4, kTolerated = 3e-4;
  for (const SheetKind kind : {SheetKind::parallel, SheetKind::alternating, SheetKind::random}) {
    for (const int cells : {4, 8, 16}) {
      for (const double angle : {0.0, 0.5}) {
        const TriangleMesh mesh = make_sheet(kind, cells);
        const auto recovered = [&](const Vec3& strain) {
          return 2 * energy_density(mesh, kStrain * strain, angle, kDenim) / (kStrain * kStrain);
        };
        const double c11 = recovered({1, 0, 0}), c22 = recovered({0, 1, 0});
        EXPECT_NEAR(c11 / 410.7, 1, kTolerated);
        EXPECT_NEAR(c22 / 2027.8, 1, kTolerated);
        EXPECT_NEAR(recovered({0, 0, 1}) / 53.4, 1, kTolerated);
        EXPECT_NEAR((recovered({1, 1, 0}) - c11 - c22) / 2 / 20.5, 1, 0.02)
            << "a difference of large numbers";
      }
    }
  }
}

const MembraneLaw kLimited = {kDenim, {0.02, 0.1, 30000}};

TEST(Membrane, WithALimitForceAndHessianAreThoseOfItsEnergy) {
  Random random(11);
  for (int trial = 0; trial < 50; ++trial) {
    const TriangleCorners x = random_corners(random), force = membrane_force(kRest, kLimited, x);
    const MembraneHessian hessian = membrane_hessian(kRest, kLimited, x);
    const auto energy = [](const TriangleCorners& y) { return membrane_energy(kRest, kLimited, y); };
    for (int c = 0; c < 3; ++c) {
      for (int k = 0; k < 3; ++k) {
        EXPECT_NEAR(force[c][k], -difference(energy, x, c, k), 30 * kTolerance) << "stiffness 3e4 N/m";
        for (int a = 0; a < 3; ++a) {
          const auto pull = [&](const TriangleCorners& y) { return membrane_force(kRest, kLimited, y)[a]; };
          const Vec3 column = membrane_block(hessian, a, c, StressFilter::exact).col(k);
          EXPECT_LT((column + difference(pull, x, c, k)).norm(), 1e-3 * 30000);
        }
      }
    }
  }
}

TEST(Membrane, LimitOnlyPullsAndIsConvex) {
  // With tension in every direction: no negative eigenvalue of the whole Hessian.
  Random random(12);
  const MembraneLaw limit_alone = {Mat3::Zero(), kLimited.limit};
  for (int trial = 0; trial < 50; ++trial) {
    const MembraneHessian hessian = membrane_hessian(kRest, limit_alone, random_corners(random));
    Eigen::Matrix<double, 9, 9> whole;
    for (int a = 0; a < 3; ++a) {
      for (int b = 0; b < 3; ++b)
        whole.block<3, 3>(3 * a, 3 * b) = membrane_block(hessian, a, b, StressFilter::exact);
    }
    const double least =
        Eigen::SelfAdjointEigenSolver<Eigen::Matrix<double, 9, 9>>(whole).eigenvalues().minCoeff();
    EXPECT_GT(least, -1e-9 * 30000);
  }
}

}  // namespace
}  // namespace weft::engine
