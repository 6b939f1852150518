#include <gtest/gtest.h>

#include <map>
#include <numeric>
#include <set>

#include "weft/io/obj_reader.h"
#include "weft/mesh/clean.h"

namespace weft::engine {
namespace {

MeshFromFile read_tshirt() { return read_obj(WEFT_SOURCE_DIR "/scenes/garments/tshirt.obj"); }

TriangleMesh sew_tshirt() { return clean_mesh(read_tshirt().mesh, {.weld_distance = 1e-6}).mesh; }

/// Sets of vertices that are connected by the edges.
int count_components(int num_vertices, const std::vector<std::pair<int, int>>& edges) {
  std::vector<int> parent(num_vertices);
  std::iota(parent.begin(), parent.end(), 0);
  const auto root = [&](int v) {
    while (parent[v] != v) v = parent[v] = parent[parent[v]];
    return v;
  };
  for (const auto& [a, b] : edges) parent[root(a)] = root(b);
  int count = 0;
  for (int v = 0; v < num_vertices; ++v) count += parent[v] == v;
  return count;
}

TEST(TShirt, ReadsWithoutWarningsAsTwoPanels) {
  const MeshFromFile shirt = read_tshirt();
  EXPECT_TRUE(shirt.warnings.empty());
  std::vector<std::pair<int, int>> edges;
  for (const Edge& edge : build_edges(shirt.mesh)) edges.push_back({edge.a, edge.b});
  EXPECT_EQ(count_components(shirt.mesh.num_vertices(), edges), 2);
}

TEST(TShirt, IsOneManifoldWithFourOpeningsOnceSewn) {
  const CleanMesh shirt = clean_mesh(read_tshirt().mesh, {.weld_distance = 1e-6});
  EXPECT_TRUE(shirt.warnings.empty()) << shirt.warnings[0];
  const TriangleMesh& mesh = shirt.mesh;
  EXPECT_GT(mesh.num_vertices(), 2000);
  EXPECT_LT(mesh.num_vertices(), 3000);

  std::vector<std::pair<int, int>> edges, border;
  for (const Edge& edge : build_edges(mesh)) {
    EXPECT_LE(edge.num_triangles, 2);
    edges.push_back({edge.a, edge.b});
    if (edge.num_triangles == 1) border.push_back({edge.a, edge.b});
  }
  EXPECT_EQ(count_components(mesh.num_vertices(), edges), 1);

  std::map<int, int> border_degree;
  for (const auto& [a, b] : border) ++border_degree[a], ++border_degree[b];
  for (const auto& [v, degree] : border_degree) EXPECT_EQ(degree, 2) << "vertex " << v;
  const int inside = mesh.num_vertices() - static_cast<int>(border_degree.size());
  EXPECT_EQ(count_components(mesh.num_vertices(), border) - inside, 4);

  // A sphere with four holes: V - E + F = 2 - 4.
  EXPECT_EQ(mesh.num_vertices() - static_cast<int>(edges.size()) + mesh.num_triangles(), -2);
}

TEST(TShirt, IsTheSameShirtWhetherWeldedOrSewn) {
  const TriangleMesh welded = sew_tshirt();
  const CleanMesh sewn = clean_mesh(read_tshirt().mesh, {.sew_distance = 0.002});
  EXPECT_TRUE(sewn.warnings.empty()) << sewn.warnings[0];
  EXPECT_EQ(sewn.mesh.triangles, welded.triangles);
  EXPECT_EQ(sewn.mesh.positions, welded.positions);
}

TEST(TShirt, FacesOutwardEverywhere) {
  const TriangleMesh mesh = sew_tshirt();
  std::set<std::pair<int, int>> half_edges;  // each direction of an edge once: neighbours agree
  for (const auto& [a, b, c] : mesh.triangles) {
    for (const auto& half_edge : {std::pair(a, b), std::pair(b, c), std::pair(c, a)}) {
      EXPECT_TRUE(half_edges.insert(half_edge).second);
    }
    const Vec3 normal = (mesh.positions[b] - mesh.positions[a]).cross(mesh.positions[c] - mesh.positions[a]);
    const double z = mesh.positions[a].z() + mesh.positions[b].z() + mesh.positions[c].z();
    EXPECT_GT(normal.z() * z, 0);  // each panel is a height field over the plane z = 0
  }
}

TEST(TShirt, HasTheSizeOfAShirt) {
  const TriangleMesh mesh = sew_tshirt();
  double area = 0;
  for (int t = 0; t < mesh.num_triangles(); ++t) area += triangle_area(mesh, t);
  EXPECT_GT(area, 0.8);
  EXPECT_LT(area, 1.6);
  Vec3 low = mesh.positions[0], high = low;
  for (const Vec3& x : mesh.positions) {
    low = low.cwiseMin(x);
    high = high.cwiseMax(x);
  }
  EXPECT_EQ(low.x(), -high.x());  // centred, to the bit
  EXPECT_EQ(low.z(), -high.z());
  EXPECT_NEAR(low.y(), 0.85, 0.01);
  EXPECT_NEAR(high.y(), 1.45, 0.01);
}

TEST(TShirt, HasNoSliverTriangles) {
  const TriangleMesh mesh = sew_tshirt();
  for (const Triangle& triangle : mesh.triangles) {
    for (int k = 0; k < 3; ++k) {
      const Vec3& x = mesh.positions[triangle[k]];
      const Vec3 e = mesh.positions[triangle[(k + 1) % 3]] - x, f = mesh.positions[triangle[(k + 2) % 3]] - x;
      EXPECT_LT(e.normalized().dot(f.normalized()), 0.94);  // cos 20 degrees
    }
  }
}

}  // namespace
}  // namespace weft::engine
