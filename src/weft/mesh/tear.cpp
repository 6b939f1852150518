#include "weft/mesh/tear.h"

#include <numeric>
#include <string>
#include <utility>

#include "weft/error.h"
#include "weft/mesh/triangle_edges.h"

namespace weft::engine {
namespace {

/// Sets of corners 3 t + k (union–find).
class CornerSets {
 public:
  explicit CornerSets(int num_triangles) : parent_(3 * static_cast<std::size_t>(num_triangles)) {
    std::iota(parent_.begin(), parent_.end(), 0);
  }

  int find(int corner) {
    while (parent_[corner] != corner) corner = parent_[corner] = parent_[parent_[corner]];
    return corner;
  }

  void unite(int a, int b) { parent_[find(a)] = find(b); }

 private:
  std::vector<int> parent_;
};

}  // namespace

RestMesh tear_mesh(const RestMesh& whole, std::span<const int> broken) {
  RestMesh torn = whole;
  if (broken.empty()) return torn;
  CornerSets sets(whole.num_triangles());
  std::vector<char> is_at_tear(whole.positions.size(), 0);
  int edge = 0;
  for_each_edge(find_triangle_edges(whole), [&](std::span<const TriangleEdge> same) {
    const bool is_broken = !broken.empty() && broken.front() == edge;
    ++edge;
    if (is_broken) broken = broken.subspan(1);
    for (const int v : {same[0].a, same[0].b}) {
      if (is_broken) is_at_tear[v] = 1;
      for (std::size_t k = 1; !is_broken && k < same.size(); ++k) {
        const int s = same[k - 1].triangle, t = same[k].triangle;
        sets.unite(3 * s + corner_of(whole.triangles[s], v), 3 * t + corner_of(whole.triangles[t], v));
      }
    }
  });
  if (!broken.empty())
    throw InputError("edge " + std::to_string(broken.front()) + " cannot tear: the mesh has " +
                     std::to_string(edge));
  std::vector<int> vertex_of_set(3 * whole.triangles.size(), -1);
  std::vector<char> is_taken(whole.positions.size(), 0), is_part(whole.positions.size(), 0);
  for (int t = 0; t < whole.num_triangles(); ++t) {
    for (int k = 0; k < 3; ++k) {
      const int v = whole.triangles[t][k];
      if (!is_at_tear[v]) continue;
      int& vertex = vertex_of_set[sets.find(3 * t + k)];
      if (vertex < 0 && !std::exchange(is_taken[v], 1)) vertex = v;
      if (vertex < 0) {
        vertex = torn.num_vertices();
        torn.positions.push_back(whole.positions[v]);
        is_part.push_back(1);
        is_part[v] = 1;
      }
      torn.triangles[t][k] = vertex;
    }
  }
  if (torn.at_rest.empty()) {
    for (int t = 0; t < whole.num_triangles(); ++t) torn.at_rest.push_back(whole.corners(t));
  }
  draw_in(torn.triangles, is_part, torn.positions);
  return torn;
}

std::vector<int> find_same_corners(const std::vector<Triangle>& triangles, int num_vertices,
                                   const std::vector<Triangle>& others) {
  std::vector<int> same(static_cast<std::size_t>(num_vertices));
  std::iota(same.begin(), same.end(), 0);
  for (std::size_t t = triangles.size(); t-- > 0;) {
    for (int k = 3; k-- > 0;) same[triangles[t][k]] = others[t][k];
  }
  return same;
}

void draw_in(const std::vector<Triangle>& triangles, std::span<const char> is_chosen,
             std::vector<Vec3>& positions) {
  constexpr double kShare = 0.02;  // of the way
  std::vector<Vec3> middle(positions.size(), Vec3::Zero());
  std::vector<int> count(positions.size(), 0);
  for (const Triangle& t : triangles) {
    for (const int v : t) {
      if (!is_chosen[v]) continue;
      middle[v] += (positions[t[0]] + positions[t[1]] + positions[t[2]]) / 3;
      ++count[v];
    }
  }
  for (std::size_t v = 0; v < positions.size(); ++v) {
    if (count[v] > 0) positions[v] += kShare * (middle[v] / count[v] - positions[v]);
  }
}

}  // namespace weft::engine
