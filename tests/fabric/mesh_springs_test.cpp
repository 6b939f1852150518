/// Springs on the edges of a mesh that represent a fabric.

#include "weft/fabric/mesh_springs.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>

#include "weft/fabric.h"
#include "weft/mesh/grid.h"
#include "weft/mesh/sample_meshes.h"

namespace weft::engine {
namespace {

/// C of a mesh's springs from the energy of homogeneous strains, by definition.
Mat3 recover(const TriangleMesh& mesh, const std::vector<double>& stiffness) {
  Mat3 c = Mat3::Zero();
  double area = 0;
  for (int t = 0; t < mesh.num_triangles(); ++t) area += triangle_area(mesh, t);
  const std::vector<Edge> edges = build_edges(mesh);
  for (std::size_t e = 0; e < edges.size(); ++e) {
    const Vec3 d = mesh.positions[edges[e].b] - mesh.positions[edges[e].a];
    const Vec3 a = Vec3(d.x() * d.x(), d.z() * d.z(), -d.x() * d.z()) / d.norm();  // weft is up × warp = −z
    c += stiffness[e] * a * a.transpose() / area;
  }
  return c;
}

WarpField along_x(const TriangleMesh& mesh) { return warp_from_direction(mesh, Vec3::UnitX()); }

const Fabric kIsotropic{.c11 = 900, .c22 = 900, .c12 = 300, .g = 300};

TEST(MeshSprings, OfAnIsotropicFabricAreExactOnEquilateralTriangles) {
  // Equal springs on equilateral triangles have C11 = 3 C12 = 3 G = (9/(4 √3)) k.
  TriangleMesh rows;
  for (int j = 0; j <= 8; ++j) {
    for (int i = 0; i <= 8; ++i) rows.positions.emplace_back(i + 0.5 * (j % 2), 0, j * std::sqrt(0.75));
  }
  for (int j = 0; j < 8; ++j) {
    for (int i = 0; i < 8; ++i) {
      const int a = 9 * j + i, b = a + 1, c = a + 9, d = a + 10;
      if (j % 2 == 0) {
        rows.triangles.insert(rows.triangles.end(), {{a, c, b}, {b, c, d}});
      } else {
        rows.triangles.insert(rows.triangles.end(), {{a, d, b}, {a, c, d}});
      }
    }
  }
  const MeshSprings springs = make_mesh_springs(rows, along_x(rows), kIsotropic, "mine");
  const Mat3 c = recover(rows, springs.stiffness);
  EXPECT_NEAR(c(0, 0), 900, 9);
  EXPECT_NEAR(c(1, 1), 900, 9);
  EXPECT_NEAR(c(2, 2), 300, 3);
  EXPECT_LT((c - springs.mean).norm(), 1e-6 * c.norm()) << "what it tells is what it is";
}

TEST(MeshSprings, OnRandomTrianglesAreCloseOnAverage) {
  const TriangleMesh mesh = build_random_mesh({1, 1, 24, 24}, 1);
  for (const double ratio : {1.0, 2.0}) {
    Fabric fabric = kIsotropic;
    fabric.c22 *= ratio;
    const MeshSprings springs = make_mesh_springs(mesh, along_x(mesh), fabric, "mine");
    EXPECT_LT((recover(mesh, springs.stiffness) - springs.mean).norm(), 1e-6 * springs.mean.norm());
    std::printf("c11 %.0f of 900, c22 %.0f of %.0f, g %.0f of 300\n", springs.mean(0, 0), springs.mean(1, 1),
                900 * ratio, springs.mean(2, 2));
    EXPECT_NEAR(springs.mean(0, 0) / 900, 1, 0.05);
    EXPECT_NEAR(springs.mean(1, 1) / (900 * ratio), 1, 0.05);
    EXPECT_NEAR(springs.mean(2, 2) / 300, 1, 0.1);
    for (const double k : springs.stiffness) EXPECT_GE(k, 0);
    ASSERT_EQ(springs.warnings.size(), 1U) << "c12 = g is what springs can be";
    EXPECT_NE(springs.warnings[0].find("on average"), std::string::npos);
  }
}

TEST(MeshSprings, TurnWithTheWarp) {
  const TriangleMesh mesh = build_random_mesh({1, 1, 16, 16}, 1);
  Fabric fabric = kIsotropic;
  fabric.c22 = 2000;
  const Mat3 a = make_mesh_springs(mesh, along_x(mesh), fabric, "mine").mean;
  const Mat3 b = make_mesh_springs(mesh, warp_from_direction(mesh, Vec3::UnitZ()), fabric, "mine").mean;
  EXPECT_NEAR(a(0, 0) / b(0, 0), 1, 0.1);
  EXPECT_NEAR(a(1, 1) / b(1, 1), 1, 0.1);
}

TEST(MeshSprings, TellWhatTheyCannotBe) {
  const TriangleMesh mesh = build_random_mesh({1, 1, 8, 8}, 1);
  const MeshSprings springs = make_mesh_springs(mesh, along_x(mesh), find_fabric("denim"), "denim");
  ASSERT_EQ(springs.warnings.size(), 3U);
  EXPECT_NE(springs.warnings[0].find("stretch curves"), std::string::npos) << springs.warnings[0];
  EXPECT_NE(springs.warnings[1].find("c12 = g"), std::string::npos) << springs.warnings[1];
  EXPECT_NE(springs.warnings[2].find("on average"), std::string::npos) << springs.warnings[2];
}

}  // namespace
}  // namespace weft::engine
