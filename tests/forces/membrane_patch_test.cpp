/// Pairs of triangles with a mean strain: energy, force and Hessian, uniform strain, folds, and how meshes are paired.

#include "weft/forces/membrane_patch.h"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "tests/forces/sheets.h"
#include "tests/support.h"
#include "weft/core/random.h"
#include "weft/model/cloth_elements.h"

namespace weft::engine {
namespace {

using test::SheetKind;

Mat3 make_stiffness() {
  Mat3 c;
  c << 900, 300, 0, 300, 2000, 0, 0, 0, 120;
  return c;
}

/// All parts of the law respond: the limit, a curve, and large differences.
const PatchLaw kLaw({make_stiffness(), {0.02, 0.1, 30000}, {{0.03, 500}}, {{0.01, 400}}},
                    {30, 0.04, 870, 1970});

MembranePatch make_pair() {
  const std::vector<Vec3> corners = {{0, 0, 0}, {1, 0, 0.1}, {0.9, 0, -0.8}, {-0.1, 0, -0.7}};
  const TriangleMesh mesh{corners, {{0, 1, 2}, {0, 2, 3}}};
  const WarpField warp = warp_from_direction(mesh, {1, 0, 0.4});
  const std::vector<MembranePatch> patches = pair_triangles(mesh, warp, build_membranes(mesh, warp));
  EXPECT_EQ(patches.size(), 1u);
  return patches[0];
}

PatchCorners random_corners(Random& random, double size) {
  const MembranePatch pair = make_pair();
  const std::vector<Vec3> rest = {{0, 0, 0}, {1, 0, 0.1}, {0.9, 0, -0.8}, {-0.1, 0, -0.7}};
  PatchCorners x = corners_of(pair, rest);
  for (Vec3& p : x) p += test::random_vector(random, size);
  return x;
}

/// Derivative of f(x) by coordinate k of vertex v.
template <class Function>
auto derivative(const Function& f, PatchCorners x, int v, int k) {
  constexpr double kStep = 1e-6;
  x[v][k] += kStep;
  const auto ahead = f(x);
  x[v][k] -= 2 * kStep;
  const auto behind = f(x);
  return decltype(ahead)((ahead - behind) / (2 * kStep));
}

TEST(MembranePatch, ForceAndHessianAreTheDerivativesOfTheEnergy) {
  const MembranePatch pair = make_pair();
  Random random(1);
  for (int trial = 0; trial < 30; ++trial) {
    const PatchCorners x = random_corners(random, 0.2), force = patch_force(pair, kLaw, x);
    const PatchHessian hessian = patch_hessian(pair, kLaw, x);
    for (int v = 0; v < 4; ++v) {
      for (int k = 0; k < 3; ++k) {
        const double slope =
            derivative([&](const PatchCorners& y) { return patch_energy(pair, kLaw, y); }, x, v, k);
        EXPECT_NEAR(force[v][k], -slope, 1e-4);
        for (int a = 0; a < 4; ++a) {
          const Vec3 column = derivative(
              [&](const PatchCorners& y) -> Vec3 { return patch_force(pair, kLaw, y)[a]; }, x, v, k);
          EXPECT_LT((patch_block(pair, hessian, a, v, StressFilter::exact).col(k) + column).norm(), 2)
              << "30,000 N/m, with kinks";
        }
      }
    }
  }
}

TEST(MembranePatch, FilteredHessianIsNeverIndefinite) {
  const MembranePatch pair = make_pair();
  Random random(2);
  for (int trial = 0; trial < 50; ++trial) {
    PatchCorners x = random_corners(random, 0.2);
    for (Vec3& p : x) p *= 0.7;
    const PatchHessian hessian = patch_hessian(pair, kLaw, x);
    Eigen::Matrix<double, 12, 12> whole;
    for (int a = 0; a < 4; ++a) {
      for (int b = 0; b < 4; ++b)
        whole.block<3, 3>(3 * a, 3 * b) = patch_block(pair, hessian, a, b, StressFilter::absolute);
    }
    EXPECT_LT((whole - whole.transpose()).norm(), 1e-9 * whole.norm());
    EXPECT_GT(Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(whole).eigenvalues().minCoeff(), -1e-8);
  }
}

TEST(MembranePatch, FoldedAlongItsEdgeIsFreeOfStress) {
  const MembranePatch pair = make_pair();
  const Vec3 a(0, 0, 0), b(0.9, 0, -0.8), axis = (b - a).normalized();
  const std::vector<Vec3> rest = {a, {1, 0, 0.1}, b, {-0.1, 0, -0.7}};
  for (const double angle : {0.3, 1.5, 3.0}) {
    std::vector<Vec3> folded = rest;
    folded[3] = Eigen::AngleAxisd(angle, axis) * rest[3];
    EXPECT_LT(patch_energy(pair, kLaw, corners_of(pair, folded)), 1e-25);
    for (const Vec3& f : patch_force(pair, kLaw, corners_of(pair, folded))) EXPECT_LT(f.norm(), 1e-11);
  }
}

/// Energy of a sheet's elements in the plane after a homogeneous strain, in pairs and by single triangles.
TEST(MembranePatch, UniformStrainIsResistedAsBySingleTriangles) {
  const Fabric fabric = {.density = 0.2, .c11 = 900, .c22 = 2000, .c12 = 300, .g = 120};
  for (const SheetKind kind : {SheetKind::parallel, SheetKind::random}) {
    const TriangleMesh mesh = make_sheet(kind, 9);
    ClothElements elements = *build_mesh_elements(mesh, warp_from_direction(mesh, {2, 0, 1}), fabric);
    const auto stretched = test::mapped(
        mesh, [](const Vec3& p) { return Vec3(1.05 * p.x() + 0.2 * p.z(), 0, 0.98 * p.z() - 0.03 * p.x()); });
    const auto sum = [&](const std::vector<MembranePatch>& patches) {
      double energy = 0;
      std::vector<Vec3> forces(stretched.size(), Vec3::Zero());
      for (const MembranePatch& patch : patches) {
        energy += patch_energy(patch, elements.law(), corners_of(patch, stretched));
        const PatchCorners own = patch_force(patch, elements.law(), corners_of(patch, stretched));
        for (int v = 0; v < patch.num_vertices(); ++v) forces[patch.vertices[v]] += own[v];
      }
      return std::pair(energy, forces);
    };
    const auto [pairs, forces] = sum(elements.patches);
    const auto [singles, expected] = sum(make_single_patches(elements.membranes));
    EXPECT_NEAR(pairs / singles, 1, 1e-12);
    for (std::size_t i = 0; i < forces.size(); ++i) EXPECT_LT((forces[i] - expected[i]).norm(), 1e-10);
  }
}

TEST(MembranePatch, HoldEveryTriangleOnceAndLeaveFewAlone) {
  for (const SheetKind kind : {SheetKind::parallel, SheetKind::random}) {
    const TriangleMesh mesh = make_sheet(kind, 30);
    const WarpField warp = warp_from_direction(mesh, {2, 0, 1});
    const std::vector<MembraneElement> membranes = build_membranes(mesh, warp);
    const std::vector<MembranePatch> patches = pair_triangles(mesh, warp, membranes);
    std::vector<int> count(membranes.size(), 0);
    int num_single = 0;
    for (const MembranePatch& patch : patches) {
      num_single += patch.num_triangles == 1;
      for (int t = 0; t < patch.num_triangles; ++t) {
        ++count[patch.triangles[t]];
        std::array<int, 3> vertices;
        for (int c = 0; c < 3; ++c) vertices[c] = patch.vertices[patch.corners[t][c]];
        EXPECT_EQ(vertices, membranes[patch.triangles[t]].vertices);
      }
    }
    EXPECT_EQ(std::ranges::count(count, 1), mesh.num_triangles());
    EXPECT_LE(num_single, mesh.num_triangles() / 25) << test::to_string(kind);
  }
}

TEST(MembranePatch, AreOfOneOrientationAndOneWarpDirection) {
  const TriangleMesh turned{{{0, 0, 0}, {1, 0, 0}, {1, 0, -1}, {0, 0, -1}}, {{0, 1, 2}, {0, 3, 2}}};
  const WarpField same = warp_from_direction(turned, Vec3::UnitX());
  EXPECT_EQ(pair_triangles(turned, same, build_membranes(turned, same)).size(), 2u) << "opposite orientation";
  const TriangleMesh square{turned.positions, {{0, 1, 2}, {0, 2, 3}}};
  const WarpField across{{Vec3::UnitX(), Vec3::UnitZ()}, 0};
  EXPECT_EQ(pair_triangles(square, across, build_membranes(square, across)).size(), 2u) << "a seam";
  EXPECT_EQ(pair_triangles(square, same, build_membranes(square, same)).size(), 1u);
  // Folded upright along the common edge, warp along it on both sides: the same direction in the fabric.
  TriangleMesh folded = square;
  folded.positions[3] = {0.5, std::sqrt(0.5), -0.5};
  const WarpField along = warp_from_direction(folded, {1, 0, -1});
  EXPECT_EQ(pair_triangles(folded, along, build_membranes(folded, along)).size(), 1u);
}

}  // namespace
}  // namespace weft::engine
