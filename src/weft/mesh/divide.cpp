#include "weft/mesh/divide.h"

#include <algorithm>
#include <numeric>
#include <tuple>

namespace weft::engine {
namespace {

struct Corner {
  int vertex;
  Vec3 weights;  // in the source triangle
};

using Side = std::vector<Corner>;  // points inside a side, in its direction

/// Side k goes from corner k to corner k + 1.
struct Part {
  std::array<Corner, 3> corners;
  std::array<Side, 3> sides;
};

/// Splits a part in two, from the middle point of side k to the opposite corner.
std::pair<Part, Part> cut(const Part& part, int k) {
  const Side& side = part.sides[k];
  const auto middle = side.begin() + static_cast<std::ptrdiff_t>(side.size() / 2);
  const Corner &from = part.corners[k], &to = part.corners[(k + 1) % 3], &across = part.corners[(k + 2) % 3];
  return {Part{{from, *middle, across}, {Side(side.begin(), middle), {}, part.sides[(k + 2) % 3]}},
          Part{{*middle, to, across}, {Side(middle + 1, side.end()), part.sides[(k + 1) % 3], {}}}};
}

void add_parts(const Part& part, int source, DividedTriangles& result) {
  const auto longest = std::max_element(part.sides.begin(), part.sides.end(),
                                        [](const Side& l, const Side& r) { return l.size() < r.size(); });
  if (!longest->empty()) {
    const auto [left, right] = cut(part, static_cast<int>(longest - part.sides.begin()));
    add_parts(left, source, result);
    add_parts(right, source, result);
    return;
  }
  const auto& [a, b, c] = part.corners;
  result.triangles.push_back({a.vertex, b.vertex, c.vertex});
  result.source.push_back(source);
  result.weights.push_back({a.weights, b.weights, c.weights});
}

/// Points (sorted by edge and t, a < b) inside the side, from its first corner to its second.
Side find_side(const std::vector<EdgePoint>& points, const Corner& from, const Corner& to) {
  const auto [a, b] = std::minmax(from.vertex, to.vertex);
  const auto is_before = [](const EdgePoint& p, const std::pair<int, int>& edge) {
    return std::pair(p.a, p.b) < edge;
  };
  Side side;
  auto p = std::lower_bound(points.begin(), points.end(), std::pair(a, b), is_before);
  for (; p != points.end() && p->a == a && p->b == b; ++p) {
    const double t = from.vertex == a ? p->t : 1 - p->t;
    side.push_back({p->vertex, (1 - t) * from.weights + t * to.weights});
  }
  if (from.vertex != a) std::reverse(side.begin(), side.end());
  return side;
}

}  // namespace

DividedTriangles make_undivided(const std::vector<Triangle>& triangles) {
  DividedTriangles result{triangles, std::vector<int>(triangles.size()), {}};
  std::iota(result.source.begin(), result.source.end(), 0);
  result.weights.assign(triangles.size(), make_whole_weights());
  return result;
}

DividedTriangles divide_edges(const DividedTriangles& whole, std::vector<EdgePoint> points) {
  for (EdgePoint& p : points) {
    if (p.a > p.b) p = {p.b, p.a, 1 - p.t, p.vertex};
  }
  std::sort(points.begin(), points.end(), [](const EdgePoint& l, const EdgePoint& r) {
    return std::tie(l.a, l.b, l.t, l.vertex) < std::tie(r.a, r.b, r.t, r.vertex);
  });
  DividedTriangles result;
  for (std::size_t t = 0; t < whole.triangles.size(); ++t) {
    Part part;
    for (int k = 0; k < 3; ++k) part.corners[k] = {whole.triangles[t][k], whole.weights[t][k]};
    for (int k = 0; k < 3; ++k) part.sides[k] = find_side(points, part.corners[k], part.corners[(k + 1) % 3]);
    add_parts(part, whole.source[t], result);
  }
  return result;
}

}  // namespace weft::engine
