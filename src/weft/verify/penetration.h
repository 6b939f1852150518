#pragma once
/// How deep cloth is inside solid shapes: whole triangles, not only their corners, wherever the shape is
/// given by a formula.

#include <optional>
#include <span>
#include <variant>
#include <vector>

#include "weft/core/shapes.h"
#include "weft/verify/crossings.h"

namespace weft::engine::verify {

/// Depth of the deepest point of a triangle: its distance from the solid's surface, positive inside [m].
/// Depth in a convex solid is a concave function, so it has one greatest value over a triangle, which is
/// found directly:
///
///   sphere, capsule   radius less the distance between triangle and centre or axis
///   half space        at the lowest corner
///   box               the greatest, over the triangle, of the least of the six distances to the faces'
///   planes
///
/// Not positive where no point of the triangle is inside (and then no measure of distance for boxes).
double depth_in(const Sphere& sphere, const Corners& triangle);
double depth_in(const Plane& plane, const Corners& triangle);
double depth_in(const Capsule& capsule, const Corners& triangle);
double depth_in(const OrientedBox& box, const Corners& triangle);

/// The smallest box along the axes that holds the shape.
Eigen::AlignedBox3d bounds_of(const Sphere& sphere);
Eigen::AlignedBox3d bounds_of(const Plane& plane);
Eigen::AlignedBox3d bounds_of(const Capsule& capsule);
Eigen::AlignedBox3d bounds_of(const OrientedBox& box);

/// A triangle mesh at one moment.
struct MeshView {
  std::span<const Vec3> positions;  // [m]
  std::span<const Triangle> triangles;
  bool is_closed = false;  // see is_closed(); of open meshes no inside is known
};

/// True if every edge is run through as often in one direction as in the other, so that the mesh has an
/// inside.
bool is_closed(std::span<const Triangle> triangles);

using Solid = std::variant<Sphere, Plane, Capsule, OrientedBox, MeshView>;

/// Where cloth is deepest inside a solid.
struct Penetration {
  double depth = 0;   // 0: nowhere inside [m]
  int cloth = -1;     // index, -1: nowhere inside
  int triangle = -1;  // of the cloth, in shapes given by a formula
  int particle = -1;  // of the cloth, in meshes
  int solid = -1;     // index
};

/// The deepest place of all cloths in all solids. In closed meshes particles are tested, not triangles:
/// inside is where the surface winds round a point (exact, whatever edges a ray hits), depth the distance to
/// the nearest triangle. Open meshes are passed over. Empty if there is nothing to be inside of.
std::optional<Penetration> find_deepest(std::span<const SurfaceView> cloths, std::span<const Solid> solids);

}  // namespace weft::engine::verify
