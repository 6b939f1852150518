#include "weft/mesh/loop_subdivision.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "weft/mesh/grid.h"

namespace weft::engine {
namespace {

std::vector<float> to_floats(const std::vector<Vec3>& points) {
  std::vector<float> floats;
  for (const Vec3& p : points) {
    for (const double c : p) floats.push_back(static_cast<float>(c));
  }
  return floats;
}

Vec3 point(const std::vector<float>& values, std::size_t v) {
  return {values[3 * v], values[3 * v + 1], values[3 * v + 2]};
}

/// Unit vertices, outward.
TriangleMesh make_icosahedron() {
  TriangleMesh mesh;
  const double g = (1 + std::sqrt(5.0)) / 2;
  for (const double a : {-1.0, 1.0}) {
    for (const double b : {-g, g}) {
      for (const Vec3& p : {Vec3(0, a, b), Vec3(a, b, 0), Vec3(b, 0, a)})
        mesh.positions.push_back(p.normalized());
    }
  }
  const auto is_edge = [&](int i, int j) {
    return std::abs(mesh.positions[i].dot(mesh.positions[j]) - 1 / std::sqrt(5.0)) < 1e-9;
  };
  for (int i = 0; i < 12; ++i) {
    for (int j = i + 1; j < 12; ++j) {
      for (int k = j + 1; k < 12; ++k) {
        if (is_edge(i, j) && is_edge(j, k) && is_edge(k, i)) mesh.triangles.push_back({i, j, k});
      }
    }
  }
  return mesh;
}

TEST(LoopSubdivision, EachLevelHasAVertexMorePerEdgeAndFourTimesTheTriangles) {
  const TriangleMesh grid =
      build_grid_mesh({.size_x = 1, .size_z = 1, .cells_x = 5, .cells_z = 3}, GridDiagonals::alternating);
  for (const TriangleMesh& mesh : {grid, make_icosahedron()}) {
    const int v = mesh.num_vertices(), f = mesh.num_triangles(),
              e = static_cast<int>(build_edges(mesh).size());
    const LoopSubdivision once(mesh.triangles, v, 1), twice(mesh.triangles, v, 2);
    EXPECT_EQ(once.num_vertices(), v + e);
    EXPECT_EQ(static_cast<int>(once.triangles().size()), 4 * f);
    EXPECT_EQ(twice.num_vertices(), v + e + 2 * e + 3 * f);
    EXPECT_EQ(static_cast<int>(twice.triangles().size()), 16 * f);
  }
  const LoopSubdivision none(grid.triangles, grid.num_vertices(), 0);
  EXPECT_EQ(none.triangles(), grid.triangles);
  EXPECT_EQ(none.apply(to_floats(grid.positions), 3), to_floats(grid.positions));
}

TEST(LoopSubdivision, APlaneStaysAPlaneAndKeepsItsSides) {
  TriangleMesh mesh =
      build_grid_mesh({.size_x = 2, .size_z = 1, .cells_x = 7, .cells_z = 4}, GridDiagonals::alternating);
  const Vec3 slope(0.3, 0, -0.7);
  for (Vec3& p : mesh.positions) p.y() = 1 + slope.dot(p);
  const LoopSubdivision subdivision(mesh.triangles, mesh.num_vertices(), 2);
  for (const std::vector<float>& fine :
       {subdivision.apply(to_floats(mesh.positions), 3), subdivision.fit(to_floats(mesh.positions), 3)}) {
    for (int v = 0; v < subdivision.num_vertices(); ++v) {
      const Vec3 p = point(fine, v);
      EXPECT_NEAR(p.y(), 1 + slope.x() * p.x() + slope.z() * p.z(), 1e-6) << "floats";
    }
    for (const auto& [a, b, c] : subdivision.triangles()) {
      const Vec3 normal = (point(fine, b) - point(fine, a)).cross(point(fine, c) - point(fine, a));
      const auto& [i, j, k] = mesh.triangles[0];
      const Vec3 coarse =
          (mesh.positions[j] - mesh.positions[i]).cross(mesh.positions[k] - mesh.positions[i]);
      EXPECT_GT(normal.dot(coarse), 0);
    }
  }
}

TEST(LoopSubdivision, BordersAreCubicSplinesOfThemselves) {
  // Two triangles: all four vertices are on the border.
  const std::vector<Triangle> triangles = {{0, 1, 2}, {0, 2, 3}};
  const std::vector<float> values = {0, 1, 5, 2};
  const LoopSubdivision subdivision(triangles, 4, 1);
  const std::vector<float> fine = subdivision.apply(values, 1);
  for (int v = 0; v < 4; ++v)
    EXPECT_FLOAT_EQ(fine[v], 0.75f * values[v] + 0.125f * (values[(v + 1) % 4] + values[(v + 3) % 4]));
  // Edges in order (0,1), (0,2), (0,3), (1,2), (2,3).
  EXPECT_FLOAT_EQ(fine[4], 0.5f * (values[0] + values[1]));
  EXPECT_FLOAT_EQ(fine[5], 0.375f * (values[0] + values[2]) + 0.125f * (values[1] + values[3]));
  EXPECT_FLOAT_EQ(fine[8], 0.5f * (values[2] + values[3]));
}

TEST(LoopSubdivision, AnIcosahedronTendsToItsLimitSurface) {
  const TriangleMesh mesh = make_icosahedron();
  const double c = 3.0 / 8 + std::cos(2 * std::numbers::pi / 5) / 4, weight = (5.0 / 8 - c * c) / 5;
  const double cosine = 1 / std::sqrt(5.0);
  const LoopSubdivision once(mesh.triangles, 12, 1);
  const std::vector<float> fine = once.apply(to_floats(mesh.positions), 3);
  for (int v = 0; v < 12; ++v) {
    EXPECT_NEAR((point(fine, v) - (1 - 5 * weight * (1 - cosine)) * mesh.positions[v]).norm(), 0, 1e-6);
  }
  // Loop's limit: (w p + Σ neighbours) / (w + 5), w = 3/(8 weight).
  const double w = 3 / (8 * weight), limit = (w + 5 * cosine) / (w + 5);
  const std::vector<float> finest =
      LoopSubdivision(mesh.triangles, 12, 5).apply(to_floats(mesh.positions), 3);
  for (int v = 0; v < 12; ++v) EXPECT_NEAR(point(finest, v).norm(), limit, 0.002);
}

TEST(LoopSubdivision, AFitPassesNearTheVertices) {
  const TriangleMesh mesh = make_sphere_mesh(Vec3::Zero(), 1, 12);
  const LoopSubdivision subdivision(mesh.triangles, mesh.num_vertices(), 2);
  const std::vector<float> loop = subdivision.apply(to_floats(mesh.positions), 3),
                           fit = subdivision.fit(to_floats(mesh.positions), 3);
  double loop_miss = 0, fit_miss = 0;
  for (int v = 0; v < mesh.num_vertices(); ++v) {
    loop_miss = std::max(loop_miss, (point(loop, v) - mesh.positions[v]).norm());
    fit_miss = std::max(fit_miss, (point(fit, v) - mesh.positions[v]).norm());
  }
  EXPECT_GT(loop_miss, 0.01);
  EXPECT_LT(fit_miss, loop_miss / 4) << "each round leaves less than half";
}

TEST(LoopSubdivision, EdgesOfThreeTrianglesAndLooseVerticesAreAllowed) {
  const std::vector<Triangle> triangles = {{0, 1, 2}, {0, 1, 3}, {1, 0, 4}};
  const LoopSubdivision subdivision(triangles, 6, 1);
  EXPECT_EQ(subdivision.num_vertices(), 6 + 7);
  const std::vector<float> fine = subdivision.apply(std::vector<float>{1, 2, 3, 4, 5, 6}, 1);
  EXPECT_EQ(fine[0], 1) << "three border edges meet there: it stays";
  EXPECT_EQ(fine[5], 6) << "in no triangle";
}

}  // namespace
}  // namespace weft::engine
