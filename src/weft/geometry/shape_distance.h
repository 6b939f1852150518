#pragma once
/// Signed distances from points and triangles to the solid shapes of core/shapes.h: negative inside.
///
///            o-------o             o p                       For a triangle: the smallest signed distance of
///            all its
///             \     /              |  distance > 0           points, so that it is negative as soon as a
///             corner, an
///              \   /               ^ normal                  edge or the face reaches into the solid. Every
///              shape
///          _____\ /______     _____|________                 here is convex, its signed distance then is a
///          convex
///         |      o       |   |              |                function, and the smallest is one number.
///         | distance < 0 |   |              |
///
/// The normal is the gradient of the signed distance at that point: the unit direction out of the solid. For
/// a triangle with weights w the distance changes with the corners by ∂d/∂x_i = w_i normal.
///
/// Distances are exact to some 1e-14 of the largest length in play (shape, triangle, and how far they are
/// apart), normals to as much over the distance; where two features are equally near to within rounding, the
/// normal is that of either.

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
  Vec3 weights;     // of the triangle's deepest point: in [0, 1], sum 1 [1]
  Vec3 normal;      // outwards there, unit length [1]
};

/// Of a point. Where the gradient has no one direction the normal is a fixed one: at a sphere's centre and on
/// a capsule's axis up, inside a box that of the nearest face (of equally near ones the first, x before y
/// before z).
SignedDistance signed_distance(const Sphere& sphere, const Vec3& p);
SignedDistance signed_distance(const Plane& plane, const Vec3& p);
SignedDistance signed_distance(const Capsule& capsule, const Vec3& p);
SignedDistance signed_distance(const OrientedBox& box, const Vec3& p);

/// Of the triangle abc, which may be an edge or a point. A caller that has no use for distances above `reach`
/// [m] says so: where the distance is surely greater, the result is found sooner and is only known to be >
/// reach. Of several deepest points it is one of them.

constexpr double kNoReach = std::numeric_limits<double>::infinity();

/// Normal where the centre is on the triangle: the triangle's own (b − a) × (c − a); up where it has no area.
TriangleSignedDistance signed_distance(const Sphere& sphere, const Vec3& a, const Vec3& b, const Vec3& c,
                                       double reach = kNoReach);

/// The deepest point is a corner.
TriangleSignedDistance signed_distance(const Plane& plane, const Vec3& a, const Vec3& b, const Vec3& c,
                                       double reach = kNoReach);

/// Normal where the axis goes through the triangle (the distance is −radius): the triangle's own, on the side
/// of the axis' nearer end, so that it is pushed off the shorter part; some direction across the axis if it
/// has no area.
TriangleSignedDistance signed_distance(const Capsule& capsule, const Vec3& a, const Vec3& b, const Vec3& c,
                                       double reach = kNoReach);

/// Where the triangle meets the box the distance is −(the largest, over the triangle's points, of the
/// distance to the nearest face), and the normal is that face's. Of faces equally near (a deepest point
/// inside the triangle or on its edge has two or three), it is the one through which the whole triangle has
/// the shortest way out.
TriangleSignedDistance signed_distance(const OrientedBox& box, const Vec3& a, const Vec3& b, const Vec3& c,
                                       double reach = kNoReach);

/// How far two axis-aligned boxes, given by their corners, are apart; 0 if they meet [m].
double boxes_distance(const Vec3& min_a, const Vec3& max_a, const Vec3& min_b, const Vec3& max_b);

/// The largest normal · p of all points p of the shape, which lies behind that plane [m].
double support(const Sphere& sphere, const Vec3& normal);
double support(const Capsule& capsule, const Vec3& normal);
double support(const OrientedBox& box, const Vec3& normal);

}  // namespace weft::engine
