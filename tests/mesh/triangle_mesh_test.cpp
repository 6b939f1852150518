#include "weft/mesh/triangle_mesh.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>
#include <utility>

#include "weft/mesh/clean.h"
#include "weft/mesh/grid.h"
#include "weft/mesh/solid.h"

namespace weft::engine {
namespace {

TEST(SphereMesh, IsClosedOutwardAndAlmostTheSphere) {
  const TriangleMesh mesh = make_sphere_mesh(Vec3(1, 2, 3), 0.5, 32);
  for (const Edge& edge : build_edges(mesh)) EXPECT_EQ(edge.num_triangles, 2);
  const double sphere = 4.0 / 3 * 3.14159265358979 * 0.125;
  EXPECT_GT(compute_signed_volume(mesh), 0.98 * sphere);
  EXPECT_LT(compute_signed_volume(mesh), sphere);
}

TEST(CapsuleMesh, IsClosedOutwardAndAlmostTheCapsule) {
  const Vec3 a(1, 2, 3), b(1.3, 1.5, 3.8);
  const double pi = 3.14159265358979, r = 0.2, length = (b - a).norm();
  for (const auto& [from, to] : {std::pair(a, b), std::pair(b, a), std::pair(a, a)}) {
    const TriangleMesh mesh = make_capsule_mesh(from, to, r, 32);
    const SurfaceEdges edges = count_surface_edges(mesh);
    // With zero length both ends coincide, and the side between them has no area.
    EXPECT_EQ(edges.border + edges.non_manifold + edges.twisted, 0);
    const double capsule = pi * r * r * (4.0 / 3 * r + (to - from).norm());
    EXPECT_GT(compute_signed_volume(mesh), 0.98 * capsule);
    EXPECT_LT(compute_signed_volume(mesh), capsule);
    for (const Vec3& p : mesh.positions) {
      const double s = from == to ? 0 : std::clamp((p - from).dot(to - from) / (length * length), 0.0, 1.0);
      EXPECT_NEAR((p - from - s * (to - from)).norm(), r, 1e-12);
    }
  }
}

TEST(BoxMesh, IsClosedOutwardAndTheBox) {
  const Mat3 rotation = Eigen::AngleAxisd(0.7, Vec3(1, 2, 3).normalized()).toRotationMatrix();
  const TriangleMesh mesh = make_box_mesh(Vec3(3, 2, 1), Vec3(0.5, 0.1, 0.3), rotation);
  const SurfaceEdges edges = count_surface_edges(clean_mesh(mesh, {.weld_distance = 1e-9}).mesh);
  EXPECT_EQ(edges.border + edges.non_manifold + edges.twisted, 0);
  EXPECT_NEAR(compute_signed_volume(mesh), 8 * 0.5 * 0.1 * 0.3, 1e-12);
  for (const Vec3& p : mesh.positions) {
    const Vec3 corner = (rotation.transpose() * (p - Vec3(3, 2, 1))).cwiseAbs();
    EXPECT_TRUE(corner.isApprox(Vec3(0.5, 0.1, 0.3), 1e-12));
  }
}

TEST(SquareMesh, FacesAlongItsNormal) {
  const Vec3 normal = Vec3(1, 2, -1).normalized();
  const TriangleMesh mesh = make_square_mesh(Vec3(3, 2, 1), normal, 2);
  for (const auto& [a, b, c] : mesh.triangles) {
    const Vec3 cross = (mesh.positions[b] - mesh.positions[a]).cross(mesh.positions[c] - mesh.positions[a]);
    EXPECT_NEAR(cross.dot(normal), 4, 1e-12);
  }
}

TEST(Grid, LiesHorizontallyWithTheFirstAxisAlongX) {
  const Grid grid{.size_x = 2, .size_z = 1, .cells_x = 4, .cells_z = 3};
  const TriangleMesh mesh = build_grid_mesh(grid, GridDiagonals::parallel);
  EXPECT_EQ(mesh.positions[grid.index(0, 0)], Vec3(0, 0, 0));
  EXPECT_EQ(mesh.positions[grid.index(4, 0)], Vec3(2, 0, 0));
  EXPECT_EQ(mesh.positions[grid.index(0, 3)], Vec3(0, 0, 1));
}

TEST(Grid, TrianglesFaceUpAndCoverIt) {
  const Grid grid{.size_x = 2, .size_z = 1, .cells_x = 5, .cells_z = 4};
  for (const GridDiagonals diagonals : {GridDiagonals::parallel, GridDiagonals::alternating}) {
    const TriangleMesh mesh = build_grid_mesh(grid, diagonals);
    double area = 0;
    for (int t = 0; t < mesh.num_triangles(); ++t) {
      const auto& [a, b, c] = mesh.triangles[t];
      EXPECT_GT((mesh.positions[b] - mesh.positions[a]).cross(mesh.positions[c] - mesh.positions[a]).y(), 0);
      area += triangle_area(mesh, t);
    }
    EXPECT_NEAR(area, 2, 1e-12);
  }
}

TEST(Grid, ParticleAreasAddUpToTheCloth) {
  const Grid grid{.size_x = 2, .size_z = 3, .cells_x = 5, .cells_z = 4};
  const std::vector<double> areas = compute_grid_areas(grid);
  EXPECT_NEAR(std::accumulate(areas.begin(), areas.end(), 0.0), 6, 1e-12);
  EXPECT_NEAR(areas[grid.index(0, 0)] * 4, areas[grid.index(1, 1)], 1e-12);
  EXPECT_NEAR(areas[grid.index(2, 0)] * 2, areas[grid.index(1, 1)], 1e-12);
}

TEST(Edges, AreFoundOnceWithBothSides) {
  //  2---3
  //  | \ |
  //  0---1
  const TriangleMesh mesh{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}}, {{0, 1, 2}, {2, 1, 3}}};
  const std::vector<Edge> edges = build_edges(mesh);
  ASSERT_EQ(edges.size(), 5u);
  int inner = 0;
  for (const Edge& edge : edges) {
    EXPECT_LT(edge.a, edge.b);
    if (edge.num_triangles != 2) continue;
    ++inner;
    EXPECT_EQ(edge.a, 1);
    EXPECT_EQ(edge.b, 2);
    EXPECT_EQ(edge.opposite[0], 0);
    EXPECT_EQ(edge.opposite[1], 3);
  }
  EXPECT_EQ(inner, 1);
}

}  // namespace
}  // namespace weft::engine
