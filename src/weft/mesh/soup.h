#pragma once
/// Triangle soups: every triangle has its own three vertices, in order. Files show cloth that tears in this way, for
/// their meshes cannot change from frame to frame.

#include <span>
#include <vector>

#include "weft/mesh/triangle_mesh.h"

namespace weft::engine {

std::vector<Triangle> make_soup(int num_triangles);
bool is_soup(const std::vector<Triangle>& triangles);

/// The triangles, with the first vertex of the same position in place of each corner. `positions` are
/// (num_vertices x 3).
std::vector<Triangle> join_soup(const std::vector<Triangle>& triangles, std::span<const float> positions);

}  // namespace weft::engine
