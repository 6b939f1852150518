#pragma once
/// A triangle mesh: positions and indices, no physics.

#include <array>
#include <vector>

#include "weft/core/vec.h"
#include "weft/mesh.h"

namespace weft::engine {

/// Texture coordinates of a triangle's corners: a vertex on a texture seam has several.
using CornerUv = std::array<Eigen::Vector2d, 3>;

/// The corner, 0 to 2, at which a triangle has one of its vertices.
inline int corner_of(const Triangle& triangle, int vertex) {
  return triangle[0] == vertex ? 0 : triangle[1] == vertex ? 1 : 2;
}

/// The places of a triangle's corners [m].
using TriangleCorners = std::array<Vec3, 3>;

/// Corners of a part of a triangle, in it: barycentric coordinates by corner, each summing to 1.
using CornerWeights = std::array<Vec3, 3>;

/// Identity: a triangle's corners in itself.
inline CornerWeights make_whole_weights() { return {Vec3::UnitX(), Vec3::UnitY(), Vec3::UnitZ()}; }

/// Texture coordinates of a part of a triangle; corners without any (NaN) do not affect others.
CornerUv interpolate(const CornerUv& uv, const CornerWeights& weights);

struct TriangleMesh {
  std::vector<Vec3> positions;      // (num_vertices) [m]
  std::vector<Triangle> triangles;  // (num_triangles)

  int num_vertices() const { return static_cast<int>(positions.size()); }
  int num_triangles() const { return static_cast<int>(triangles.size()); }
};

/// Throws InputError for coordinates that are not finite, indices out of range, and a mesh without triangles.
void require_valid(const TriangleMesh& mesh);

/// Area of triangle t [m²].
double triangle_area(const TriangleMesh& mesh, int t);

/// A third of the area of the triangles around each vertex (num_vertices) [m²].
std::vector<double> compute_vertex_areas(const TriangleMesh& mesh);

/// An edge a–b (a < b) and the vertices opposite to it in the triangles on its two sides.
///
///            opposite[0]
///             /       \          On the border only opposite[0] exists and opposite[1] is -1.
///            a ------- b         num_triangles > 2 marks a non-manifold edge; only the first two
///             \       /          opposite vertices are kept.
///            opposite[1]
struct Edge {
  int a = 0, b = 0;
  int opposite[2] = {-1, -1};
  int num_triangles = 0;
  int triangles[2] = {-1, -1};  // with the opposite vertices
};

/// Every edge once, sorted by (a, b).
std::vector<Edge> build_edges(const TriangleMesh& mesh);

/// A sphere of about `rings` rings of triangles, for display.
TriangleMesh make_sphere_mesh(const Vec3& center, double radius, int rings);

/// The capsule around the segment a–b, outward, for display: its two hemispheres have about `rings` rings
/// together.
TriangleMesh make_capsule_mesh(const Vec3& a, const Vec3& b, double radius, int rings);

/// A box rotated by `rotation` around its centre, outward, for display: each face has its own corners, so
/// that edges are drawn sharp.
TriangleMesh make_box_mesh(const Vec3& center, const Vec3& half_size, const Mat3& rotation);

/// A square of the given side around `point`, perpendicular to the unit vector `normal`, for display.
TriangleMesh make_square_mesh(const Vec3& point, const Vec3& normal, double side);

}  // namespace weft::engine
