#pragma once
/// Normals to draw meshes with.

#include <span>
#include <vector>

#include "weft/mesh/triangle_mesh.h"

namespace weft::engine {

/// Unit normals of the vertices (num_vertices x 3), by area: the sum of the cross products of the triangles
/// around. Up where that is too short to have a direction. `positions` are (num_vertices x 3) [m].
std::vector<float> compute_vertex_normals(const std::vector<Triangle>& triangles,
                                          std::span<const float> positions);

}  // namespace weft::engine
