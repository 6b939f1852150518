#include "weft/geometry/distance.h"

namespace weft::engine {
namespace {

Vec3 edge_weights(int from, double t) {
  Vec3 weights = Vec3::Zero();
  weights[from] = 1 - t;
  weights[from == 2 ? 0 : from + 1] = t;
  return weights;
}

}  // namespace

SegmentTriangleDistance segment_triangle_distance(const Vec3& p0, const Vec3& p1, const Vec3& a,
                                                  const Vec3& b, const Vec3& c) {
  // Relative to a, to keep all digits far from the origin.
  const Vec3 x[4] = {Vec3::Zero(), b - a, c - a, Vec3::Zero()};
  const Vec3 start = p0 - a, end = p1 - a, along = p1 - p0;
  SegmentTriangleDistance best{std::numeric_limits<double>::infinity(), 0, Vec3::UnitX()};
  const auto consider = [&](const SegmentTriangleDistance& candidate) {
    if (candidate.distance_sq < best.distance_sq) best = candidate;
  };
  const auto consider_point = [&](double s, const Vec3& p) {
    const PointTriangleDistance d = point_triangle_distance(p, x[0], x[1], x[2]);
    consider({d.distance_sq, s, d.weights});
  };

  // The closest point is an end of the segment, a side of the triangle ...
  consider_point(0, start);
  consider_point(1, end);
  for (int i = 0; i < 3; ++i) {
    const EdgeEdgeDistance d = edge_edge_distance(start, end, x[i], x[i + 1]);
    consider({d.distance_sq, d.s, edge_weights(i, d.t)});
  }
  // ... or the intersection of the segment with the face. For a needle triangle only the component of the
  // normal across its longest side is accurate; the segment's point is refined from the triangle's point.
  const Vec3 sides[3] = {x[1], x[2] - x[1], x[2]};
  const Vec3* longest = std::max_element(
      sides, sides + 3, [](const Vec3& u, const Vec3& v) { return u.squaredNorm() < v.squaredNorm(); });
  Vec3 n = x[1].cross(x[2]);
  n -= n.dot(*longest) * detail::inverse_or_zero(longest->squaredNorm()) * *longest;
  const double height_0 = n.dot(start), height_1 = n.dot(end);
  if ((height_0 < 0) != (height_1 < 0)) {
    const double s = detail::clamp_01(height_0 / (height_0 - height_1));
    consider_point(s, start + s * along);
    const double back = point_segment_distance(point_at(best.weights, x[0], x[1], x[2]), start, end).t;
    consider_point(back, start + back * along);
  }
  const double size_sq =
      std::max({start.squaredNorm(), end.squaredNorm(), x[1].squaredNorm(), x[2].squaredNorm()});
  const double touching = 0.25 * kDistanceTolerance;
  if (best.distance_sq <= touching * touching * size_sq) best.distance_sq = 0;
  return best;
}

}  // namespace weft::engine
