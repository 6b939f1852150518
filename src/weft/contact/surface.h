#pragma once
/// The triangles of all cloths and mesh colliders under one numbering, and who stands for whose vertices and
/// edges.

#include <array>
#include <vector>

#include "weft/mesh/triangle_mesh.h"

namespace weft {

/// Each vertex and each edge is owned by one of the triangles around it. Every vertex–triangle pair and every
/// edge–edge pair then belongs to exactly one pair of triangles, and is found once.
struct Surface {
  struct OwnedFeatures {
    std::array<int, 3> vertex = {-1, -1, -1};  // -1: another triangle's
    std::array<int, 3> edge = {-1, -1, -1};
  };

  std::vector<Triangle> triangles;        // vertices under the common numbering
  std::vector<std::array<int, 2>> edges;  // each once
  std::vector<OwnedFeatures> owned;       // (triangles)
  std::vector<int> fan_begin;             // (vertices + 1) of `fan`
  std::vector<int> fan;                   // the triangles around each vertex
  int num_vertices = 0;

  /// Appends a mesh, whose vertex v becomes num_vertices (before) + v.
  void add(const std::vector<Triangle>& mesh_triangles, int mesh_vertices);

  /// To be called after the last add().
  void build_fans();
};

/// Vertices that the two triangles have in common, 0 to 3.
int num_shared_vertices(const Triangle& a, const Triangle& b);

}  // namespace weft
