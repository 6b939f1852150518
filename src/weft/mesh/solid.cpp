#include "weft/mesh/solid.h"

#include <algorithm>
#include <numeric>
#include <utility>

namespace weft {
namespace {

/// Seen from above, whether p lies to the left of the line from vertex a to vertex b. Of an edge's two
/// triangles one asks for a–b and the other for b–a: they get opposite answers. A point on the line is moved
/// by (ε, ε²) along x and z, so that one right below a vertex or an edge still belongs to one triangle.
bool is_left_of(const TriangleMesh& mesh, int a, int b, const Vec3& p) {
  if (a > b) return !is_left_of(mesh, b, a, p);
  const Vec3 along = mesh.positions[b] - mesh.positions[a], to_p = p - mesh.positions[a];
  const double cross = along.z() * to_p.x() - along.x() * to_p.z();
  if (cross != 0) return cross > 0;
  return along.z() != 0 ? along.z() > 0 : along.x() < 0;
}

/// 1 if the ray from p upwards leaves through the triangle's front, -1 if it enters through it, 0 if it
/// misses.
int cross_upwards(const TriangleMesh& mesh, const Triangle& tri, const Vec3& p) {
  const auto& [a, b, c] = tri;
  const bool left = is_left_of(mesh, a, b, p);
  if (is_left_of(mesh, b, c, p) != left || is_left_of(mesh, c, a, p) != left) return 0;
  const auto& x = mesh.positions;
  const Vec3 normal = (x[b] - x[a]).cross(x[c] - x[a]);
  const double above = normal.dot(x[a] - p);  // (height of the triangle over p) · normal.y
  if (normal.y() > 0) return above > 0 ? 1 : 0;
  if (normal.y() < 0) return above < 0 ? -1 : 0;
  return 0;
}

}  // namespace

SurfaceEdges count_surface_edges(const TriangleMesh& mesh) {
  // Edges by the way that triangles run along them.
  std::vector<std::pair<int, int>> directed;
  directed.reserve(3 * mesh.triangles.size());
  for (const Triangle& tri : mesh.triangles) {
    for (int k = 0; k < 3; ++k) directed.emplace_back(tri[k], tri[(k + 1) % 3]);
  }
  std::sort(directed.begin(), directed.end());
  const auto count = [&](int a, int b) {
    const auto [first, last] = std::equal_range(directed.begin(), directed.end(), std::pair(a, b));
    return static_cast<int>(last - first);
  };
  SurfaceEdges edges;
  for (const Edge& edge : build_edges(mesh)) {
    const bool is_balanced = 2 * count(edge.a, edge.b) == edge.num_triangles;
    if (edge.num_triangles == 1) ++edges.border;
    if (edge.num_triangles == 2 && !is_balanced) ++edges.twisted;
    if (edge.num_triangles > 2) ++edges.non_manifold;
    if (!is_balanced) ++edges.unbalanced;
  }
  return edges;
}

double compute_signed_volume(const TriangleMesh& mesh) {
  if (mesh.positions.empty()) return 0;
  const Vec3 near = mesh.positions[0];  // exact for any; a near one keeps the terms small
  double volume = 0;
  for (const auto& [a, b, c] : mesh.triangles) {
    const auto& x = mesh.positions;
    volume += (x[a] - near).dot((x[b] - near).cross(x[c] - near)) / 6;
  }
  return volume;
}

void turn_inside_out(TriangleMesh& mesh) {
  for (Triangle& tri : mesh.triangles) std::swap(tri[1], tri[2]);
}

std::vector<int> compute_winding_numbers(const TriangleMesh& mesh, const std::vector<Vec3>& points) {
  // Points in order of x: of each triangle only those in its range of x are asked.
  std::vector<int> order(points.size());
  std::iota(order.begin(), order.end(), 0);
  std::sort(order.begin(), order.end(), [&](int l, int r) {
    return points[l].x() != points[r].x() ? points[l].x() < points[r].x() : l < r;
  });
  std::vector<int> winding(points.size(), 0);
  for (const Triangle& tri : mesh.triangles) {
    const auto& [a, b, c] = tri;
    const auto& x = mesh.positions;
    const Vec3 low = x[a].cwiseMin(x[b]).cwiseMin(x[c]), high = x[a].cwiseMax(x[b]).cwiseMax(x[c]);
    auto p = std::lower_bound(order.begin(), order.end(), low.x(),
                              [&](int i, double limit) { return points[i].x() < limit; });
    for (; p != order.end() && points[*p].x() <= high.x(); ++p) {
      const Vec3& q = points[*p];
      if (q.z() >= low.z() && q.z() <= high.z() && q.y() <= high.y())
        winding[*p] += cross_upwards(mesh, tri, q);
    }
  }
  return winding;
}

}  // namespace weft
