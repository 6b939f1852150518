#include "weft/mesh/holes.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <vector>

#include "weft/mesh/polygon.h"
#include "weft/mesh/solid.h"
#include "weft/mesh/triangle_edges.h"

namespace weft::engine {
namespace {

using Loop = std::vector<int>;  // vertices of a border, against the direction of its triangles

/// The border of an open shell.
struct Border {
  std::map<int, std::vector<int>> next;  // vertices to the following ones, against the triangles
  bool can_close = true;
};

/// (shells)
std::vector<Border> find_borders(const TriangleMesh& mesh, const std::vector<Shell>& shells) {
  std::vector<int> shell_of(mesh.triangles.size());
  for (std::size_t s = 0; s < shells.size(); ++s) {
    for (const int t : shells[s].triangles) shell_of[t] = static_cast<int>(s);
  }
  std::vector<Border> borders(shells.size());
  for_each_edge(find_triangle_edges(mesh), [&](std::span<const TriangleEdge> same) {
    const auto& [a, b, is_ascending, triangle] = same[0];
    if (same.size() == 1) {
      borders[shell_of[triangle]].next[is_ascending ? b : a].push_back(is_ascending ? a : b);
    } else if (!is_balanced(same)) {
      for (const TriangleEdge& edge : same) borders[shell_of[edge.triangle]].can_close = false;
    }
  });
  return borders;
}

/// Every vertex of a border has as many edges that enter as leave. Where borders touch, a walk comes back to a
/// vertex: the way since then is a loop.
std::vector<Loop> find_loops(Border border) {
  std::vector<Loop> loops;
  for (auto& [first, ways] : border.next) {
    while (!ways.empty()) {
      std::vector<int> walk = {first};
      std::map<int, std::size_t> place = {{first, 0}};  // of each vertex in the walk
      while (!border.next[walk.back()].empty()) {
        std::vector<int>& onwards = border.next[walk.back()];
        const int to = onwards.back();
        onwards.pop_back();
        const auto [since, is_new] = place.try_emplace(to, walk.size());
        if (is_new) {
          walk.push_back(to);
          continue;
        }
        loops.emplace_back(walk.begin() + since->second, walk.end());
        while (walk.back() != to) {
          place.erase(walk.back());
          walk.pop_back();
        }
      }
    }
  }
  return loops;
}

std::vector<Triangle> fill(const TriangleMesh& mesh, const Loop& loop) {
  std::vector<Vec3> corners;
  for (const int v : loop) corners.push_back(mesh.positions[v]);
  std::vector<Triangle> triangles;
  for (const auto& [a, b, c] : triangulate(corners)) triangles.push_back({loop[a], loop[b], loop[c]});
  return triangles;
}

double compute_area(const TriangleMesh& mesh) {
  double area = 0;
  for (int t = 0; t < mesh.num_triangles(); ++t) area += triangle_area(mesh, t);
  return area;
}

/// Whether the triangle's height is below a millionth of its longest edge.
bool has_no_area(const TriangleMesh& mesh, int t) {
  constexpr double kFlat = 1e-6;
  const auto [i, j, k] = mesh.triangles[t];
  const std::vector<Vec3>& x = mesh.positions;
  const double longest_sq =
      std::max({(x[i] - x[j]).squaredNorm(), (x[j] - x[k]).squaredNorm(), (x[k] - x[i]).squaredNorm()});
  return !(2 * triangle_area(mesh, t) > kFlat * longest_sq);
}

}  // namespace

FilledHoles fill_holes(TriangleMesh& mesh, double max_share) {
  constexpr double kNoVolume = 1e-6;  // of the area to the power of 3/2
  FilledHoles filled;
  const std::vector<Shell> shells = find_shells(mesh);
  const std::vector<Border> borders = find_borders(mesh, shells);
  for (std::size_t s = 0; s < shells.size(); ++s) {
    if (borders[s].next.empty() || !borders[s].can_close) continue;
    TriangleMesh surface{mesh.positions, {}}, filling{mesh.positions, {}};
    for (const int t : shells[s].triangles) surface.triangles.push_back(mesh.triangles[t]);
    const std::vector<Loop> loops = find_loops(borders[s]);
    double largest = 0;
    for (const Loop& loop : loops) {
      const TriangleMesh one{mesh.positions, fill(mesh, loop)};
      filling.triangles.insert(filling.triangles.end(), one.triangles.begin(), one.triangles.end());
      largest = std::max(largest, 2 * std::sqrt(compute_area(one) / std::numbers::pi));
    }
    const double area = compute_area(surface);
    if (compute_area(filling) > max_share * area) continue;
    bool is_flat = false;
    for (int t = 0; t < filling.num_triangles(); ++t) is_flat |= has_no_area(filling, t);
    surface.triangles.insert(surface.triangles.end(), filling.triangles.begin(), filling.triangles.end());
    if (is_flat || std::abs(compute_signed_volume(surface)) <= kNoVolume * area * std::sqrt(area)) continue;
    mesh.triangles.insert(mesh.triangles.end(), filling.triangles.begin(), filling.triangles.end());
    filled.count += static_cast<int>(loops.size());
    filled.largest = std::max(filled.largest, largest);
  }
  return filled;
}

}  // namespace weft::engine
