#pragma once
/// Meshes of implicit surfaces, and cutting them.

#include <Eigen/Geometry>
#include <functional>

#include "weft/mesh/triangle_mesh.h"

namespace weft::engine::wardrobe {

/// Negative inside, positive outside; about a distance near its zeros [m].
using Field = std::function<double(const Vec3&)>;

/// The zeros of a field by naive surface nets (Gibson 1998), drawn on to them; closed where it does not leave
/// the box, facing outwards. Cells have side `cell` [m].
TriangleMesh build_isosurface(const Field& field, const Eigen::AlignedBox3d& box, double cell);

/// The points p with normal · p <= offset.
struct HalfSpace {
  Vec3 normal;  // unit length
  double offset = 0;
};

/// What of the mesh lies in the half space. Vertices nearer to its border than `snap` are drawn on to it, so
/// that no slivers arise; 0: they do arise [m].
TriangleMesh clip(const TriangleMesh& mesh, const HalfSpace& kept, double snap);

/// Unit vectors (num_vertices), means over the triangles by area.
std::vector<Vec3> compute_normals(const TriangleMesh& mesh);

/// Adds the triangles of another mesh, with vertices of their own.
void append(TriangleMesh& mesh, const TriangleMesh& other);

}  // namespace weft::engine::wardrobe
