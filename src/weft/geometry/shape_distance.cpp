#include "weft/geometry/shape_distance.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "weft/geometry/distance.h"

namespace weft::engine {
namespace {

Vec3 unit_or(const Vec3& v, const Vec3& otherwise) {
  const double length = v.norm();
  return length > 0 ? Vec3(v / length) : otherwise;
}

/// Up, made perpendicular to the axis; x for an upright axis; up for a zero axis.
Vec3 across(const Vec3& axis) {
  const double length_sq = axis.squaredNorm();
  if (length_sq == 0) return Vec3::UnitY();
  const Vec3 up = Vec3::UnitY() - axis.y() / length_sq * axis;
  return up.squaredNorm() > 1e-20 ? Vec3(up.normalized()) : Vec3::UnitX();
}

// --- Boxes, in their own frame: the box is |p_k| <= h_k. ---

/// Signed distance to the box: max_k |p_k| − h_k inside, the length of the excess over h outside.
double box_distance(const Vec3& p, const Vec3& h) {
  const Vec3 beyond = p.cwiseAbs() - h;
  const double deepest = beyond.maxCoeff();
  return deepest <= 0 ? deepest : beyond.cwiseMax(0.0).norm();
}

Vec3 box_normal(const Vec3& p, const Vec3& h) {
  const Vec3 beyond = p.cwiseAbs() - h;
  int axis;
  if (beyond.maxCoeff(&axis) <= 0) return std::copysign(1.0, p[axis]) * Vec3::Unit(axis);
  return (p - p.cwiseMax(-h).cwiseMin(h)).normalized();
}

/// A triangle in the box's frame, and the best of its points so far.
struct BoxSearch {
  Vec3 h;
  std::array<Vec3, 3> x;
  Vec3 weights = Vec3::UnitX();
  double distance = std::numeric_limits<double>::infinity();

  Vec3 point(const Vec3& w) const { return point_at(w, x[0], x[1], x[2]); }

  void consider(const Vec3& w) {
    const double d = box_distance(point(w), h);
    if (d < distance) {
      distance = d;
      weights = w;
    }
  }
};

/// The minimum of max_k (|p_k| − h_k) on p + t d, 0 <= t <= 1.
///
/// It is the larger of two functions, one rising and one falling: max_k (u_k + m_k t) and max_k (v_k − m_k
/// t), with m = |d|. Of all pairs of lines u_i, v_j the one that meets highest meets at the height where the
/// two functions do: the mean of u_i and v_j, each weighted by the other's slope. This height gives the
/// interval of t where no line is higher.
double deepest_inside(const Vec3& p, const Vec3& d, const Vec3& h) {
  const Vec3 m = d.cwiseAbs();
  Vec3 u, v;
  for (int k = 0; k < 3; ++k) {
    const double rising = d[k] < 0 ? -p[k] : p[k];
    u[k] = rising - h[k];
    v[k] = -rising - h[k];
  }
  double highest = -std::numeric_limits<double>::infinity();
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      const double slopes = m[i] + m[j];
      if (slopes > 0) highest = std::max(highest, (u[i] * m[j] + v[j] * m[i]) / slopes);
    }
  }
  // Rounding must not tilt a nearly flat line.
  highest += 1e-15 * (p.cwiseAbs() + m + h).maxCoeff();
  double first = 0, last = 1;
  for (int k = 0; k < 3; ++k) {
    if (m[k] == 0) continue;
    first = std::max(first, (v[k] - highest) / m[k]);
    last = std::min(last, (highest - u[k]) / m[k]);
  }
  return 0.5 * (detail::clamp_01(first) + detail::clamp_01(last));
}

/// The t in [0, 1] that minimises the squared distance φ = Σ_k max(|q_k| − h_k, 0)² of q = p + t d. The slope
/// of φ rises with t and is linear between the points where the line crosses the planes of the faces.
double nearest_outside(const Vec3& p, const Vec3& d, const Vec3& h) {
  const auto slope = [&](double t) {  // half of φ'
    const Vec3 q = p + t * d;
    return (q - q.cwiseMax(-h).cwiseMin(h)).dot(d);
  };
  double low = 0, high = 1, slope_low = slope(0), slope_high = slope(1);
  if (slope_low >= 0) return 0;
  if (slope_high <= 0) return 1;
  for (int k = 0; k < 3; ++k) {
    for (const double face : {-h[k], h[k]}) {
      const double t = (face - p[k]) / d[k];  // NaN or infinite for a line along the face
      if (!(t > low && t < high)) continue;
      const double slope_t = slope(t);
      (slope_t < 0 ? low : high) = t;
      (slope_t < 0 ? slope_low : slope_high) = slope_t;
    }
  }
  return low + (high - low) * (slope_low / (slope_low - slope_high));
}

Vec3 mix(const Vec3& w0, const Vec3& w1, double t) { return (1 - t) * w0 + t * w1; }

/// The minimum of max_k (|p_k| − h_k): on an edge, on the face where three faces of the box are equally far,
/// or where the triangle passes the box's middle and no point is deeper than half of the least size.
void search_inside(BoxSearch& search) {
  const auto& [h, x, weights, distance] = search;
  const auto along = [&](const Vec3& w0, const Vec3& w1) {
    const Vec3 p = search.point(w0);
    search.consider(mix(w0, w1, deepest_inside(p, search.point(w1) - p, search.h)));
  };
  for (int i = 0; i < 3; ++i) along(Vec3::Unit(i), Vec3::Unit((i + 1) % 3));

  // p_k = s_k (f + h_k) with the signs of the plane n · p = c, c >= 0: f = (c − Σ|n_k| h_k) / Σ|n_k|.
  Vec3 n = (x[1] - x[0]).cross(x[2] - x[0]);
  if (n.dot(x[0]) < 0) n = -n;
  const double sum = n.cwiseAbs().sum();
  if (!(sum > 0)) return;
  const double f = (n.dot(x[0]) - n.cwiseAbs().dot(h)) / sum;
  if (f > 0) return;
  Vec3 p;
  for (int k = 0; k < 3; ++k) p[k] = std::copysign(f + h[k], n[k]);
  search.consider(point_triangle_distance(p, x[0], x[1], x[2]).weights);

  // The cut with the middle plane p_k = 0 between the two closest faces.
  int k;
  h.minCoeff(&k);
  Vec3 ends[2];
  int num_ends = 0;
  for (int i = 0; i < 3 && num_ends < 2; ++i) {
    const int j = (i + 1) % 3;
    if ((x[i][k] < 0) == (x[j][k] < 0)) continue;
    ends[num_ends++] = mix(Vec3::Unit(i), Vec3::Unit(j), detail::clamp_01(x[i][k] / (x[i][k] - x[j][k])));
  }
  if (num_ends == 2) along(ends[0], ends[1]);
}

/// The smallest distance to the box for a triangle that does not meet it: on an edge, or on the face below
/// the box's foremost corner.
void search_outside(BoxSearch& search) {
  const auto& [h, x, weights, distance] = search;
  for (int i = 0; i < 3; ++i) {
    const int j = (i + 1) % 3;
    search.consider(mix(Vec3::Unit(i), Vec3::Unit(j), nearest_outside(x[i], x[j] - x[i], h)));
  }
  Vec3 n = (x[1] - x[0]).cross(x[2] - x[0]);
  if (n.dot(x[0]) < 0) n = -n;
  Vec3 corner;
  for (int k = 0; k < 3; ++k) corner[k] = std::copysign(h[k], n[k]);
  const PointTriangleDistance below = point_triangle_distance(corner, x[0], x[1], x[2]);
  if (below.region == TriangleRegion::face) search.consider(below.weights);
}

/// Of the faces equally near to the deepest point p, the one that all corners pass soonest.
Vec3 shortest_way_out(const BoxSearch& search, const Vec3& p) {
  const double tie = 1e-12 * search.h.maxCoeff();
  double shortest = std::numeric_limits<double>::infinity();
  Vec3 normal = box_normal(p, search.h);
  for (int k = 0; k < 3; ++k) {
    for (const double sign : {1.0, -1.0}) {
      if (sign * p[k] - search.h[k] < search.distance - tie) continue;
      const auto [low, high] = std::minmax({search.x[0][k], search.x[1][k], search.x[2][k]});
      const double way = search.h[k] - (sign > 0 ? low : -high);
      if (way < shortest) {
        shortest = way;
        normal = sign * Vec3::Unit(k);
      }
    }
  }
  return normal;
}

}  // namespace

double boxes_distance(const Vec3& min_a, const Vec3& max_a, const Vec3& min_b, const Vec3& max_b) {
  return (min_a - max_b).cwiseMax(min_b - max_a).cwiseMax(0.0).norm();
}

SignedDistance signed_distance(const Sphere& sphere, const Vec3& p) {
  const Vec3 offset = p - sphere.center;
  return {offset.norm() - sphere.radius, unit_or(offset, Vec3::UnitY())};
}

SignedDistance signed_distance(const Plane& plane, const Vec3& p) {
  return {(p - plane.point).dot(plane.normal), plane.normal};
}

SignedDistance signed_distance(const Capsule& capsule, const Vec3& p) {
  const double t = point_segment_distance(p, capsule.a, capsule.b).t;
  const Vec3 offset = p - (capsule.a + t * (capsule.b - capsule.a));
  return {offset.norm() - capsule.radius, unit_or(offset, across(capsule.b - capsule.a))};
}

SignedDistance signed_distance(const OrientedBox& box, const Vec3& p) {
  const Vec3 local = box.rotation.transpose() * (p - box.center);
  return {box_distance(local, box.half_size), box.rotation * box_normal(local, box.half_size)};
}

TriangleSignedDistance signed_distance(const Sphere& sphere, const Vec3& a, const Vec3& b, const Vec3& c,
                                       double reach) {
  // Along any direction, no point of the triangle is nearer to the centre than the lowest corner.
  constexpr double kRounding = 1e-12;
  const Vec3 x = a - sphere.center, y = b - sphere.center, z = c - sphere.center, sum = x + y + z;
  const double lowest = std::min({sum.dot(x), sum.dot(y), sum.dot(z)}),
               farthest = (1 + kRounding) * (sphere.radius + reach) * sum.norm();
  if (farthest >= 0 && lowest > farthest)
    return {lowest / sum.norm() - sphere.radius, Vec3::UnitX(), Vec3::UnitY()};

  const PointTriangleDistance d = point_triangle_distance(sphere.center, a, b, c);
  const Vec3 offset = point_at(d.weights, x, y, z);
  const double length = offset.norm();
  const Vec3 normal = length > 0 ? Vec3(offset / length) : unit_or((b - a).cross(c - a), Vec3::UnitY());
  return {d.distance() - sphere.radius, d.weights, normal};
}

TriangleSignedDistance signed_distance(const Plane& plane, const Vec3& a, const Vec3& b, const Vec3& c,
                                       double /*reach*/) {
  const Vec3 heights((a - plane.point).dot(plane.normal), (b - plane.point).dot(plane.normal),
                     (c - plane.point).dot(plane.normal));
  int lowest;
  const double height = heights.minCoeff(&lowest);
  return {height, Vec3::Unit(lowest), plane.normal};
}

TriangleSignedDistance signed_distance(const Capsule& capsule, const Vec3& a, const Vec3& b, const Vec3& c,
                                       double reach) {
  const double apart = boxes_distance(a.cwiseMin(b).cwiseMin(c), a.cwiseMax(b).cwiseMax(c),
                                      capsule.a.cwiseMin(capsule.b), capsule.a.cwiseMax(capsule.b)) -
                       capsule.radius;
  if (apart > reach) return {apart, Vec3::UnitX(), Vec3::UnitY()};

  const Vec3 axis = capsule.b - capsule.a;
  const SegmentTriangleDistance d = segment_triangle_distance(capsule.a, capsule.b, a, b, c);
  const double distance = d.distance() - capsule.radius;
  if (d.distance_sq > 0) {
    const Vec3 q = capsule.a + d.s * axis;
    return {distance, d.weights, unit_or(point_at(d.weights, a - q, b - q, c - q), across(axis))};
  }
  const Vec3 own = unit_or((b - a).cross(c - a), across(axis));
  const bool towards_b = d.s >= 0.5;
  return {distance, d.weights, (own.dot(axis) >= 0) == towards_b ? own : Vec3(-own)};
}

TriangleSignedDistance signed_distance(const OrientedBox& box, const Vec3& a, const Vec3& b, const Vec3& c,
                                       double reach) {
  const Mat3 to_box = box.rotation.transpose();
  BoxSearch search{box.half_size,
                   {to_box * (a - box.center), to_box * (b - box.center), to_box * (c - box.center)}};
  const auto& x = search.x;
  const Vec3& h = search.h;
  // Along any axis, no point of the triangle is nearer to the middle than its bounds.
  const Vec3 low = x[0].cwiseMin(x[1]).cwiseMin(x[2]), high = x[0].cwiseMax(x[1]).cwiseMax(x[2]);
  const double least = box_distance(low.cwiseMax(-high).cwiseMax(0.0), h);
  if (least > reach) return {least, Vec3::UnitX(), Vec3::UnitY()};

  for (int i = 0; i < 3; ++i) search.consider(Vec3::Unit(i));
  if (search.distance > least && least <= 0) search_inside(search);
  if (search.distance > least && search.distance > 0) search_outside(search);
  const Vec3 p = search.point(search.weights);
  const Vec3 normal = search.distance > 0 ? box_normal(p, h) : shortest_way_out(search, p);
  return {search.distance, search.weights, box.rotation * normal};
}

double support(const Sphere& sphere, const Vec3& normal) {
  return normal.dot(sphere.center) + sphere.radius * normal.norm();
}

double support(const Capsule& capsule, const Vec3& normal) {
  return std::max(normal.dot(capsule.a), normal.dot(capsule.b)) + capsule.radius * normal.norm();
}

double support(const OrientedBox& box, const Vec3& normal) {
  return normal.dot(box.center) + box.half_size.dot((box.rotation.transpose() * normal).cwiseAbs());
}

}  // namespace weft::engine
