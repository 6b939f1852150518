#include "weft/mesh/borders.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace weft::engine {
namespace {

constexpr int kNone = -1;
constexpr int kMany = -2;

/// Side k of triangle t is number 3 t + k and goes from its corner k to its corner k + 1.
struct Sides {
  const std::vector<Triangle>& triangles;
  std::vector<int> mate;  // matching side in the only other triangle, kNone on a border, kMany for several

  int from(int side) const { return triangles[side / 3][side % 3]; }
  int to(int side) const { return triangles[side / 3][(side + 1) % 3]; }

  /// The triangle's other side at that vertex.
  int other_at(int side, int vertex) const {
    return side - side % 3 + (side % 3 + (to(side) == vertex ? 1 : 2)) % 3;
  }

  /// The next border side around the vertex from a border side, or kNone.
  int next_around(int side, int vertex) const {
    int s = other_at(side, vertex);
    while (mate[s] >= 0) s = other_at(mate[s], vertex);
    return mate[s] == kNone ? s : kNone;
  }
};

Sides build_sides(const std::vector<Triangle>& triangles) {
  Sides sides{triangles, std::vector<int>(3 * triangles.size(), kMany)};
  std::vector<int> order(sides.mate.size());
  std::iota(order.begin(), order.end(), 0);
  const auto key = [&](int s) { return std::minmax({sides.from(s), sides.to(s)}); };
  std::sort(order.begin(), order.end(),
            [&](int l, int r) { return key(l) != key(r) ? key(l) < key(r) : l < r; });
  for (std::size_t i = 0, end = 0; i < order.size(); i = end) {
    while (end < order.size() && key(order[end]) == key(order[i])) ++end;
    if (end - i == 1) sides.mate[order[i]] = kNone;
    if (end - i == 2) sides.mate[order[i]] = order[i + 1], sides.mate[order[i + 1]] = order[i];
  }
  return sides;
}

/// The lowest vertex of each vertex's connected component.
std::vector<int> find_pieces(const TriangleMesh& mesh) {
  std::vector<int> piece(mesh.positions.size());
  std::iota(piece.begin(), piece.end(), 0);
  const auto root = [&](int v) {
    while (piece[v] != v) v = piece[v] = piece[piece[v]];
    return v;
  };
  for (const auto& [a, b, c] : mesh.triangles) {
    for (const int v : {b, c}) {
      const auto [low, high] = std::minmax({root(a), root(v)});
      piece[high] = low;
    }
  }
  for (int v = 0; v < mesh.num_vertices(); ++v) piece[v] = root(v);
  return piece;
}

struct BorderBuilder {
  const TriangleMesh& mesh;
  Sides sides = build_sides(mesh.triangles);
  std::vector<int> piece = find_pieces(mesh);
  std::vector<char> is_done = std::vector<char>(sides.mate.size(), 0);
  Borders borders = {};

  void add_edge(int side, int from) {
    const int to = sides.from(side) == from ? sides.to(side) : sides.from(side);
    const int triangle = side / 3, opposite = mesh.triangles[triangle][(side + 2) % 3];
    const Vec3 along = mesh.positions[to] - mesh.positions[from];
    BorderEdge edge{.a = from,
                    .b = to,
                    .triangle = triangle,
                    .border = static_cast<int>(borders.lengths.size()) - 1,
                    .piece = piece[from],
                    .arc = borders.lengths.back(),
                    .length = along.norm(),
                    .tangent = along.normalized(),
                    .inward = mesh.positions[opposite] - mesh.positions[from],
                    .side = Vec3::Zero()};
    edge.inward = (edge.inward - edge.inward.dot(edge.tangent) * edge.tangent).normalized();
    edge.side = edge.tangent.cross(edge.inward);
    borders.lengths.back() += edge.length;
    add_node(from, static_cast<int>(borders.edges.size()));
    borders.edges.push_back(edge);
    is_done[side] = 1;
  }

  void add_node(int vertex, int edge) {
    const int n = static_cast<int>(borders.nodes.size());
    borders.nodes.push_back({vertex, edge, 0, n - 1, n + 1, mesh.positions[vertex]});
  }

  /// Start of an open border, against its direction; of a closed one the given side and vertex.
  std::pair<int, int> find_start(int side, int from) const {
    const int first = side;
    while (true) {
      const int before = sides.next_around(side, from);
      if (before == kNone || before == first) return {side, from};
      side = before;
      from = sides.from(side) == from ? sides.to(side) : sides.from(side);
    }
  }

  void add_border(int any_side) {
    const auto [first, start] = find_start(any_side, sides.from(any_side));
    const int first_node = static_cast<int>(borders.nodes.size());
    borders.lengths.push_back(0);
    int side = first, from = start;
    while (side != kNone && !is_done[side]) {
      add_edge(side, from);
      from = borders.edges.back().b;
      side = sides.next_around(side, from);
    }
    const bool is_closed = side == first;
    if (!is_closed) add_node(from, -1);
    const int last_node = static_cast<int>(borders.nodes.size()) - 1;
    borders.nodes[first_node].previous = is_closed ? last_node : -1;
    borders.nodes[last_node].next = is_closed ? first_node : -1;
  }
};

}  // namespace

int Borders::divide(int node, double t) {
  const BorderNode &start = nodes[node], &next = nodes[start.next];
  const double share = (t - start.t) / (end_of(node) - start.t);
  const int n = static_cast<int>(nodes.size());
  const BorderNode added{
      num_vertices++, start.edge, t,
      node,           start.next, start.position + share * (next.position - start.position)};
  nodes[added.next].previous = n;
  nodes[node].next = n;
  nodes.push_back(added);
  return n;
}

double Borders::distance_along(int node_a, int node_b) const {
  const auto arc = [&](const BorderNode& n) {
    return n.edge < 0 ? lengths[edges[nodes[n.previous].edge].border]
                      : edges[n.edge].arc + n.t * edges[n.edge].length;
  };
  const BorderNode &a = nodes[node_a], &b = nodes[node_b];
  const double one_way = std::abs(arc(a) - arc(b));
  const double around = lengths[edges[(a.edge < 0 ? nodes[a.previous] : a).edge].border] - one_way;
  return std::min(one_way, around);
}

Borders build_borders(const TriangleMesh& mesh) {
  BorderBuilder builder{.mesh = mesh};
  builder.borders.num_vertices = mesh.num_vertices();
  for (int side = 0; side < static_cast<int>(builder.sides.mate.size()); ++side) {
    if (builder.sides.mate[side] == kNone && !builder.is_done[side]) builder.add_border(side);
  }
  return std::move(builder.borders);
}

}  // namespace weft::engine
