#include "weft/mesh/solid.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "weft/mesh/triangle_edges.h"

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

TriangleMesh part_of(const TriangleMesh& mesh, const std::vector<int>& triangles) {
  TriangleMesh part{mesh.positions, {}};
  for (const int t : triangles) part.triangles.push_back(mesh.triangles[t]);
  return part;
}

/// Whether nearly all vertices of a closed shell are inside the other closed ones.
bool is_hollow(const TriangleMesh& mesh, const std::vector<Shell>& shells, const Shell& shell) {
  constexpr double kNearlyAll = 0.99;
  TriangleMesh others{mesh.positions, {}};
  for (const Shell& other : shells) {
    if (!other.is_closed || &other == &shell) continue;
    for (const int t : other.triangles) others.triangles.push_back(mesh.triangles[t]);
  }
  std::vector<Vec3> points;
  for (const int t : shell.triangles) points.push_back(mesh.positions[mesh.triangles[t][0]]);
  const std::vector<int> winding = compute_winding_numbers(others, points);
  const auto outside = std::count(winding.begin(), winding.end(), 0);
  return static_cast<double>(outside) < (1 - kNearlyAll) * static_cast<double>(points.size());
}

TriangleMesh find_shells_of(const TriangleMesh& mesh, bool is_closed) {
  std::vector<char> is_wanted(mesh.triangles.size(), 0);
  for (const Shell& shell : find_shells(mesh)) {
    for (const int t : shell.triangles) is_wanted[t] = shell.is_closed == is_closed ? 1 : 0;
  }
  TriangleMesh part{mesh.positions, {}};
  for (int t = 0; t < mesh.num_triangles(); ++t) {
    if (is_wanted[t]) part.triangles.push_back(mesh.triangles[t]);
  }
  return part;
}

}  // namespace

SurfaceEdges count_surface_edges(const TriangleMesh& mesh) {
  SurfaceEdges edges;
  for_each_edge(find_triangle_edges(mesh), [&](std::span<const TriangleEdge> same) {
    if (same.size() == 1) ++edges.border;
    if (same.size() == 2 && !is_balanced(same)) ++edges.twisted;
    if (same.size() > 2) ++edges.non_manifold;
    if (!is_balanced(same)) ++edges.unbalanced;
  });
  return edges;
}

std::vector<Shell> find_shells(const TriangleMesh& mesh) {
  const std::vector<TriangleEdge> edges = find_triangle_edges(mesh);
  std::vector<int> joined(mesh.triangles.size());
  std::iota(joined.begin(), joined.end(), 0);
  const auto root = [&](int t) {
    while (joined[t] != t) t = joined[t] = joined[joined[t]];
    return t;
  };
  for_each_edge(edges, [&](std::span<const TriangleEdge> same) {
    if (same.size() > 2 && !is_balanced(same)) return;
    for (const TriangleEdge& edge : same) joined[root(edge.triangle)] = root(same[0].triangle);
  });
  std::vector<Shell> shells;
  std::vector<int> number(mesh.triangles.size(), -1);
  for (int t = 0; t < mesh.num_triangles(); ++t) {
    int& shell = number[root(t)];
    if (shell < 0) {
      shell = static_cast<int>(shells.size());
      shells.emplace_back();
    }
    shells[shell].triangles.push_back(t);
  }
  for_each_edge(edges, [&](std::span<const TriangleEdge> same) {
    for (const TriangleEdge& edge : same) {
      int balance = 0;
      for (const TriangleEdge& other : same)
        balance += root(other.triangle) != root(edge.triangle) ? 0 : other.is_ascending ? 1 : -1;
      if (balance != 0) shells[number[root(edge.triangle)]].is_closed = false;
    }
  });
  return shells;
}

TriangleMesh find_solid_part(const TriangleMesh& mesh) { return find_shells_of(mesh, true); }
TriangleMesh find_open_part(const TriangleMesh& mesh) { return find_shells_of(mesh, false); }

int orient_triangles(TriangleMesh& mesh) {
  // Neighbours across edges of two triangles, and whether both run along them in the same direction.
  struct Neighbour {
    int triangle;
    bool is_twisted;
  };
  std::vector<std::vector<Neighbour>> neighbours(mesh.triangles.size());
  for_each_edge(find_triangle_edges(mesh), [&](std::span<const TriangleEdge> same) {
    if (same.size() != 2) return;
    const int s = same[0].triangle, t = same[1].triangle;
    neighbours[s].push_back({t, !is_balanced(same)});
    neighbours[t].push_back({s, !is_balanced(same)});
  });
  constexpr char kUnknown = 2;
  std::vector<char> flips(mesh.triangles.size(), kUnknown);
  int num_flipped = 0;
  for (int first = 0; first < mesh.num_triangles(); ++first) {
    if (flips[first] != kUnknown) continue;
    std::vector<int> part = {first};
    flips[first] = 0;
    bool has_two_sides = true;
    for (std::size_t k = 0; k < part.size(); ++k) {
      for (const auto& [t, is_twisted] : neighbours[part[k]]) {
        const char wanted = static_cast<char>(flips[part[k]] ^ (is_twisted ? 1 : 0));
        if (flips[t] == kUnknown) {
          flips[t] = wanted;
          part.push_back(t);
        }
        has_two_sides &= flips[t] == wanted;
      }
    }
    if (!has_two_sides) continue;
    const auto num_ones = std::ranges::count_if(part, [&](int t) { return flips[t] == 1; });
    const char turned = 2 * num_ones > std::ssize(part) ? 0 : 1;
    for (const int t : part) {
      if (flips[t] != turned) continue;
      std::swap(mesh.triangles[t][1], mesh.triangles[t][2]);
      ++num_flipped;
    }
  }
  return num_flipped;
}

double compute_signed_volume(const TriangleMesh& mesh) {
  return compute_signed_volume(mesh.triangles, [&](int v) { return mesh.positions[v]; });
}

TurnedShells turn_shells_outwards(TriangleMesh& mesh) {
  const std::vector<Shell> shells = find_shells(mesh);
  TurnedShells result{.count = static_cast<int>(shells.size())};
  for (const Shell& shell : shells) {
    if (!shell.is_closed || compute_signed_volume(part_of(mesh, shell.triangles)) >= 0) continue;
    if (is_hollow(mesh, shells, shell)) continue;
    for (const int t : shell.triangles) std::swap(mesh.triangles[t][1], mesh.triangles[t][2]);
    ++result.turned;
  }
  return result;
}

std::vector<int> compute_winding_numbers(const TriangleMesh& mesh, const std::vector<Vec3>& points) {
  std::vector<int> winding(points.size(), 0);
  const std::vector<Vec3>& x = mesh.positions;
  if (mesh.triangles.empty() || points.empty()) return winding;
  Vec3 low = x[mesh.triangles[0][0]], high = low;
  for (const Triangle& t : mesh.triangles) {
    for (const int v : t) {
      low = low.cwiseMin(x[v]);
      high = high.cwiseMax(x[v]);
    }
  }
  // Points in the cells of a grid seen from above: each triangle tests those in the cells it may cover.
  constexpr int kMaxCells = 1024;  // along an axis
  const int n = std::clamp(static_cast<int>(std::sqrt(static_cast<double>(points.size()))), 1, kMaxCells);
  const auto cell_along = [&](int axis, double coordinate) {
    const double share = (coordinate - low[axis]) / (high[axis] - low[axis]);
    return share > 0 ? static_cast<int>(std::min(n - 1.0, share * n)) : 0;
  };
  std::vector<std::vector<int>> cells(static_cast<std::size_t>(n) * n);
  for (int p = 0; p < static_cast<int>(points.size()); ++p) {
    const Vec3& at = points[p];
    if ((at.array() < low.array()).any() || (at.array() > high.array()).any()) continue;
    cells[cell_along(0, at.x()) * n + cell_along(2, at.z())].push_back(p);
  }
  for (const Triangle& t : mesh.triangles) {
    const Vec3 least = x[t[0]].cwiseMin(x[t[1]]).cwiseMin(x[t[2]]),
               most = x[t[0]].cwiseMax(x[t[1]]).cwiseMax(x[t[2]]);
    const int last_i = cell_along(0, most.x()), last_k = cell_along(2, most.z());
    for (int i = cell_along(0, least.x()); i <= last_i; ++i) {
      for (int k = cell_along(2, least.z()); k <= last_k; ++k) {
        for (const int p : cells[i * n + k]) winding[p] += cross_upwards(x, t, points[p]);
      }
    }
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
