#pragma once
/// Private to mesh/: the edges of triangles, those of one edge together.

#include <algorithm>
#include <span>
#include <tuple>
#include <vector>

#include "weft/mesh/triangle_mesh.h"

namespace weft::engine {

struct TriangleEdge {
  int a = 0, b = 0;          // vertices, a < b
  bool is_ascending = true;  // whether the triangle runs from a to b
  int triangle = 0;
};

/// Sorted by a, b and triangle.
inline std::vector<TriangleEdge> find_triangle_edges(const TriangleMesh& mesh) {
  std::vector<TriangleEdge> edges;
  edges.reserve(3 * mesh.triangles.size());
  for (int t = 0; t < mesh.num_triangles(); ++t) {
    for (int k = 0; k < 3; ++k) {
      const int from = mesh.triangles[t][k], to = mesh.triangles[t][(k + 1) % 3];
      edges.push_back({std::min(from, to), std::max(from, to), from < to, t});
    }
  }
  std::sort(edges.begin(), edges.end(), [](const TriangleEdge& e, const TriangleEdge& f) {
    return std::tie(e.a, e.b, e.triangle) < std::tie(f.a, f.b, f.triangle);
  });
  return edges;
}

/// Calls visit(span of TriangleEdge) for each edge of the mesh.
template <class Visit>
void for_each_edge(const std::vector<TriangleEdge>& edges, const Visit& visit) {
  for (std::size_t begin = 0, end = 0; begin < edges.size(); begin = end) {
    while (end < edges.size() && edges[end].a == edges[begin].a && edges[end].b == edges[begin].b) ++end;
    visit(std::span(edges).subspan(begin, end - begin));
  }
}

/// Whether as many triangles run along the edge in one direction as in the other.
inline bool is_balanced(std::span<const TriangleEdge> same) {
  return 2 * std::ranges::count(same, true, &TriangleEdge::is_ascending) == std::ssize(same);
}

}  // namespace weft::engine
