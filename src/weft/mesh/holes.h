#pragma once
/// Holes in the shells of a mesh, and their filling.

#include "weft/mesh/triangle_mesh.h"

namespace weft::engine {

struct FilledHoles {
  int count = 0;       // holes that were filled
  double largest = 0;  // diameter of the circle of the largest one's area [m]
};

/// Fills the holes of shells whose holes have at most `most` times the area of the shell itself, and makes these
/// shells closed: triangles between the vertices of each border, appended to the mesh. Triangles must face
/// consistently (see orient_triangles()); the area of a hole is that of its border's vector area. Left open are
/// shells with borders that end at edges of more than two triangles.
FilledHoles fill_holes(TriangleMesh& mesh, double most);

}  // namespace weft::engine
