#pragma once
/// Meshes of implicit surfaces, and cutting them.

#include <Eigen/Geometry>
#include <functional>

#include "weft/mesh/triangle_mesh.h"

namespace weft::engine::wardrobe {

/// Negative inside, positive outside; about a distance near its zeros [m].
using Field = std::function<double(const Vec3&)>;

/// The zero set of a field by naive surface nets (Gibson 1998), with vertices projected on it. Closed if it
/// stays within the box, facing outwards. Cells have side `cell` [m].
TriangleMesh build_isosurface(const Field& field, const Eigen::AlignedBox3d& box, double cell);

/// The points p with normal · p <= offset.
struct HalfSpace {
  Vec3 normal;  // unit length
  double offset = 0;
};

/// The part of the mesh in the half space. Vertices nearer to its border than `snap` are moved onto it, which
/// avoids slivers; 0: with slivers [m].
TriangleMesh clip(const TriangleMesh& mesh, const HalfSpace& kept, double snap);

/// Unit vertex normals (num_vertices), area-weighted means over triangles.
std::vector<Vec3> compute_normals(const TriangleMesh& mesh);

/// Adds the triangles of another mesh, with separate vertices.
void append(TriangleMesh& mesh, const TriangleMesh& other);

}  // namespace weft::engine::wardrobe
