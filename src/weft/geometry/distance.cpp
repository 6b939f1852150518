#include "weft/geometry/distance.h"

namespace weft {
namespace {

Vec3 edge_weights(int from, double t) {
  Vec3 weights = Vec3::Zero();
  weights[from] = 1 - t;
  weights[from == 2 ? 0 : from + 1] = t;
  return weights;
}

void keep_closer(const SegmentTriangleDistance& candidate, SegmentTriangleDistance& best) {
  if (candidate.distance_sq < best.distance_sq) best = candidate;
}

/// The triangle's point closest to the segment's point s.
SegmentTriangleDistance seen_from(double s, const Vec3& p, const Vec3& a, const Vec3& b, const Vec3& c) {
  const PointTriangleDistance d = point_triangle_distance(p, a, b, c);
  return {d.distance_sq, s, d.weights};
}

}  // namespace

SegmentTriangleDistance segment_triangle_distance(const Vec3& p0, const Vec3& p1, const Vec3& a,
                                                  const Vec3& b, const Vec3& c) {
  // Closest is an end of the segment, a side of the triangle ...
  SegmentTriangleDistance best = seen_from(0, p0, a, b, c);
  keep_closer(seen_from(1, p1, a, b, c), best);
  const Vec3 x[4] = {a, b, c, a};
  for (int i = 0; i < 3; ++i) {
    const EdgeEdgeDistance d = edge_edge_distance(p0, p1, x[i], x[i + 1]);
    keep_closer({d.distance_sq, d.s, edge_weights(i, d.t)}, best);
  }
  // ... or where the segment goes through the face.
  const Vec3 n = (b - a).cross(c - a);
  const double height_0 = n.dot(p0 - a), height_1 = n.dot(p1 - a);
  if ((height_0 < 0) != (height_1 < 0)) {
    const double s = detail::clamp_01(height_0 / (height_0 - height_1));
    keep_closer(seen_from(s, p0 + s * (p1 - p0), a, b, c), best);
  }
  const double size_sq = std::max({(p1 - p0).squaredNorm(), (b - a).squaredNorm(), (c - a).squaredNorm()});
  if (best.distance_sq <= kDistanceTolerance * kDistanceTolerance * size_sq) best.distance_sq = 0;
  return best;
}

}  // namespace weft
