#include "weft/contact/between.h"

#include "weft/geometry/distance.h"

namespace weft::engine {
namespace {

/// A point on a triangle.
struct SurfacePoint {
  int triangle;
  Vec3 weights, point;
  double distance_sq;  // from where it is sought [m²]
};

/// From the plane of a box's face.
SignedDistance distance_from_face(const OrientedBox& box, int face, const Vec3& p) {
  const int axis = face / 2;
  const Vec3 normal = (face % 2 == 0 ? 1.0 : -1.0) * box.rotation.col(axis);
  return {normal.dot(p - box.center) - box.half_size[axis], normal};
}

SignedDistance distance_from_shape(const ColliderShape& shape, int face, const Vec3& p) {
  if (const OrientedBox* box = std::get_if<OrientedBox>(&shape)) return distance_from_face(*box, face, p);
  return signed_distance(shape, p);
}

/// The point of a triangle of a collider that is nearest to p, among the vertex positions x.
SurfacePoint point_on(const StepBodies& bodies, int triangle, const Vec3& p, const std::vector<Vec3>& x) {
  const auto [i, j, k] = bodies.surface->triangles[triangle];
  const PointTriangleDistance d = point_triangle_distance(p, x[i], x[j], x[k]);
  return {triangle, d.weights, point_at(d.weights, x[i], x[j], x[k]), d.distance_sq};
}

/// The same on the surface around a triangle: from neighbour to neighbour, as long as the next is nearer. So a
/// side keeps to its own part of the surface, although others come nearer.
SurfacePoint walk(const StepBodies& bodies, HoldingSide& side, const Vec3& p, const std::vector<Vec3>& x) {
  const int first = bodies.numbering.body_with(side.collider).first_triangle;
  SurfacePoint best = point_on(bodies, first + side.face, p, x);
  for (bool is_nearer = true; is_nearer;) {
    is_nearer = false;
    for (const int v : bodies.surface->triangles[best.triangle]) {
      for (const int t : bodies.surface->triangles_at(v)) {
        const SurfacePoint next = point_on(bodies, t, p, x);
        if (!(next.distance_sq < best.distance_sq)) continue;
        best = next;
        is_nearer = true;
      }
    }
  }
  side.face = best.triangle - first;
  return best;
}

/// The signed distance from a point of the side's surface to p.
SignedDistance signed_distance_to(const StepBodies& bodies, const SurfacePoint& foot, const HoldingSide& side,
                                  const Vec3& p, const std::vector<Vec3>& x) {
  const auto [i, j, k] = bodies.surface->triangles[foot.triangle];
  Vec3 normal = (x[j] - x[i]).cross(x[k] - x[i]).stableNormalized();
  if (side.is_back) normal = -normal;
  const Vec3 between = p - foot.point;
  const double distance = between.norm(), sign = between.dot(normal) < 0 ? -1 : 1;
  constexpr double kOnIt = 1e-9;  // [m]
  return {sign * distance, distance > kOnIt ? Vec3(sign / distance * between) : normal};
}

/// From the surface at the start of the step to p; also the motion in the step of the point nearest to p [m].
SignedDistance distance_at_start(const StepBodies& bodies, HoldingSide& side, const Vec3& p, Vec3& way) {
  const MovingShape& shape = bodies.shapes[side.collider];
  if (!shape.is_mesh()) {
    const SignedDistance d = distance_from_shape(shape.before, side.face, p);
    const Vec3 foot = p - d.distance * d.normal;
    way = shape.at_end(foot) - foot;
    return d;
  }
  const SurfacePoint foot = walk(bodies, side, p, bodies.motion.start);
  const auto [i, j, k] = bodies.surface->triangles[foot.triangle];
  way = point_at(foot.weights, bodies.motion.end[i], bodies.motion.end[j], bodies.motion.end[k]) - foot.point;
  return signed_distance_to(bodies, foot, side, p, bodies.motion.start);
}

/// From the surface at the end of the step to p.
SignedDistance distance_at_end(const StepBodies& bodies, HoldingSide& side, const Vec3& p) {
  const MovingShape& shape = bodies.shapes[side.collider];
  if (!shape.is_mesh()) return distance_from_shape(shape.after, side.face, p);
  return signed_distance_to(bodies, walk(bodies, side, p, bodies.motion.end), side, p, bodies.motion.end);
}

}  // namespace

Between look_between(const StepBodies& bodies, std::array<HoldingSide, 2>& sides, const Vec3& start) {
  Between b{.start = start};
  for (int s = 0; s < 2; ++s) b.before[s] = distance_at_start(bodies, sides[s], start, b.ways[s]);
  b.end = start + 0.5 * (b.ways[0] + b.ways[1]);
  for (int s = 0; s < 2; ++s) b.after[s] = distance_at_end(bodies, sides[s], b.end);
  return b;
}

double cosine_at_start(const StepBodies& bodies, const Between& b, const std::array<HoldingSide, 2>& sides) {
  std::array<Vec3, 2> normals;
  for (int s = 0; s < 2; ++s) {
    const ColliderShape& shape = bodies.shapes[sides[s].collider].before;
    normals[s] = std::holds_alternative<OrientedBox>(shape) ? signed_distance(shape, b.start).normal
                                                            : b.before[s].normal;
  }
  return normals[0].dot(normals[1]);
}

bool is_beside(const StepBodies& bodies, const HoldingSide& side, const Vec3& p, double room) {
  const OrientedBox* box = std::get_if<OrientedBox>(&bodies.shapes[side.collider].after);
  return box && distance_from_face(*box, side.face, p).distance < room &&
         signed_distance(*box, p).distance > room;
}

int face_along(const OrientedBox& box, const Vec3& direction, const Vec3& p, double depth) {
  int best = -1;
  double most = 0;
  for (int face = 0; face < 6; ++face) {
    const SignedDistance d = distance_from_face(box, face, p);
    if (d.distance < -depth || (best >= 0 && d.normal.dot(direction) <= most)) continue;
    best = face;
    most = d.normal.dot(direction);
  }
  return best;
}

}  // namespace weft::engine
