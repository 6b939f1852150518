#include "weft/mesh/solid.h"

#include <algorithm>
#include <numeric>
#include <tuple>
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

/// An edge of a triangle: its vertices in ascending order, and whether the triangle runs along it that way.
struct TriangleEdge {
  int a = 0, b = 0;
  bool is_ascending = true;
  int triangle = 0;
};

/// The edges of all triangles, those of the same edge one after another.
std::vector<TriangleEdge> find_triangle_edges(const TriangleMesh& mesh) {
  std::vector<TriangleEdge> edges;
  edges.reserve(3 * mesh.triangles.size());
  for (int t = 0; t < mesh.num_triangles(); ++t) {
    for (int k = 0; k < 3; ++k) {
      const int from = mesh.triangles[t][k], to = mesh.triangles[t][(k + 1) % 3];
      edges.push_back({std::min(from, to), std::max(from, to), from < to, t});
    }
  }
  std::sort(edges.begin(), edges.end(), [](const TriangleEdge& e, const TriangleEdge& f) {
    return std::tie(e.a, e.b, e.triangle) < std::tie(f.a, f.b, f.triangle);
  });
  return edges;
}

/// Calls visit(edges of one and the same edge) for each edge.
template <class Visit>
void for_each_edge(const std::vector<TriangleEdge>& edges, const Visit& visit) {
  for (std::size_t begin = 0, end = 0; begin < edges.size(); begin = end) {
    while (end < edges.size() && edges[end].a == edges[begin].a && edges[end].b == edges[begin].b) ++end;
    visit(std::span(edges).subspan(begin, end - begin));
  }
}

bool is_balanced(std::span<const TriangleEdge> same) {
  return 2 * std::ranges::count(same, true, &TriangleEdge::is_ascending) == std::ssize(same);
}

TriangleMesh part_of(const TriangleMesh& mesh, const std::vector<int>& triangles) {
  TriangleMesh part{mesh.positions, {}};
  for (const int t : triangles) part.triangles.push_back(mesh.triangles[t]);
  return part;
}

/// Whether nearly all vertices of a closed shell are inside the other ones.
bool is_hollow(const TriangleMesh& mesh, const std::vector<int>& shell) {
  constexpr double kNearlyAll = 0.99;
  std::vector<char> is_own(mesh.triangles.size(), 0);
  for (const int t : shell) is_own[t] = 1;
  TriangleMesh others{mesh.positions, {}};
  for (const Shell& other : find_shells(mesh)) {
    if (!other.is_closed || is_own[other.triangles[0]]) continue;
    for (const int t : other.triangles) others.triangles.push_back(mesh.triangles[t]);
  }
  std::vector<Vec3> points;
  for (const int t : shell) points.push_back(mesh.positions[mesh.triangles[t][0]]);
  const std::vector<int> winding = compute_winding_numbers(others, points);
  const auto outside = std::count(winding.begin(), winding.end(), 0);
  return static_cast<double>(outside) < (1 - kNearlyAll) * static_cast<double>(points.size());
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
  std::vector<int> parent(mesh.positions.size());
  std::iota(parent.begin(), parent.end(), 0);
  const auto root = [&](int v) {
    while (parent[v] != v) v = parent[v] = parent[parent[v]];
    return v;
  };
  for (const Triangle& t : mesh.triangles) {
    for (const int v : {t[1], t[2]}) parent[root(v)] = root(t[0]);
  }
  std::vector<Shell> shells;
  std::vector<int> number(mesh.positions.size(), -1);
  for (int t = 0; t < mesh.num_triangles(); ++t) {
    int& shell = number[root(mesh.triangles[t][0])];
    if (shell < 0) {
      shell = static_cast<int>(shells.size());
      shells.emplace_back();
    }
    shells[shell].triangles.push_back(t);
  }
  for_each_edge(find_triangle_edges(mesh), [&](std::span<const TriangleEdge> same) {
    if (!is_balanced(same)) shells[number[root(same[0].a)]].is_closed = false;
  });
  return shells;
}

TriangleMesh find_solid_part(const TriangleMesh& mesh) {
  std::vector<char> is_solid(mesh.triangles.size(), 0);
  for (const Shell& shell : find_shells(mesh)) {
    for (const int t : shell.triangles) is_solid[t] = shell.is_closed ? 1 : 0;
  }
  TriangleMesh part{mesh.positions, {}};
  for (int t = 0; t < mesh.num_triangles(); ++t) {
    if (is_solid[t]) part.triangles.push_back(mesh.triangles[t]);
  }
  return part;
}

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

Shells turn_shells_outwards(TriangleMesh& mesh) {
  Shells result;
  for (const Shell& shell : find_shells(mesh)) {
    if (!shell.is_closed) continue;
    ++result.count;
    const TriangleMesh part = part_of(mesh, shell.triangles);
    if (compute_signed_volume(part) >= 0 || is_hollow(mesh, shell.triangles)) continue;
    for (const int t : shell.triangles) std::swap(mesh.triangles[t][1], mesh.triangles[t][2]);
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
