#pragma once
/// Triangulation of polygons in space.

#include <vector>

#include "weft/mesh/triangle_mesh.h"

namespace weft::engine {

/// The n - 2 triangles of a polygon with n >= 3 corners at `x` [m], as numbers of the corners, by ear clipping.
/// It may be concave, and need not be plane.
std::vector<Triangle> triangulate(const std::vector<Vec3>& x);

}  // namespace weft::engine
