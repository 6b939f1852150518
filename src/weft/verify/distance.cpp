#include "weft/verify/distance.h"

#include <algorithm>

#include "weft/verify/predicates.h"

namespace weft::engine::verify {
namespace {

Segment side(const Corners& triangle, int k) { return {triangle[k], triangle[(k + 1) % 3]}; }

/// Whether the projection of p on the triangle's plane is inside the triangle.
bool is_above_inside(const Vec3& p, const Corners& triangle, const Vec3& normal) {
  for (int k = 0; k < 3; ++k) {
    const auto [from, to] = side(triangle, k);
    if ((to - from).cross(p - from).dot(normal) < 0) return false;
  }
  return true;
}

/// Whether the segment's ends are strictly on different sides, and its line meets the closed triangle.
bool pierces(const Segment& segment, const Corners& triangle) {
  const auto& [a, b, c] = triangle;
  const auto& [p, q] = segment;
  if (orient3d(a, b, c, p) * orient3d(a, b, c, q) >= 0) return false;
  const int s[] = {orient3d(p, q, a, b), orient3d(p, q, b, c), orient3d(p, q, c, a)};
  return *std::min_element(s, s + 3) >= 0 || *std::max_element(s, s + 3) <= 0;
}

}  // namespace

double distance_sq(const Vec3& p, const Segment& segment) {
  const Vec3 along = segment.to - segment.from;
  const double length_sq = along.squaredNorm();
  const double s = length_sq > 0 ? std::clamp((p - segment.from).dot(along) / length_sq, 0.0, 1.0) : 0.0;
  return (segment.from + s * along - p).squaredNorm();
}

double distance_sq(const Segment& a, const Segment& b) {
  double least =
      std::min({distance_sq(a.from, b), distance_sq(a.to, b), distance_sq(b.from, a), distance_sq(b.to, a)});
  const Vec3 u = a.to - a.from, v = b.to - b.from, w = b.from - a.from, n = u.cross(v);
  const double n_sq = n.squaredNorm();
  if (!(n_sq > 0)) return least;
  const double s = w.cross(v).dot(n) / n_sq, t = w.cross(u).dot(n) / n_sq;
  if (s <= 0 || s >= 1 || t <= 0 || t >= 1) return least;
  return std::min(least, (a.from + s * u - b.from - t * v).squaredNorm());
}

double distance_sq(const Vec3& p, const Corners& triangle) {
  const Vec3 normal = (triangle[1] - triangle[0]).cross(triangle[2] - triangle[0]);
  const double normal_sq = normal.squaredNorm();
  if (normal_sq > 0 && is_above_inside(p, triangle, normal)) {
    const double height = (p - triangle[0]).dot(normal);
    return height * height / normal_sq;
  }
  return std::min({distance_sq(p, side(triangle, 0)), distance_sq(p, side(triangle, 1)),
                   distance_sq(p, side(triangle, 2))});
}

double distance_sq(const Segment& segment, const Corners& triangle) {
  if (pierces(segment, triangle)) return 0;
  double least = std::min(distance_sq(segment.from, triangle), distance_sq(segment.to, triangle));
  for (int k = 0; k < 3; ++k) least = std::min(least, distance_sq(segment, side(triangle, k)));
  return least;
}

}  // namespace weft::engine::verify
