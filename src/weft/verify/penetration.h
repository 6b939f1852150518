#pragma once
/// Penetration depth of cloth in solid shapes: of whole triangles, not only their corners, for primitive
/// shapes.

#include <optional>
#include <span>
#include <variant>
#include <vector>

#include "weft/core/shapes.h"
#include "weft/verify/crossings.h"

namespace weft::engine::verify {

/// Depth of the deepest point of a triangle: its distance from the solid's surface, positive inside [m].
/// Depth in a convex solid is a concave function, so it has one maximum over a triangle, which is computed
/// directly:
///
///   sphere, capsule   radius less the distance between triangle and centre or axis
///   half space        at the lowest corner
///   box               the maximum, over the triangle, of the minimum distance to the six faces' planes
///
/// Not positive if no point of the triangle is inside (and then no measure of distance for boxes).
double depth_in(const Sphere& sphere, const Corners& triangle);
double depth_in(const Plane& plane, const Corners& triangle);
double depth_in(const Capsule& capsule, const Corners& triangle);
double depth_in(const OrientedBox& box, const Corners& triangle);

/// Axis-aligned bounding box of the shape.
Eigen::AlignedBox3d bounds_of(const Sphere& sphere);
Eigen::AlignedBox3d bounds_of(const Plane& plane);
Eigen::AlignedBox3d bounds_of(const Capsule& capsule);
Eigen::AlignedBox3d bounds_of(const OrientedBox& box);

/// A triangle mesh in one frame.
struct MeshView {
  std::span<const Vec3> positions;  // [m]
  std::span<const Triangle> triangles;
  std::span<const Triangle> solid = {};  // those with an inside: see find_solid_triangles()
};

/// The triangles of closed parts, which have an inside: of those that edges connect (of two
/// triangles, or of as many in both directions), with every edge equally often in both directions.
std::vector<Triangle> find_solid_triangles(std::span<const Triangle> triangles);

using Solid = std::variant<Sphere, Plane, Capsule, OrientedBox, MeshView>;

/// Deepest penetration of cloth into a solid.
struct Penetration {
  double depth = 0;   // 0: nowhere inside [m]
  int cloth = -1;     // index, -1: nowhere inside
  int triangle = -1;  // of the cloth, for primitive shapes
  int particle = -1;  // of the cloth, for meshes
  int solid = -1;     // index
};

/// The deepest penetration of all cloths in all solids. In closed parts of meshes particles are tested, not
/// triangles: inside means a nonzero winding number (exact, for any degenerate ray), depth the distance to the nearest
/// triangle. Open parts are skipped. Empty if no solid has an inside.
std::optional<Penetration> find_deepest(std::span<const SurfaceView> cloths, std::span<const Solid> solids);

}  // namespace weft::engine::verify
