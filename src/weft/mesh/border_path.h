#pragma once
/// Stretches of a mesh's borders.

#include <span>
#include <vector>

#include "weft/mesh/triangle_mesh.h"

namespace weft::engine {

/// The vertices of a border from the first of `stops` to the last, by way of the others in order, each time the
/// shorter way. A closed border in full needs four stops, the last equal to the first. Throws InputError for fewer
/// than two stops, stops that are not on one border or equal their successor, and two ways of equal length.
std::vector<int> find_border_path(const TriangleMesh& mesh, std::span<const int> stops);

}  // namespace weft::engine
