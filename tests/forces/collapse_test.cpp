/// Resistance to collapse: against finite differences, zero in cloth's working range, and finite everywhere;
/// and the search for narrow triangles against each triangle's principal stretches.

#include "weft/forces/collapse.h"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>

#include "tests/forces/sheets.h"
#include "tests/support.h"
#include "weft/core/simd.h"
#include "weft/forces/narrow_triangles.h"

namespace weft::engine {
namespace {

using test::SheetKind;

const std::array<Vec2, 3> kFlat = {Vec2(0, 0), Vec2(0.9, 0.2), Vec2(0.3, 0.8)};
const RestTriangle kRest = make_rest_triangle(kFlat[0], kFlat[1], kFlat[2]);
const StrainLimit kLaw = {1 - kCollapseBegin, 1 - kCollapseFull, 2000};

Mat3 random_turn(Random& random) {
  return Eigen::Quaterniond(1, random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1))
      .normalized()
      .toRotationMatrix();
}

/// The triangle after a linear map of its plane into space.
TriangleCorners mapped(const Eigen::Matrix2d& map, const Mat3& turn = Mat3::Identity()) {
  TriangleCorners x;
  for (int c = 0; c < 3; ++c) {
    const Vec2 p = map * kFlat[c];
    x[c] = turn * Vec3(p.x(), p.y(), 0) + Vec3(1, -2, 3);
  }
  return x;
}

/// Stretches σ1, σ2 along axes rotated by `angle`.
Eigen::Matrix2d stretched(double s1, double s2, double angle) {
  const Eigen::Matrix2d r = Eigen::Rotation2Dd(angle).toRotationMatrix();
  return r * Vec2(s1, s2).asDiagonal() * r.transpose();
}

/// Threads of rest length at an angle of 90° − γ.
Eigen::Matrix2d sheared(double angle_deg, double warp = 1, double weft = 1) {
  const double a = angle_deg * M_PI / 180;
  Eigen::Matrix2d map;
  map << warp, weft * std::sin(a), 0, weft * std::cos(a);
  return map;
}

/// Compressed by various amounts, in every direction, sometimes in both; also across the breakpoints of ψ.
std::vector<TriangleCorners> crushed_triangles() {
  std::vector<TriangleCorners> all;
  Random random(5);
  for (int k = 0; k < 200; ++k)
    all.push_back(
        mapped(stretched(random.uniform(0.05, 1.5), random.uniform(0.05, 0.48), random.uniform(0, 3)),
               random_turn(random)));
  return all;
}

double energy_of(const TriangleCorners& x) { return collapse_energy(kRest, kLaw, x); }

template <class F>
auto difference(const F& f, TriangleCorners x, int corner, int component) -> decltype(f(x)) {
  constexpr double kDelta = 1e-6;
  x[corner][component] += kDelta;
  const auto above = f(x);
  x[corner][component] -= 2 * kDelta;
  const auto below = f(x);
  return ((above - below) / (2 * kDelta));
}

TEST(Collapse, ForceIsTheGradientOfItsEnergy) {
  for (const TriangleCorners& x : crushed_triangles()) {
    const TriangleCorners force = collapse_force(kRest, kLaw, x);
    EXPECT_GT(energy_of(x), 0);
    for (int c = 0; c < 3; ++c) {
      // Third derivatives of the energy (1e6 N/m² and 1/σ of it) times 1e-12.
      for (int k = 0; k < 3; ++k) EXPECT_NEAR(force[c][k], -difference(energy_of, x, c, k), 1e-4);
    }
  }
}

TEST(Collapse, ExactHessianIsTheDerivativeOfItsForce) {
  for (const TriangleCorners& x : crushed_triangles()) {
    const CollapseHessian hessian = collapse_hessian(kRest, kLaw, x, HessianKind::exact);
    for (int a = 0; a < 3; ++a) {
      const auto force = [&](const TriangleCorners& y) { return collapse_force(kRest, kLaw, y)[a]; };
      for (int b = 0; b < 3; ++b) {
        const Mat3 block = collapse_block(hessian, a, b);
        for (int k = 0; k < 3; ++k)
          EXPECT_LT((block.col(k) + difference(force, x, b, k)).norm(), 1e-5 * kLaw.stiffness);
      }
    }
  }
}

TEST(Collapse, PositiveHessianIsTheExactOneWithoutItsNegativePart) {
  const auto matrix = [](const TriangleCorners& x, HessianKind kind) {
    const CollapseHessian hessian = collapse_hessian(kRest, kLaw, x, kind);
    Eigen::Matrix<double, 9, 9> h;
    for (int a = 0; a < 3; ++a) {
      for (int b = 0; b < 3; ++b) h.block<3, 3>(3 * a, 3 * b) = collapse_block(hessian, a, b);
    }
    return h;
  };
  for (const TriangleCorners& x : crushed_triangles()) {
    const auto positive = matrix(x, HessianKind::positive), exact = matrix(x, HessianKind::exact);
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix<double, 9, 9>> of_positive(positive),
        of_rest(positive - exact);
    const double rounding = 1e-9 * kLaw.stiffness;
    EXPECT_GT(of_positive.eigenvalues().minCoeff(), -rounding);
    EXPECT_GT(of_rest.eigenvalues().minCoeff(), -rounding);
    // In the space of F, where modes are orthogonal, none is stiffer than A k.
    const CollapseHessian modes = collapse_hessian(kRest, kLaw, x, HessianKind::positive);
    for (int m = 0; m < modes.num_modes; ++m)
      EXPECT_LE(modes.stiffness[m], kRest.area * kLaw.stiffness * (1 + 1e-9));
  }
}

TEST(Collapse, CostsNothingInTheWorkingRangeOfCloth) {
  Random random(7);
  for (const double angle : {0.0, 10.0, 20.0, 30.0, 40.0}) {
    for (const double warp : {0.97, 1.0, 1.1}) {
      for (const double weft : {0.97, 1.0, 1.3}) {
        const TriangleCorners x = mapped(sheared(angle, warp, weft), random_turn(random));
        EXPECT_EQ(energy_of(x), 0) << angle;
        for (const Vec3& f : collapse_force(kRest, kLaw, x)) EXPECT_EQ(f.norm(), 0) << angle;
        EXPECT_EQ(collapse_hessian(kRest, kLaw, x, HessianKind::exact).num_modes, 0) << angle;
      }
    }
  }
  EXPECT_EQ(energy_of(mapped(stretched(1, 0.51, 0.4))), 0);  // half the area
  EXPECT_EQ(energy_of(mapped(stretched(0.6, 0.6, 0.4))), 0);
}

TEST(Collapse, LocksInShearBetweenFiftyAndSeventyDegrees) {
  // Couple of the sheared triangle, over area and stiffness.
  const auto moment = [](double angle_deg) {
    const double d = 1e-3;
    return (energy_of(mapped(sheared(angle_deg + d))) - energy_of(mapped(sheared(angle_deg - d)))) /
           (2 * d * M_PI / 180) / (kRest.area * kLaw.stiffness);
  };
  EXPECT_EQ(moment(48), 0);
  EXPECT_GT(moment(50), 0);
  EXPECT_LT(moment(50), 1e-3);
  EXPECT_GT(moment(60), 0.01);
  EXPECT_GT(moment(70), 0.05);
}

TEST(Collapse, OpensTrianglesWithoutWidth) {
  // Warp and weft parallel, a thread of zero length, three corners collinear, and coincident.
  Eigen::Matrix2d parallel, short_thread, line;
  parallel << 1, 1, 0, 0;
  short_thread << 1, 0, 0, 0;
  line << 0.3, -1.2, 0.6, -2.4;
  const Eigen::Matrix2d point = Eigen::Matrix2d::Zero();
  Random random(9);
  for (const Eigen::Matrix2d& map : {parallel, short_thread, line, point}) {
    const TriangleCorners x = mapped(map, random_turn(random)), force = collapse_force(kRest, kLaw, x);
    TriangleCorners moved = x;
    Vec3 sum = Vec3::Zero();
    for (int c = 0; c < 3; ++c) {
      ASSERT_TRUE(force[c].allFinite());
      sum += force[c];
      moved[c] += 1e-5 * force[c];
    }
    EXPECT_LT(sum.norm(), 1e-9);
    EXPECT_LT(energy_of(moved), energy_of(x));
    EXPECT_GT(principal_stretches(kRest, moved)[0], principal_stretches(kRest, x)[0] + 1e-4);
    const CollapseHessian hessian = collapse_hessian(kRest, kLaw, x, HessianKind::positive);
    EXPECT_GT(hessian.num_modes, 0);
    for (int m = 0; m < hessian.num_modes; ++m) {
      for (const Vec3& w : hessian.corners[m]) EXPECT_TRUE(w.allFinite());
    }
  }
}

TEST(NarrowTriangles, AreThoseWhoseSmallerStretchIsBelowTheBound) {
  constexpr double kBound = 0.7;
  const Grid grid = {.size_x = 1, .size_z = 0.6, .cells_x = 21, .cells_z = 13};
  std::vector<std::shared_ptr<const ClothTopology>> sheets;
  for (const SpringModel model : {SpringModel::basic, SpringModel::simplified, SpringModel::alternating})
    sheets.push_back(build_grid_topology(grid, model));
  sheets.push_back(build_mesh_topology(test::make_sheet(SheetKind::random, grid)));
  for (const auto& topology : sheets) {
    const PaddedRows rows = topology->grid ? PaddedRows{grid.num_columns(), grid.num_rows()}
                                           : PaddedRows{topology->num_particles(), 1};
    NarrowTriangles narrow;
    narrow.fit(topology, rows, kBound);
    for (const double size : {0.0, 0.01, 0.03}) {
      ClothState state = make_state(topology->mesh.positions);
      test::shake(state, size, 0);
      Vec3Array x(rows.size());
      for (int i = 0; i < topology->num_particles(); ++i) x.set(rows.index(i), state.x.get(i));
      std::vector<int> expected;
      for (int t = 0; t < topology->mesh.num_triangles(); ++t) {
        const auto& [a, b, c] = topology->mesh.triangles[t];
        const RestTriangle rest = make_rest_triangle(topology->mesh, t);
        if (principal_stretches(rest, {state.x.get(a), state.x.get(b), state.x.get(c)})[0] < kBound)
          expected.push_back(t);
      }
      EXPECT_EQ(expected.empty(), size == 0);
      for (const SimdLevel level : {SimdLevel::baseline, SimdLevel::avx2, SimdLevel::avx512}) {
        if (level > best_simd_level()) continue;
        limit_simd_level(level);
        for (const int threads : {1, 3}) EXPECT_EQ(narrow.find(x, *make_jobs(threads)), expected);
      }
      limit_simd_level(best_simd_level());
    }
  }
}

}  // namespace
}  // namespace weft::engine
