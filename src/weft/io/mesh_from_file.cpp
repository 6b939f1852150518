#include "weft/io/mesh_from_file.h"

#include <algorithm>
#include <limits>
#include <numeric>

namespace weft::engine {
namespace {

/// Corners of a polygon that remain, as numbers of their positions.
using Corners = std::vector<int>;
using Positions = std::vector<Vec3>;

/// Newell's normal: perpendicular to the best-fitting plane, with length twice the area.
Vec3 polygon_normal(const Positions& x) {
  Vec3 normal = Vec3::Zero();
  for (size_t k = 1; k + 1 < x.size(); ++k) normal += (x[k] - x[0]).cross(x[k + 1] - x[0]);
  return normal;
}

Triangle corner(const Corners& polygon, size_t tip) {
  const size_t n = polygon.size();
  return {polygon[(tip + n - 1) % n], polygon[tip], polygon[(tip + 1) % n]};
}

/// An ear is a convex corner whose triangle contains none of the other vertices; only an ear can be clipped.
bool is_ear(const Corners& polygon, const Positions& x, const Vec3& normal, size_t tip) {
  const auto [a, b, c] = corner(polygon, tip);
  const double tolerance = 1e-12 * normal.squaredNorm();  // round-off: a vertex on the cut counts as inside
  const auto side = [&](int from, int to, int v) {
    return normal.dot((x[to] - x[from]).cross(x[v] - x[from]));
  };
  if (!(side(a, b, c) > tolerance)) return false;
  for (const int v : polygon) {
    if (x[v] == x[a] || x[v] == x[b] || x[v] == x[c]) continue;
    if (std::min({side(a, b, v), side(b, c, v), side(c, a, v)}) >= -tolerance) return false;
  }
  return true;
}

/// The ear with the shortest cut; the second corner of a polygon without ears (self-intersecting, no area).
size_t find_best_ear(const Corners& polygon, const Positions& x, const Vec3& normal) {
  size_t best = 1;
  double shortest_sq = std::numeric_limits<double>::infinity();
  for (size_t tip = 0; tip < polygon.size(); ++tip) {
    const Triangle ear = corner(polygon, tip);
    const double cut_sq = (x[ear[0]] - x[ear[2]]).squaredNorm();
    if (cut_sq < shortest_sq && is_ear(polygon, x, normal, tip)) {
      best = tip;
      shortest_sq = cut_sq;
    }
  }
  return best;
}

/// The n - 2 triangles of a polygon with n corners at `x`, as numbers of the corners.
std::vector<Triangle> triangulate(const Positions& x) {
  std::vector<Triangle> triangles;
  const Vec3 normal = polygon_normal(x);
  Corners polygon(x.size());
  std::iota(polygon.begin(), polygon.end(), 0);
  while (polygon.size() > 3) {
    const size_t tip = find_best_ear(polygon, x, normal);
    triangles.push_back(corner(polygon, tip));
    polygon.erase(polygon.begin() + static_cast<std::ptrdiff_t>(tip));
  }
  triangles.push_back({polygon[0], polygon[1], polygon[2]});
  return triangles;
}

}  // namespace

void MeshFaces::add(std::span<const int> polygon, std::span<const Eigen::Vector2d> corner_uv) {
  corners.insert(corners.end(), polygon.begin(), polygon.end());
  uv.insert(uv.end(), corner_uv.begin(), corner_uv.end());
  ends.push_back(corners.size());
}

MeshFaces make_faces(const std::vector<Triangle>& triangles, const std::vector<CornerUv>& uv) {
  MeshFaces faces;
  for (std::size_t t = 0; t < triangles.size(); ++t)
    faces.add(triangles[t], uv.empty() ? std::span<const Eigen::Vector2d>() : std::span(uv[t]));
  return faces;
}

void append_polygon(std::span<const int> polygon, std::span<const Eigen::Vector2d> uv, MeshFromFile& result) {
  result.faces.add(polygon, uv);
  Positions x;
  for (const int v : polygon) x.push_back(result.mesh.positions[v]);
  for (const auto [a, b, c] : triangulate(x)) {
    result.mesh.triangles.push_back({polygon[a], polygon[b], polygon[c]});
    if (!uv.empty()) result.uv.push_back({uv[a], uv[b], uv[c]});
  }
}

}  // namespace weft::engine
