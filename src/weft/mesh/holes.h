#pragma once
/// Holes in the surface of a solid, and their filling.

#include "weft/mesh/triangle_mesh.h"

namespace weft::engine {

struct FilledHoles {
  int count = 0;
  double largest = 0;  // diameter of a circle with the area of the largest one [m]
};

/// Fills holes with triangles between the vertices of their borders, appended to the mesh. A shell stays open
/// - if its holes have more than `max_share` of its area [1],
/// - if it would enclose no volume, such as a flat sheet,
/// - if it has an edge of more than two triangles, not as many in one direction as in the other,
/// - or if a filling triangle would have no area.
/// Triangles must face consistently (see orient_triangles()).
FilledHoles fill_holes(TriangleMesh& mesh, double max_share);

}  // namespace weft::engine
