/// Tears in meshes: which vertices part, and how they are numbered.

#include "weft/mesh/tear.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>
#include <random>
#include <set>

#include "tests/message_of.h"
#include "weft/mesh/grid.h"
#include "weft/mesh/soup.h"
#include "weft/mesh/vertex_normals.h"

namespace weft::engine {
namespace {

/// 3 × 3 vertices; 4 is inner.
RestMesh make_square() {
  return build_grid_mesh({.size_x = 2, .size_z = 2, .cells_x = 2, .cells_z = 2}, GridDiagonals::parallel);
}

int edge_between(const RestMesh& mesh, int a, int b) {
  const std::vector<Edge> edges = build_edges(mesh);
  const auto found = std::ranges::find_if(edges, [&](const Edge& e) { return e.a == a && e.b == b; });
  EXPECT_NE(found, edges.end());
  return static_cast<int>(found - edges.begin());
}

std::vector<int> edges_between(const RestMesh& mesh, const std::vector<std::array<int, 2>>& pairs) {
  std::vector<int> edges;
  for (const auto& [a, b] : pairs) edges.push_back(edge_between(mesh, a, b));
  std::ranges::sort(edges);
  return edges;
}

/// The number of pieces that share no vertex.
int count_pieces(const RestMesh& mesh) {
  std::vector<int> piece(mesh.positions.size());
  std::iota(piece.begin(), piece.end(), 0);
  for (std::size_t round = 0; round < mesh.triangles.size(); ++round) {
    for (const Triangle& t : mesh.triangles) {
      const int least = std::min({piece[t[0]], piece[t[1]], piece[t[2]]});
      for (const int v : t) piece[v] = least;
    }
  }
  return static_cast<int>(std::set<int>(piece.begin(), piece.end()).size());
}

TEST(Tear, OneEdgeAtAnInnerVertexOpensNothing) {
  const RestMesh whole = make_square();
  const RestMesh torn = tear_mesh(whole, edges_between(whole, {{4, 5}}));
  // 5 is on the border: there one edge is enough.
  EXPECT_EQ(torn.num_vertices(), 10);
  EXPECT_EQ(count_pieces(torn), 1);
}

TEST(Tear, TwoEdgesAtAnInnerVertexMakeASlit) {
  const RestMesh whole =
      build_grid_mesh({.size_x = 4, .size_z = 4, .cells_x = 4, .cells_z = 4}, GridDiagonals::parallel);
  const RestMesh torn = tear_mesh(whole, edges_between(whole, {{11, 12}, {12, 13}}));
  ASSERT_EQ(torn.num_vertices(), 26);
  EXPECT_EQ(count_pieces(torn), 1);
  int num_whole = 0, num_part = 0;
  for (const Triangle& t : torn.triangles) {
    num_whole += static_cast<int>(std::ranges::count(t, 12));
    num_part += static_cast<int>(std::ranges::count(t, 25));
  }
  EXPECT_EQ(num_whole, 3);
  EXPECT_EQ(num_part, 3);
}

TEST(Tear, AcrossTheMeshItMakesTwoPieces) {
  const RestMesh whole = make_square();
  const RestMesh torn = tear_mesh(whole, edges_between(whole, {{3, 4}, {4, 5}}));
  EXPECT_EQ(torn.num_vertices(), 12);
  EXPECT_EQ(count_pieces(torn), 2);
}

TEST(Tear, TheMiddleOfAFanOfAllEdgesFallsApart) {
  const RestMesh whole = make_square();
  std::vector<int> all(build_edges(whole).size());
  std::iota(all.begin(), all.end(), 0);
  const RestMesh torn = tear_mesh(whole, all);
  EXPECT_EQ(torn.num_vertices(), 3 * whole.num_triangles());
  EXPECT_EQ(count_pieces(torn), whole.num_triangles());
}

TEST(Tear, KeepsTrianglesNumbersAndRestShapes) {
  const RestMesh whole = make_square();
  const RestMesh torn = tear_mesh(whole, edges_between(whole, {{3, 4}, {4, 5}}));
  ASSERT_EQ(torn.num_triangles(), whole.num_triangles());
  const std::vector<int> source = find_same_corners(torn.triangles, torn.num_vertices(), whole.triangles);
  for (int v = 0; v < whole.num_vertices(); ++v) EXPECT_EQ(source[v], v);
  for (int t = 0; t < whole.num_triangles(); ++t) {
    for (int k = 0; k < 3; ++k) {
      EXPECT_EQ(source[torn.triangles[t][k]], whole.triangles[t][k]);
      EXPECT_EQ(torn.corners(t)[k], whole.corners(t)[k]);
    }
  }
  // The two sides do not lie in the same place.
  EXPECT_GT((torn.positions[4] - torn.positions[10]).norm(), 0.01);
}

TEST(Tear, MoreBrokenEdgesNeverJoinWhatIsApart) {
  const RestMesh whole =
      build_grid_mesh({.size_x = 5, .size_z = 5, .cells_x = 5, .cells_z = 5}, GridDiagonals::alternating);
  std::mt19937 random(7);
  std::vector<int> all(build_edges(whole).size());
  std::iota(all.begin(), all.end(), 0);
  for (int round = 0; round < 20; ++round) {
    std::ranges::shuffle(all, random);
    std::vector<int> first(all.begin(), all.begin() + 10), both(all.begin(), all.begin() + 30);
    std::ranges::sort(first);
    std::ranges::sort(both);
    const RestMesh one = tear_mesh(whole, first), two = tear_mesh(whole, both);
    // No corners that were apart join again.
    const std::vector<int> source = find_same_corners(two.triangles, two.num_vertices(), one.triangles);
    for (int t = 0; t < whole.num_triangles(); ++t) {
      for (int k = 0; k < 3; ++k) EXPECT_EQ(source[two.triangles[t][k]], one.triangles[t][k]);
    }
    EXPECT_GE(two.num_vertices(), one.num_vertices());
  }
}

TEST(Tear, AMeshThatOnlyTouchesItselfStaysInTouchElsewhere) {
  // Two triangles that share one vertex, and a third beside the first.
  RestMesh whole;
  whole.positions = {{0, 0, 0}, {1, 0, 0}, {1, 0, 1}, {-1, 0, 0}, {-1, 0, 1}, {2, 0, 0}};
  whole.triangles = {{0, 1, 2}, {0, 3, 4}, {1, 5, 2}};
  EXPECT_EQ(tear_mesh(whole, {}).num_vertices(), 6);
  const RestMesh torn = tear_mesh(whole, edges_between(whole, {{1, 2}}));
  EXPECT_EQ(torn.num_vertices(), 8);
  EXPECT_EQ(torn.triangles[0][0], torn.triangles[1][0]);
}

TEST(Tear, RefusesEdgesThatAreNotThere) {
  const RestMesh whole = make_square();
  EXPECT_EQ(message_of([&] { tear_mesh(whole, std::vector<int>{16}); }),
            "edge 16 cannot tear: the mesh has 16");
}

TEST(Soup, IsJoinedWhereVerticesCoincide) {
  const RestMesh whole = make_square();
  const std::vector<Triangle> soup = make_soup(whole.num_triangles());
  EXPECT_TRUE(is_soup(soup));
  EXPECT_FALSE(is_soup(whole.triangles));
  std::vector<float> positions, own;
  for (const Triangle& t : whole.triangles) {
    for (const int v : t) {
      for (const double c : whole.positions[v]) positions.push_back(static_cast<float>(c));
    }
  }
  std::set<int> vertices;
  for (const Triangle& t : join_soup(soup, positions)) vertices.insert(t.begin(), t.end());
  EXPECT_EQ(vertices.size(), 9U);
}

TEST(Soup, HasTheNormalsOfTheMesh) {
  RestMesh whole = make_square();
  for (std::size_t v = 0; v < whole.positions.size(); ++v)
    whole.positions[v].y() = 0.1 * static_cast<double>(v * v % 5);
  std::vector<float> of_mesh, of_soup;
  for (const Vec3& p : whole.positions) {
    for (const double c : p) of_mesh.push_back(static_cast<float>(c));
  }
  for (const Triangle& t : whole.triangles) {
    for (const int v : t) of_soup.insert(of_soup.end(), &of_mesh[3 * v], &of_mesh[3 * v] + 3);
  }
  const std::vector<float> expected = compute_vertex_normals(whole.triangles, of_mesh),
                           found = compute_vertex_normals(make_soup(whole.num_triangles()), of_soup);
  for (int t = 0; t < whole.num_triangles(); ++t) {
    for (int k = 0; k < 3; ++k) {
      for (int c = 0; c < 3; ++c)
        EXPECT_NEAR(found[3 * (3 * t + k) + c], expected[3 * whole.triangles[t][k] + c], 1e-6);
    }
  }
}

}  // namespace
}  // namespace weft::engine
