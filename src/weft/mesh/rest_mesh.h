#pragma once
/// A cloth's mesh. Its triangles may have another shape at rest, as those of a pattern or of elastic.

#include <array>
#include <utility>
#include <vector>

#include "weft/mesh/triangle_mesh.h"

namespace weft::engine {

struct RestMesh : TriangleMesh {
  /// Triangles at rest, each in the plane of the mesh's one, turned as that (polar decomposition of the deformation
  /// between them), then scaled; empty: those of the mesh. An edge may have different lengths in its two triangles.
  std::vector<TriangleCorners> at_rest;  // (num_triangles) or empty [m]

  RestMesh() = default;
  RestMesh(TriangleMesh mesh) : TriangleMesh(std::move(mesh)) {}

  /// Triangle t at rest.
  TriangleCorners corners(int t) const {
    if (!at_rest.empty()) return at_rest[t];
    const auto& [a, b, c] = triangles[t];
    return {positions[a], positions[b], positions[c]};
  }

  /// From vertex a to vertex b of triangle t, at rest [m].
  Vec3 between(int t, int a, int b) const {
    if (at_rest.empty()) return positions[b] - positions[a];
    return at_rest[t][corner_of(triangles[t], b)] - at_rest[t][corner_of(triangles[t], a)];
  }
};

/// Area of triangle t at rest [m²].
double triangle_area(const RestMesh& mesh, int t);

/// A third of the area of the triangles around each vertex, at rest (num_vertices) [m²].
std::vector<double> compute_vertex_areas(const RestMesh& mesh);

/// The mean of an edge's lengths in its first two triangles, at rest [m].
double edge_length(const RestMesh& mesh, const Edge& edge);

/// Whether a triangle is no sliver: its height is at least 2 % of its longest edge, as in a clean mesh.
bool has_area(const TriangleCorners& corners);

/// Gives a mesh's triangles the shape of others, which may lie anywhere (num_triangles). Slivers (see has_area)
/// get that of the mesh. Returns their number.
int set_rest(RestMesh& mesh, const std::vector<TriangleCorners>& given);

}  // namespace weft::engine
