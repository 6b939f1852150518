#include "weft/contact/surface.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <set>

#include "tests/support.h"

namespace weft::engine {
namespace {

bool has(const Triangle& t, int v) { return std::find(t.begin(), t.end(), v) != t.end(); }

/// Two grids, a closed mesh, and three triangles at one edge.
Surface make_surface() {
  Surface surface;
  for (const GridDiagonals diagonals : {GridDiagonals::parallel, GridDiagonals::alternating}) {
    const TriangleMesh grid = build_grid_mesh(test::square(4), diagonals);
    surface.add(grid.triangles, grid.num_vertices());
  }
  const TriangleMesh ball = make_sphere_mesh(Vec3::Zero(), 1, 3);
  surface.add(ball.triangles, ball.num_vertices());
  surface.add({{0, 1, 2}, {1, 0, 3}, {0, 1, 4}}, 6);  // vertex 5 belongs to no triangle
  surface.build_one_rings();
  return surface;
}

TEST(Surface, EveryVertexIsOwnedByExactlyOneOfItsTriangles) {
  const Surface surface = make_surface();
  std::vector<int> owners(surface.num_vertices, 0);
  for (std::size_t t = 0; t < surface.triangles.size(); ++t) {
    for (const int v : surface.owned[t].vertex) {
      if (v < 0) continue;
      ++owners[v];
      EXPECT_TRUE(has(surface.triangles[t], v));
    }
  }
  for (int v = 0; v + 1 < surface.num_vertices; ++v) EXPECT_EQ(owners[v], 1) << v;
  EXPECT_EQ(owners.back(), 0) << "a vertex without triangles has no owner";
}

TEST(Surface, EveryEdgeIsListedOnceAndOwnedByExactlyOneOfItsTriangles) {
  const Surface surface = make_surface();
  std::map<std::array<int, 2>, int> index;
  for (std::size_t e = 0; e < surface.edges.size(); ++e) {
    EXPECT_LT(surface.edges[e][0], surface.edges[e][1]);
    EXPECT_TRUE(index.emplace(surface.edges[e], static_cast<int>(e)).second);
  }
  std::set<std::array<int, 2>> sides;
  std::vector<int> owners(surface.edges.size(), 0);
  for (std::size_t t = 0; t < surface.triangles.size(); ++t) {
    for (int k = 0; k < 3; ++k) {
      const int a = surface.triangles[t][k], b = surface.triangles[t][(k + 1) % 3];
      sides.insert({std::min(a, b), std::max(a, b)});
      const int e = surface.owned[t].edge[k];
      if (e < 0) continue;
      ++owners[e];
      EXPECT_TRUE(has(surface.triangles[t], surface.edges[e][0]));
      EXPECT_TRUE(has(surface.triangles[t], surface.edges[e][1]));
    }
  }
  EXPECT_EQ(sides.size(), surface.edges.size()) << "no side is missing";
  for (std::size_t e = 0; e < owners.size(); ++e) EXPECT_EQ(owners[e], 1) << e;
}

TEST(Surface, EveryPairOfFeaturesBelongsToExactlyOnePairOfTriangles) {
  const Surface surface = make_surface();
  const int n = static_cast<int>(surface.triangles.size());
  std::map<std::array<int, 2>, int> vertex_triangle, edge_edge;
  for (int a = 0; a < n; ++a) {
    for (const int v : surface.owned[a].vertex) {
      for (int b = 0; b < n; ++b) {
        if (v >= 0 && !has(surface.triangles[b], v)) ++vertex_triangle[{v, b}];
      }
    }
    for (int b = a; b < n; ++b) {
      for (const int e : surface.owned[a].edge) {
        for (const int f : surface.owned[b].edge) {
          if (e < 0 || f < 0 || (a == b && e >= f)) continue;
          ++edge_edge[{std::min(e, f), std::max(e, f)}];
        }
      }
    }
  }
  for (const auto& [pair, count] : vertex_triangle) EXPECT_EQ(count, 1) << pair[0] << " " << pair[1];
  for (const auto& [pair, count] : edge_edge) EXPECT_EQ(count, 1) << pair[0] << " " << pair[1];
  // All except the vertices of the triangle itself, and the one vertex without triangles.
  EXPECT_EQ(vertex_triangle.size(), static_cast<std::size_t>(n * (surface.num_vertices - 1) - 3 * n));
  const std::size_t m = surface.edges.size();
  EXPECT_EQ(edge_edge.size(), m * (m - 1) / 2);
}

TEST(Surface, FansHoldTheTrianglesAroundEachVertex) {
  const Surface surface = make_surface();
  for (int v = 0; v < surface.num_vertices; ++v) {
    std::vector<int> around;
    for (int t = 0; t < static_cast<int>(surface.triangles.size()); ++t) {
      if (has(surface.triangles[t], v)) around.push_back(t);
    }
    EXPECT_EQ(std::vector<int>(surface.one_ring.begin() + surface.one_ring_begin[v],
                               surface.one_ring.begin() + surface.one_ring_begin[v + 1]),
              around);
  }
}

TEST(Surface, CountsSharedVertices) {
  EXPECT_EQ(num_shared_vertices({0, 1, 2}, {3, 4, 5}), 0);
  EXPECT_EQ(num_shared_vertices({0, 1, 2}, {5, 4, 2}), 1);
  EXPECT_EQ(num_shared_vertices({0, 1, 2}, {2, 1, 5}), 2);
  EXPECT_EQ(num_shared_vertices({0, 1, 2}, {1, 2, 0}), 3);
}

}  // namespace
}  // namespace weft::engine
