#pragma once
/// Vertex normals for rendering.

#include <span>
#include <vector>

#include "weft/mesh/triangle_mesh.h"

namespace weft::engine {

/// Area-weighted unit normals of the vertices (num_vertices x 3): sums of the cross products of the triangles
/// around. Up if the sum is too short. `positions` are (num_vertices x 3) [m].
std::vector<float> compute_vertex_normals(const std::vector<Triangle>& triangles,
                                          std::span<const float> positions);

}  // namespace weft::engine
