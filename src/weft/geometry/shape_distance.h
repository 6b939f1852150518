#pragma once
/// Signed distances from points and triangles to the solid shapes of core/shapes.h: negative inside.
///
///            o-------o             o p                       For a triangle: the smallest signed distance of
///             \     /              |  distance > 0           all its points, so that it is negative as soon
///              \   /               ^ normal                  as a corner, an edge or the face reaches into
///          _____\ /______     _____|________                 the solid. Every shape here is convex, so its
///         |      o       |   |              |                signed distance is a convex function, and the
///         | distance < 0 |   |              |                smallest is one number.
///
/// The normal is the gradient of the signed distance at that point: the unit direction out of the solid. For
/// a triangle with weights w the distance changes with the corners by ∂d/∂x_i = w_i normal.
///
/// Distances are accurate to about 1e-14 of the largest length involved (shape, triangle, and distance
/// between them), normals to that over the distance. Where two features are equally near to within rounding,
/// the normal is that of either.

#include <limits>

#include "weft/core/shapes.h"
#include "weft/core/vec.h"

namespace weft::engine {

struct SignedDistance {
  double distance;  // [m]
  Vec3 normal;      // outwards, unit length [1]
};

struct TriangleSignedDistance {
  double distance;  // [m]
  Vec3 weights;     // of the deepest point: in [0, 1], sum 1 [1]
  Vec3 normal;      // outwards there, unit length [1]
};

/// Signed distance of a point. Where the gradient is not unique, the normal is fixed: at a sphere's centre
/// and on a capsule's axis up, inside a box that of the nearest face (of equally near ones the first, x
/// before y before z).
SignedDistance signed_distance(const Sphere& sphere, const Vec3& p);
SignedDistance signed_distance(const Plane& plane, const Vec3& p);
SignedDistance signed_distance(const Capsule& capsule, const Vec3& p);
SignedDistance signed_distance(const OrientedBox& box, const Vec3& p);

/// Signed distance of the triangle abc, which may be an edge or a point. `reach` [m] is a search limit: if
/// the distance is surely greater, the search ends early and the result is only guaranteed to be > reach. Of
/// several deepest points the result is one.

constexpr double kNoReach = std::numeric_limits<double>::infinity();

/// Normal if the centre is on the triangle: the triangle's, (b − a) × (c − a); up if it has no area.
TriangleSignedDistance signed_distance(const Sphere& sphere, const Vec3& a, const Vec3& b, const Vec3& c,
                                       double reach = kNoReach);

/// The deepest point is a corner.
TriangleSignedDistance signed_distance(const Plane& plane, const Vec3& a, const Vec3& b, const Vec3& c,
                                       double reach = kNoReach);

/// Normal if the axis pierces the triangle (the distance is −radius): the triangle's, on the side of the
/// nearer end of the axis, so that the triangle is pushed off the shorter part; some direction across the
/// axis if it has no area.
TriangleSignedDistance signed_distance(const Capsule& capsule, const Vec3& a, const Vec3& b, const Vec3& c,
                                       double reach = kNoReach);

/// If the triangle meets the box, the distance is −(the largest, over the triangle's points, of the distance
/// to the nearest face), and the normal is that face's. Of faces equally near (a deepest point inside the
/// triangle or on its edge has two or three), it is the one through which the whole triangle has the shortest
/// way out.
TriangleSignedDistance signed_distance(const OrientedBox& box, const Vec3& a, const Vec3& b, const Vec3& c,
                                       double reach = kNoReach);

/// Distance between two axis-aligned boxes, given by their corners; 0 if they meet [m].
double boxes_distance(const Vec3& min_a, const Vec3& max_a, const Vec3& min_b, const Vec3& max_b);

/// Support function: the largest normal · p of all points p of the shape [m].
double support(const Sphere& sphere, const Vec3& normal);
double support(const Capsule& capsule, const Vec3& normal);
double support(const OrientedBox& box, const Vec3& normal);

}  // namespace weft::engine
