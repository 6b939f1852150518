#include "weft/mesh/triangle_mesh.h"

#include <gtest/gtest.h>

#include <numeric>

#include "weft/mesh/grid.h"

namespace weft {
namespace {

double signed_volume(const TriangleMesh& mesh) {
  double volume = 0;
  for (const auto& [a, b, c] : mesh.triangles) {
    volume += mesh.positions[a].dot(mesh.positions[b].cross(mesh.positions[c])) / 6;
  }
  return volume;
}

TEST(SphereMesh, IsClosedOutwardAndAlmostTheSphere) {
  const TriangleMesh mesh = make_sphere_mesh(Vec3(1, 2, 3), 0.5, 32);
  for (const Edge& edge : build_edges(mesh)) EXPECT_EQ(edge.num_triangles, 2);
  const double sphere = 4.0 / 3 * 3.14159265358979 * 0.125;
  EXPECT_GT(signed_volume(mesh), 0.98 * sphere);
  EXPECT_LT(signed_volume(mesh), sphere);
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
}  // namespace weft
