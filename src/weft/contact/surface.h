#pragma once
/// The triangles of all cloths and mesh colliders under one numbering, and the owner triangle of each vertex
/// and edge.

#include <algorithm>
#include <array>
#include <span>
#include <vector>

#include "weft/mesh/triangle_mesh.h"

namespace weft::engine {

inline bool has_vertex(const Triangle& t, int v) { return v == t[0] || v == t[1] || v == t[2]; }

/// Each vertex and each edge is owned by one adjacent triangle. Every vertex–triangle pair and every
/// edge–edge pair then belongs to exactly one pair of triangles, and is found once.
struct Surface {
  struct OwnedFeatures {
    std::array<int, 3> vertex = {-1, -1, -1};  // -1: owned by another triangle
    std::array<int, 3> edge = {-1, -1, -1};
  };

  std::vector<Triangle> triangles;        // vertices under the common numbering
  std::vector<std::array<int, 2>> edges;  // each once
  std::vector<OwnedFeatures> owned;       // (triangles)
  std::vector<int> one_ring_begin;        // (vertices + 1) into `one_ring`
  std::vector<int> one_ring;              // one-rings: the triangles around each vertex
  int num_vertices = 0;

  /// The one-ring of a vertex: its triangles, in ascending order.
  std::span<const int> triangles_at(int vertex) const {
    return std::span(one_ring).subspan(one_ring_begin[vertex],
                                       one_ring_begin[vertex + 1] - one_ring_begin[vertex]);
  }

  /// Calls body(triangle number) for the triangles that have all of these vertices.
  template <class Body>
  void for_triangles_with(std::span<const int> vertices, const Body& body) const {
    for (const int t : triangles_at(vertices[0])) {
      const auto is_corner = [&](int v) { return has_vertex(triangles[t], v); };
      if (std::all_of(vertices.begin(), vertices.end(), is_corner)) body(t);
    }
  }

  /// Appends a mesh, whose vertex v becomes num_vertices (before the call) + v.
  void add(const std::vector<Triangle>& mesh_triangles, int mesh_vertices);

  /// Builds the one-rings. Call it after the last add().
  void build_one_rings();
};

/// Number of vertices that the two triangles share, 0 to 3.
int num_shared_vertices(const Triangle& a, const Triangle& b);

/// The mesh, of several, that a vertex belongs to; `first_vertex` (meshes + 1) ascends.
int mesh_of(const std::vector<int>& first_vertex, int vertex);

}  // namespace weft::engine
