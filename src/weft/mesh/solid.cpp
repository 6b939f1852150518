#include "weft/mesh/solid.h"

#include <algorithm>
#include <numeric>
#include <utility>

namespace weft::engine {
namespace {

/// Seen from above, whether p is to the left of the line from vertex a to vertex b. Of an edge's two
/// triangles one tests a–b and the other b–a: the answers are opposite. A point on the line is displaced by
/// (ε, ε²) along x and z, so that one right below a vertex or an edge still belongs to one triangle.
bool is_left_of(const std::vector<Vec3>& x, int a, int b, const Vec3& p) {
  if (a > b) return !is_left_of(x, b, a, p);
  const Vec3 along = x[b] - x[a], to_p = p - x[a];
  const double cross = along.z() * to_p.x() - along.x() * to_p.z();
  if (cross != 0) return cross > 0;
  return along.z() != 0 ? along.z() > 0 : along.x() < 0;
}

/// 1 if the ray from p upwards leaves through the triangle's front, -1 if it enters through it, 0 for a miss.
int cross_upwards(const std::vector<Vec3>& x, const Triangle& tri, const Vec3& p) {
  const auto& [a, b, c] = tri;
  const Vec3 low = x[a].cwiseMin(x[b]).cwiseMin(x[c]), high = x[a].cwiseMax(x[b]).cwiseMax(x[c]);
  if (p.x() < low.x() || p.x() > high.x() || p.z() < low.z() || p.z() > high.z() || p.y() > high.y())
    return 0;
  const bool left = is_left_of(x, a, b, p);
  if (is_left_of(x, b, c, p) != left || is_left_of(x, c, a, p) != left) return 0;
  const Vec3 normal = (x[b] - x[a]).cross(x[c] - x[a]);
  const double above = normal.dot(x[a] - p);  // (height of the triangle over p) · normal.y
  if (normal.y() > 0) return above > 0 ? 1 : 0;
  if (normal.y() < 0) return above < 0 ? -1 : 0;
  return 0;
}

/// Connected components by vertices: shells in the order of their first triangles.
std::vector<std::vector<int>> find_shells(const TriangleMesh& mesh) {
  std::vector<int> parent(mesh.positions.size());
  std::iota(parent.begin(), parent.end(), 0);
  const auto root = [&](int v) {
    while (parent[v] != v) v = parent[v] = parent[parent[v]];
    return v;
  };
  for (const Triangle& t : mesh.triangles) {
    for (const int v : {t[1], t[2]}) parent[root(v)] = root(t[0]);
  }
  std::vector<std::vector<int>> shells;
  std::vector<int> number(mesh.positions.size(), -1);
  for (int t = 0; t < mesh.num_triangles(); ++t) {
    int& shell = number[root(mesh.triangles[t][0])];
    if (shell < 0) {
      shell = static_cast<int>(shells.size());
      shells.emplace_back();
    }
    shells[shell].push_back(t);
  }
  return shells;
}

TriangleMesh part_of(const TriangleMesh& mesh, const std::vector<int>& triangles) {
  TriangleMesh part{mesh.positions, {}};
  for (const int t : triangles) part.triangles.push_back(mesh.triangles[t]);
  return part;
}

/// Whether nearly all vertices of a shell are inside the others.
bool is_hollow(const TriangleMesh& mesh, const std::vector<int>& shell) {
  constexpr double kNearlyAll = 0.99;
  std::vector<char> is_own(mesh.triangles.size(), 0);
  for (const int t : shell) is_own[t] = 1;
  TriangleMesh others{mesh.positions, {}};
  for (int t = 0; t < mesh.num_triangles(); ++t) {
    if (!is_own[t]) others.triangles.push_back(mesh.triangles[t]);
  }
  std::vector<Vec3> points;
  for (const int t : shell) points.push_back(mesh.positions[mesh.triangles[t][0]]);
  const std::vector<int> winding = compute_winding_numbers(others, points);
  const auto outside = std::count(winding.begin(), winding.end(), 0);
  return static_cast<double>(outside) < (1 - kNearlyAll) * static_cast<double>(points.size());
}

}  // namespace

SurfaceEdges count_surface_edges(const TriangleMesh& mesh) {
  // Edges by their direction in each triangle.
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
  return compute_signed_volume(mesh.triangles, [&](int v) { return mesh.positions[v]; });
}

Shells turn_shells_outwards(TriangleMesh& mesh) {
  const std::vector<std::vector<int>> shells = find_shells(mesh);
  Shells result{.count = static_cast<int>(shells.size())};
  for (const std::vector<int>& shell : shells) {
    const TriangleMesh part = part_of(mesh, shell);
    if (compute_signed_volume(part) >= 0 || is_hollow(mesh, shell)) continue;
    for (const int t : shell) std::swap(mesh.triangles[t][1], mesh.triangles[t][2]);
    ++result.turned;
  }
  return result;
}

std::vector<int> compute_winding_numbers(const TriangleMesh& mesh, const std::vector<Vec3>& points) {
  // Points sorted by x: each triangle tests only those in its range of x.
  std::vector<int> order(points.size());
  std::iota(order.begin(), order.end(), 0);
  std::sort(order.begin(), order.end(), [&](int l, int r) {
    return points[l].x() != points[r].x() ? points[l].x() < points[r].x() : l < r;
  });
  std::vector<int> winding(points.size(), 0);
  for (const Triangle& tri : mesh.triangles) {
    const auto& x = mesh.positions;
    const auto [low, high] = std::minmax({x[tri[0]].x(), x[tri[1]].x(), x[tri[2]].x()});
    auto p = std::lower_bound(order.begin(), order.end(), low,
                              [&](int i, double limit) { return points[i].x() < limit; });
    for (; p != order.end() && points[*p].x() <= high; ++p) winding[*p] += cross_upwards(x, tri, points[*p]);
  }
  return winding;
}

int compute_winding_number(std::span<const Triangle> triangles, const std::vector<Vec3>& positions,
                           const Vec3& point) {
  int winding = 0;
  for (const Triangle& t : triangles) winding += cross_upwards(positions, t, point);
  return winding;
}

}  // namespace weft::engine
