#pragma once
/// Vertex normals.

#include <span>
#include <vector>

#include "weft/mesh/triangle_mesh.h"

namespace weft::engine {

/// Of each vertex, the sum of the cross products of the triangles around it (num_vertices) [m²]. `position(vertex)` is a
/// Vec3.
template <class Position>
std::vector<Vec3> sum_triangle_normals(const std::vector<Triangle>& triangles, std::size_t num_vertices,
                                       const Position& position) {
  std::vector<Vec3> sums(num_vertices, Vec3::Zero());
  for (const auto& [a, b, c] : triangles) {
    const Vec3 x = position(a);
    const Vec3 area = (position(b) - x).cross(position(c) - x);
    for (const int v : {a, b, c}) sums[v] += area;
  }
  return sums;
}

/// Area-weighted unit normals of the vertices (num_vertices x 3). Up if the sum is too short. `positions` are (num_vertices x 3) [m].
/// Vertices of a triangle soup (soup.h) in one place have the same normal.
std::vector<float> compute_vertex_normals(const std::vector<Triangle>& triangles,
                                          std::span<const float> positions);

}  // namespace weft::engine
