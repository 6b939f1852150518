#pragma once
/// Distances between the features of triangle meshes: the closest points, and their positions on each
/// feature.
///
///               p                            a1
///               |\                            \        b1
///               | d n                      1−s \ s    /
///            x1 |                               o----o            weights: 1−s, s of a0, a1
///            /\ v  w1                          / d n / 1−t                 1−t, t of b0, b1
///           /  q  \                          a0     /
///         x0 ------ x2                            b0
///       w0            w2
///
/// A closest point is Σ w_i x_i of its feature's corners, all w_i in [0, 1] and Σ w_i = 1. Let the weights of
/// one feature count positive and those of the other negative, and n be the unit vector from the second
/// feature's closest point to the first's. Then, as long as d > 0,
///
///     d = n · Σ w_i x_i,     ∂d/∂x_i = w_i n     (changes of the weights have no effect to first order)
///
///     point–triangle:  d = |p − q|,      w = (1; −w0, −w1, −w2)
///     edge–edge:       d = |q_a − q_b|,  w = (1−s, s; −(1−t), −t)
///
/// Valid for finite coordinates of any size from 1e-60 to 1e60, and for features of any shape: zero-length
/// edges, zero-area triangles, parallel edges. The result is always a pair of points on the two features,
/// with their squared distance. Their distance is the smallest to within kDistanceTolerance times the largest
/// distance between any two of the corners. Where several pairs are closest, it is one of them.

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>

#include "weft/core/vec.h"

namespace weft::engine {

inline constexpr double kDistanceTolerance = 1e-14;  // about forty roundings of a double [1]

/// Position on an edge: at its first end, at its second, or between.
enum class EdgeRegion : std::uint8_t { start, end, interior };

/// Position on a triangle: the Voronoi region that contains the other point.
enum class TriangleRegion : std::uint8_t { vertex_0, vertex_1, vertex_2, edge_01, edge_12, edge_20, face };

struct PointSegmentDistance {
  double distance_sq;  // [m²]
  double t;            // the closest point is (1 − t) a + t b [1]
  EdgeRegion region;

  double distance() const { return std::sqrt(distance_sq); }
};

struct PointTriangleDistance {
  double distance_sq;  // [m²]
  Vec3 weights;        // of the triangle's corners [1]
  TriangleRegion region;

  double distance() const { return std::sqrt(distance_sq); }
};

struct EdgeEdgeDistance {
  double distance_sq;  // [m²]
  double s;            // (1 − s) a0 + s a1 [1]
  double t;            // (1 − t) b0 + t b1 [1]
  EdgeRegion region_a;
  EdgeRegion region_b;

  double distance() const { return std::sqrt(distance_sq); }
};

struct SegmentTriangleDistance {
  double distance_sq;  // exactly 0 where they intersect [m²]
  double s;            // (1 − s) p0 + s p1 [1]
  Vec3 weights;        // of the triangle's corners [1]

  double distance() const { return std::sqrt(distance_sq); }
};

/// The point of a triangle with these weights.
inline Vec3 point_at(const Vec3& weights, const Vec3& a, const Vec3& b, const Vec3& c) {
  return weights[0] * a + weights[1] * b + weights[2] * c;
}

/// Distance between the segment p0–p1 and the triangle abc.
SegmentTriangleDistance segment_triangle_distance(const Vec3& p0, const Vec3& p1, const Vec3& a,
                                                  const Vec3& b, const Vec3& c);

namespace detail {

inline double clamp_01(double x) { return std::min(std::max(x, 0.0), 1.0); }

/// 1/x, or 0 if x is the square of a zero length.
inline double inverse_or_zero(double x) { return x < std::numeric_limits<double>::min() ? 0.0 : 1 / x; }

inline EdgeRegion edge_region(double t) {
  return t <= 0 ? EdgeRegion::start : t >= 1 ? EdgeRegion::end : EdgeRegion::interior;
}

/// Closest point of an edge e, from the point's offset to the edge's start.
inline PointSegmentDistance offset_edge_distance(const Vec3& offset, const Vec3& e, double length_sq) {
  const double t = clamp_01(offset.dot(e) * inverse_or_zero(length_sq));
  return {(offset - t * e).squaredNorm(), t, edge_region(t)};
}

/// The nearest point of the three edges, for p whose projection is not on the triangle.
inline PointTriangleDistance point_triangle_edges(const Vec3 (&to_p)[3], const Vec3 (&e)[3],
                                                  const Vec3& length_sq) {
  const PointSegmentDistance on[3] = {offset_edge_distance(to_p[0], e[0], length_sq[0]),
                                      offset_edge_distance(to_p[1], e[1], length_sq[1]),
                                      offset_edge_distance(to_p[2], e[2], length_sq[2])};
  int i = on[1].distance_sq < on[0].distance_sq ? 1 : 0;
  i = on[2].distance_sq < on[i].distance_sq ? 2 : i;
  const int j = i == 2 ? 0 : i + 1;
  PointTriangleDistance result{on[i].distance_sq, Vec3::Zero(), {}};
  result.weights[i] = 1 - on[i].t;
  result.weights[j] = on[i].t;
  result.region = static_cast<TriangleRegion>(on[i].region == EdgeRegion::start ? i
                                              : on[i].region == EdgeRegion::end ? j
                                                                                : 3 + i);
  return result;
}

}  // namespace detail

/// Distance between the point p and the segment a–b.
inline PointSegmentDistance point_segment_distance(const Vec3& p, const Vec3& a, const Vec3& b) {
  const Vec3 e = b - a;
  return detail::offset_edge_distance(p - a, e, e.squaredNorm());
}

/// Distance between the point p and the triangle abc.
///
/// The weights are the areas that p's projection spans with the edges. If all are positive, it is on the
/// face; otherwise the closest point is on an edge. On a needle triangle the areas determine the position
/// across it well, but not along it, so a projection onto the longest edge follows. If that ends at a side,
/// and on the thinnest triangles, an edge may still be closer.
inline PointTriangleDistance point_triangle_distance(const Vec3& p, const Vec3& a, const Vec3& b,
                                                     const Vec3& c) {
  constexpr double kThinSq = 1e-12;  // height over length: below, the areas may be rounding only
  const Vec3 e[3] = {b - a, c - b, a - c};
  const Vec3 to_p[3] = {p - a, p - b, p - c};
  const Vec3 length_sq(e[0].squaredNorm(), e[1].squaredNorm(), e[2].squaredNorm());
  const Vec3 n = e[2].cross(e[0]);
  Vec3 w(e[1].cross(to_p[1]).dot(n), e[2].cross(to_p[2]).dot(n), e[0].cross(to_p[0]).dot(n));
  if (!(w.minCoeff() > 0)) return detail::point_triangle_edges(to_p, e, length_sq);

  w /= w.sum();
  int i = length_sq[1] > length_sq[0] ? 1 : 0;
  i = length_sq[2] > length_sq[i] ? 2 : i;
  const int j = i == 2 ? 0 : i + 1;
  const int k = 3 - i - j;
  // p − q = (p − x_i) − w_j (x_j − x_i) − w_k (x_k − x_i), then q moves along x_j − x_i, within the sides.
  const Vec3 rest = to_p[i] - w[j] * e[i] + w[k] * e[k];
  const double move = rest.dot(e[i]) / length_sq[i];
  const bool stays_inside = move >= -w[j] && move <= w[i];
  const double moved = std::min(std::max(move, -w[j]), w[i]);
  w[i] = std::min(w[i] - moved, 1.0);
  w[j] = std::min(w[j] + moved, 1.0);
  const PointTriangleDistance face{(rest - moved * e[i]).squaredNorm(), w, TriangleRegion::face};
  if (stays_inside && n.squaredNorm() > kThinSq * length_sq[i] * length_sq[i]) return face;
  const PointTriangleDistance edge = detail::point_triangle_edges(to_p, e, length_sq);
  return edge.distance_sq < face.distance_sq ? edge : face;
}

/// Distance between the edges a0–a1 and b0–b1. For parallel edges that overlap, the points are the middle of
/// the overlap.
///
/// s is the closest point of the lines; projecting there and back gives t and s on the edges themselves. For
/// almost parallel edges s is uncertain, but then the distance hardly depends on it.
inline EdgeEdgeDistance edge_edge_distance(const Vec3& a0, const Vec3& a1, const Vec3& b0, const Vec3& b1) {
  constexpr double kParallelSq = 4e-30;  // sin² of the angle: below, only rounding is left
  const Vec3 u = a1 - a0, v = b1 - b0, r = b0 - a0;
  const double uu = u.squaredNorm(), vv = v.squaredNorm();
  const double inv_uu = detail::inverse_or_zero(uu), inv_vv = detail::inverse_or_zero(vv);
  const Vec3 n = u.cross(v);
  const double nn = n.squaredNorm();
  double s;
  if (nn > kParallelSq * uu * vv) {
    s = detail::clamp_01(r.cross(v).dot(n) / nn);
  } else {
    s = 0.5 * (detail::clamp_01(r.dot(u) * inv_uu) + detail::clamp_01((b1 - a0).dot(u) * inv_uu));
  }
  const double t = detail::clamp_01((s * u - r).dot(v) * inv_vv);
  s = detail::clamp_01((r + t * v).dot(u) * inv_uu);
  return {(r + t * v - s * u).squaredNorm(), s, t, detail::edge_region(s), detail::edge_region(t)};
}

}  // namespace weft::engine
