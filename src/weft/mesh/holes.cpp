#include "weft/mesh/holes.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <vector>

#include "weft/mesh/polygon.h"
#include "weft/mesh/solid.h"

namespace weft::engine {
namespace {

using Loop = std::vector<int>;  // vertices of a closed border, along which its hole is to the left

/// The closed borders of a shell; nothing if some border is not closed.
std::vector<Loop> find_loops(const TriangleMesh& mesh, const Shell& shell) {
  std::map<std::pair<int, int>, int> balance;  // of each edge, ascending: how often more along it than back
  for (const int t : shell.triangles) {
    for (int k = 0; k < 3; ++k) {
      const int from = mesh.triangles[t][k], to = mesh.triangles[t][(k + 1) % 3];
      balance[{std::min(from, to), std::max(from, to)}] += from < to ? 1 : -1;
    }
  }
  std::map<int, std::vector<int>> next;  // against the triangles
  for (const auto& [edge, excess] : balance) {
    if (std::abs(excess) > 1) return {};
    if (excess == 1) next[edge.second].push_back(edge.first);
    if (excess == -1) next[edge.first].push_back(edge.second);
  }
  // Where borders touch, a walk comes back to a vertex: the part since then is a loop of its own.
  std::vector<Loop> loops;
  for (auto& [first, ways] : next) {
    while (!ways.empty()) {
      std::vector<int> walk = {first};
      while (!walk.empty()) {
        std::vector<int>& onwards = next[walk.back()];
        if (onwards.empty() && walk.size() == 1) break;
        if (onwards.empty()) return {};
        const int to = onwards.back();
        onwards.pop_back();
        const auto since = std::find(walk.begin(), walk.end(), to);
        if (since == walk.end()) {
          walk.push_back(to);
          continue;
        }
        loops.emplace_back(since, walk.end());
        walk.erase(since + 1, walk.end());
      }
    }
  }
  return loops;
}

double compute_area(const TriangleMesh& mesh, const Loop& loop) {
  const Vec3& from = mesh.positions[loop[0]];
  Vec3 sum = Vec3::Zero();
  for (std::size_t k = 1; k + 1 < loop.size(); ++k)
    sum += (mesh.positions[loop[k]] - from).cross(mesh.positions[loop[k + 1]] - from);
  return 0.5 * sum.norm();
}

}  // namespace

FilledHoles fill_holes(TriangleMesh& mesh, double most) {
  FilledHoles filled;
  for (const Shell& shell : find_shells(mesh)) {
    if (shell.is_closed) continue;
    const std::vector<Loop> loops = find_loops(mesh, shell);
    double area = 0, of_holes = 0;
    for (const int t : shell.triangles) area += triangle_area(mesh, t);
    for (const Loop& loop : loops) of_holes += compute_area(mesh, loop);
    if (of_holes > most * area) continue;
    for (const Loop& loop : loops) {
      std::vector<Vec3> corners;
      for (const int v : loop) corners.push_back(mesh.positions[v]);
      for (const auto& [a, b, c] : triangulate(corners))
        mesh.triangles.push_back({loop[a], loop[b], loop[c]});
      ++filled.count;
      filled.largest = std::max(filled.largest, 2 * std::sqrt(compute_area(mesh, loop) / std::numbers::pi));
    }
  }
  return filled;
}

}  // namespace weft::engine
