#include "weft/world/surface_anchor.h"

#include <limits>

#include "weft/geometry/distance.h"

namespace weft::engine {
namespace {

Pose pose_of(const PlacedCollider& body) { return body.collider->motion.at(body.time); }

/// Columns: direction of the first edge, across it, normal.
Mat3 frame_of(const Vec3& a, const Vec3& b, const Vec3& c) {
  Mat3 frame;
  frame.col(0) = (b - a).normalized();
  frame.col(2) = (b - a).cross(c - a).normalized();
  frame.col(1) = frame.col(2).cross(frame.col(0));
  return frame;
}

}  // namespace

PlacedCollider place(const Collider& collider, double time) {
  return {&collider, time, shape_at(collider, time)};
}

SurfaceAnchor bind_point(const PlacedCollider& body, const Vec3& p) {
  const MeshShape* mesh = std::get_if<MeshShape>(&body.shape);
  if (!mesh) return {.offset = apply_inverse(pose_of(body), pivot(body.collider->shape), p)};
  SurfaceAnchor anchor;
  double nearest = std::numeric_limits<double>::infinity();
  for (int t = 0; t < mesh->mesh->num_triangles(); ++t) {
    const auto [i, j, k] = mesh->mesh->triangles[t];
    const Vec3 a = mesh->vertex(i), b = mesh->vertex(j), c = mesh->vertex(k);
    if ((b - a).cross(c - a).isZero(0)) continue;
    const PointTriangleDistance d = point_triangle_distance(p, a, b, c);
    if (d.distance_sq >= nearest) continue;
    nearest = d.distance_sq;
    const Vec3 foot = d.weights[0] * a + d.weights[1] * b + d.weights[2] * c;
    anchor = {t, d.weights, frame_of(a, b, c).transpose() * (p - foot)};
  }
  return anchor;
}

Vec3 position_of(const SurfaceAnchor& anchor, const PlacedCollider& body) {
  const MeshShape* mesh = std::get_if<MeshShape>(&body.shape);
  if (!mesh) return apply(pose_of(body), pivot(body.collider->shape), anchor.offset);
  const auto [i, j, k] = mesh->mesh->triangles[anchor.triangle];
  const Vec3 a = mesh->vertex(i), b = mesh->vertex(j), c = mesh->vertex(k);
  const Vec3& w = anchor.weights;
  return w[0] * a + w[1] * b + w[2] * c + frame_of(a, b, c) * anchor.offset;
}

}  // namespace weft::engine
