#include "weft/mesh/slivers.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>

#include "weft/core/random.h"
#include "weft/mesh/clean.h"
#include "weft/mesh/grid.h"
#include "weft/mesh/sample_meshes.h"
#include "weft/mesh/solid.h"

namespace weft::engine {
namespace {

constexpr double kFlatness = SliverLimits{}.flatness;

double least_height_share(const TriangleMesh& mesh) {
  double least = 1;
  for (int t = 0; t < mesh.num_triangles(); ++t) {
    double longest_sq = 0;
    for (int k = 0; k < 3; ++k) {
      const Triangle& v = mesh.triangles[t];
      longest_sq =
          std::max(longest_sq, (mesh.positions[v[k]] - mesh.positions[v[(k + 1) % 3]]).squaredNorm());
    }
    least = std::min(least, 2 * triangle_area(mesh, t) / longest_sq);
  }
  return least;
}

double area_of(const TriangleMesh& mesh) {
  double area = 0;
  for (int t = 0; t < mesh.num_triangles(); ++t) area += triangle_area(mesh, t);
  return area;
}

int euler_of(const TriangleMesh& mesh) {
  return mesh.num_vertices() - static_cast<int>(build_edges(mesh).size()) + mesh.num_triangles();
}

int max_triangles_at_an_edge(const TriangleMesh& mesh) {
  int most = 0;
  for (const Edge& e : build_edges(mesh)) most = std::max(most, e.num_triangles);
  return most;
}

/// Every corner is at the position of its weights, within `tolerance` [m].
void expect_corners_in_place(const TriangleMesh& source, const DerivedMesh& derived, double tolerance) {
  ASSERT_EQ(derived.source_triangle.size(), derived.mesh.triangles.size());
  ASSERT_EQ(derived.corner_weights.size(), derived.mesh.triangles.size());
  for (int t = 0; t < derived.mesh.num_triangles(); ++t) {
    const Triangle& from = source.triangles[derived.source_triangle[t]];
    for (int c = 0; c < 3; ++c) {
      Vec3 place = Vec3::Zero();
      for (int k = 0; k < 3; ++k) place += derived.corner_weights[t][c][k] * source.positions[from[k]];
      EXPECT_LT((place - derived.mesh.positions[derived.mesh.triangles[t][c]]).norm(), tolerance) << t;
    }
  }
}

TEST(Slivers, DividesWhatIsBehindACap) {
  const TriangleMesh mesh{{{0, 0, 0}, {1, 0, 0}, {0.4, 0, -1e-4}, {0.5, 0, 1}, {0.4, 0, -1}},
                          {{0, 2, 1}, {0, 1, 3}, {0, 4, 2}, {2, 4, 1}}};
  const MeshWithoutSlivers result = remove_slivers(mesh);
  EXPECT_EQ(result.num_divided, 1);
  EXPECT_EQ(result.num_collapsed, 0);
  EXPECT_EQ(result.mesh.positions, mesh.positions);
  EXPECT_EQ(result.mesh.triangles, (std::vector<Triangle>{{0, 4, 2}, {2, 4, 1}, {2, 1, 3}, {0, 2, 3}}));
  EXPECT_EQ(result.source_triangle, (std::vector<int>{2, 3, 1, 1}));
  expect_corners_in_place(mesh, result, 2e-4);
}

TEST(Slivers, DropsACapAtTheBorder) {
  const TriangleMesh mesh{{{0, 0, 0}, {1, 0, 0}, {0.4, 0, -1e-4}, {0.4, 0, -1}},
                          {{0, 2, 1}, {0, 3, 2}, {2, 3, 1}}};
  const MeshWithoutSlivers result = remove_slivers(mesh);
  EXPECT_EQ(result.mesh.triangles, (std::vector<Triangle>{{0, 3, 2}, {2, 3, 1}}));
  EXPECT_EQ(result.mesh.num_vertices(), 4);
}

TEST(Slivers, CollapsesANeedleAndKeepsTheBorder) {
  // Vertex 4 is 1 mm from vertex 2, which is on the border.
  const TriangleMesh mesh{{{0, 0, 0}, {1, 0, 0}, {0.5, 0, 1}, {0.5, 0, 0.3}, {0.5005, 0, 0.999}, {0, 0, 1}},
                          {{0, 1, 3}, {0, 3, 5}, {1, 2, 4}, {1, 4, 3}, {2, 5, 4}, {3, 4, 5}}};
  const MeshWithoutSlivers result = remove_slivers(mesh);
  EXPECT_EQ(result.num_collapsed, 1);
  EXPECT_EQ(result.mesh.num_triangles(), 4);
  EXPECT_EQ(result.vertex_of_source[4], result.vertex_of_source[2]);
  EXPECT_EQ(result.mesh.positions[result.vertex_of_source[4]], mesh.positions[2]);
  EXPECT_NEAR(area_of(result.mesh), area_of(mesh), 1e-9);
}

TEST(Slivers, LeavesARibbonAsItIs) {
  // All triangles are flat. The sheet must not separate, or shrink to a line from its ends.
  for (const int cells : {1, 2, 5}) {
    const TriangleMesh mesh = build_grid_mesh(
        {.size_x = 10.0 * cells, .size_z = 0.05, .cells_x = cells, .cells_z = 1}, GridDiagonals::alternating);
    ASSERT_LT(least_height_share(mesh), kFlatness);
    EXPECT_EQ(remove_slivers(mesh).mesh.triangles, mesh.triangles) << cells;
  }
}

TEST(Slivers, LeavesWellShapedMeshesAsTheyAre) {
  const TriangleMesh mesh = build_random_mesh({.size_x = 1, .size_z = 1, .cells_x = 30, .cells_z = 30}, 2);
  const MeshWithoutSlivers result = remove_slivers(mesh);
  EXPECT_EQ(result.num_collapsed + result.num_divided, 0);
  EXPECT_EQ(result.mesh.triangles, mesh.triangles);
  EXPECT_EQ(result.mesh.positions, mesh.positions);
}

double shortest_edge(const TriangleMesh& mesh) {
  double shortest = 1;
  for (const Edge& e : build_edges(mesh))
    shortest = std::min(shortest, (mesh.positions[e.a] - mesh.positions[e.b]).norm());
  return shortest;
}

auto count_edges_below(double length, const TriangleMesh& mesh) {
  return std::ranges::count_if(build_edges(mesh), [&](const Edge& e) {
    return (mesh.positions[e.a] - mesh.positions[e.b]).norm() < length;
  });
}

/// Cells of 1 cm, and a last row of 0.3 mm, as after a cut through a mesh.
TriangleMesh sheet_with_a_narrow_row() {
  TriangleMesh mesh = build_grid_mesh({.size_x = 0.1, .size_z = 0.11, .cells_x = 10, .cells_z = 11},
                                      GridDiagonals::alternating);
  for (Vec3& p : mesh.positions) p.z() = p.z() > 0.105 ? 0.1003 : p.z();
  return mesh;
}

TEST(Slivers, AreNeedlesWithAShortEdgeIfThatIsAsked) {
  const TriangleMesh mesh = sheet_with_a_narrow_row();
  ASSERT_GT(least_height_share(mesh), kFlatness);
  EXPECT_EQ(remove_slivers(mesh).num_collapsed, 0);
  const MeshWithoutSlivers result = remove_slivers(mesh, {.short_edge = 2e-3});
  EXPECT_EQ(result.num_divided, 0);
  EXPECT_EQ(count_edges_below(2e-3, result.mesh), 0);
  EXPECT_NEAR(area_of(result.mesh), area_of(mesh), 5e-6) << "the border stays where it is, but for two ears";
  expect_corners_in_place(mesh, result, 4e-4);
}

TEST(Slivers, AreNoSmallTrianglesAmongOthersOfTheirSize) {
  const TriangleMesh mesh =
      build_random_mesh({.size_x = 0.02, .size_z = 0.02, .cells_x = 30, .cells_z = 30}, 2);
  ASSERT_LT(shortest_edge(mesh), 1e-3);
  EXPECT_EQ(remove_slivers(mesh, {.short_edge = 2e-3}).mesh.triangles, mesh.triangles);
}

TEST(Slivers, AreRemovedWhereverTheyAre) {
  // Sheets and spheres with caps and needles at random edges: the result has the same topology and area.
  for (std::uint64_t seed = 1; seed <= 40; ++seed) {
    Random random(seed);
    TriangleMesh mesh = seed % 2 == 1 ? build_random_mesh({1, 1, 12, 12}, seed)
                                      : clean_mesh(make_sphere_mesh(Vec3::Zero(), 0.3, 12)).mesh;
    const TriangleMesh whole = mesh;
    for (int n = 0; n < 25; ++n) {
      const std::vector<Edge> edges = build_edges(mesh);
      const Edge& e = edges[static_cast<std::size_t>(random.uniform(0, static_cast<double>(edges.size())))];
      const bool needle = random.uniform(0, 1) < 0.5;
      const double along = needle ? random.uniform(0.001, 0.01) : random.uniform(0.2, 0.8);
      const Vec3 a = mesh.positions[e.a], b = mesh.positions[e.b], c = mesh.positions[e.opposite[0]];
      const Vec3 on_edge = a + along * (b - a);
      mesh.positions.emplace_back(on_edge + random.uniform(1e-7, 1e-3) * (c - on_edge));
      const int middle = mesh.num_vertices() - 1;
      for (int t = 0, end = mesh.num_triangles(); t < end; ++t) {
        const Triangle whole_t = mesh.triangles[t];
        const auto is_corner = [&](int v) { return std::ranges::count(whole_t, v) == 1; };
        if (!is_corner(e.a) || !is_corner(e.b) || !is_corner(e.opposite[0])) continue;
        const auto part = [&](int replaced) {
          Triangle result = whole_t;
          std::ranges::replace(result, replaced, middle);
          return result;
        };
        mesh.triangles[t] = part(e.a);
        mesh.triangles.push_back(part(e.b));
        mesh.triangles.push_back(part(e.opposite[0]));
      }
    }
    ASSERT_LT(least_height_share(mesh), 1e-3);
    const MeshWithoutSlivers result = remove_slivers(mesh);
    EXPECT_GT(least_height_share(result.mesh), kFlatness) << seed;
    EXPECT_EQ(euler_of(result.mesh), euler_of(whole)) << seed;
    EXPECT_EQ(max_triangles_at_an_edge(result.mesh), 2) << seed;
    EXPECT_EQ(count_surface_edges(result.mesh).border > 0, seed % 2 == 1) << seed;
    EXPECT_NEAR(area_of(result.mesh), area_of(whole), 0.01 * area_of(whole)) << seed;
    expect_corners_in_place(mesh, result, 0.02);
    const MeshWithoutSlivers again = remove_slivers(result.mesh);
    EXPECT_EQ(again.num_collapsed + again.num_divided, 0);
  }
}

}  // namespace
}  // namespace weft::engine
