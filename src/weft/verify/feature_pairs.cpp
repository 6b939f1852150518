#include "weft/verify/feature_pairs.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>
#include <utility>

#include "weft/verify/distance.h"
#include "weft/verify/sweep.h"

namespace weft::engine::verify {
namespace {

constexpr double kSteps = 4;        // minimum expected lifetime of a list, in steps
constexpr double kRounding = 1e-9;  // of distances and displacements [m]

using Bounds = Eigen::AlignedBox3d;
using Box = FeaturePairs::Box;
using Boxes = FeaturePairs::Boxes;

/// Displacement of a surface: its mean, and the largest deviation from it.
struct Way {
  Vec3 mean = Vec3::Zero();  // [m]
  double most_astray = 0;    // [m]
};

Way way_of(const MovingSurface& surface) {
  Way way;
  const std::size_t count = surface.start.size();
  for (std::size_t i = 0; i < count; ++i) way.mean += surface.end[i] - surface.start[i];
  if (count > 0) way.mean /= static_cast<double>(count);
  double most_sq = 0;
  for (std::size_t i = 0; i < count; ++i) {
    most_sq = std::max(most_sq, (surface.end[i] - surface.start[i] - way.mean).squaredNorm());
  }
  way.most_astray = std::sqrt(most_sq);
  return way;
}

/// Bound of the relative displacement of any two points of the surfaces.
double relative_way(const Way& a, const Way& b) {
  return a.most_astray + b.most_astray + (a.mean - b.mean).norm() + kRounding;
}

Bounds bounds_of(const std::vector<Vec3>& positions) {
  Bounds bounds;
  for (const Vec3& p : positions) bounds.extend(p);
  return bounds;
}

double size_of(const std::vector<Vec3>& positions) {
  return positions.empty() ? 0 : bounds_of(positions).diagonal().norm();
}

double gap_between(const Bounds& a, const Bounds& b) {
  return a.isEmpty() || b.isEmpty() ? std::numeric_limits<double>::infinity() : a.exteriorDistance(b);
}

bool has(const Triangle& triangle, int vertex) {
  return std::find(triangle.begin(), triangle.end(), vertex) != triangle.end();
}

bool owns_corner(const MovingSurface& surface, int t, int corner) { return surface.owned[t] >> corner & 1; }
bool owns_edge(const MovingSurface& surface, int t, int edge) { return surface.owned[t] >> (3 + edge) & 1; }

std::array<int, 2> edge_of(const Triangle& triangle, int k) {
  const auto [low, high] = std::minmax(triangle[k], triangle[(k + 1) % 3]);
  return {low, high};
}

/// Relative to the cloths' mean motion, enlarged by `margin`.
Boxes boxes_of_vertices(const std::vector<MovingSurface>& surfaces, double margin) {
  Vec3 mean = Vec3::Zero();
  double num_vertices = 0;
  for (const MovingSurface& surface : surfaces) {
    if (!surface.is_cloth) continue;
    for (std::size_t i = 0; i < surface.start.size(); ++i) mean += surface.end[i] - surface.start[i];
    num_vertices += static_cast<double>(surface.start.size());
  }
  mean /= std::max(1.0, num_vertices);
  Boxes boxes;
  for (const MovingSurface& surface : surfaces) {
    std::vector<Box>& own = boxes.emplace_back();
    for (std::size_t i = 0; i < surface.start.size(); ++i) {
      const Vec3 &from = surface.start[i], to = surface.end[i] - mean;
      own.emplace_back((from.cwiseMin(to) - Vec3::Constant(margin)).cast<float>(),
                       (from.cwiseMax(to) + Vec3::Constant(margin)).cast<float>());
    }
  }
  return boxes;
}

Box box_of(const Triangle& t, const std::vector<Box>& boxes) {
  return boxes[t[0]].merged(boxes[t[1]]).merged(boxes[t[2]]);
}

/// Calls visit for the pairs of two triangles' owned features with overlapping boxes.
class PairsOfTriangles {
 public:
  PairsOfTriangles(const std::vector<MovingSurface>& surfaces, const Boxes& boxes,
                   const FeaturePairs::Visit& visit)
      : surfaces_(surfaces), boxes_(boxes), visit_(visit) {}

  void operator()(TriangleId a, TriangleId b) const {
    if (b < a) std::swap(a, b);
    const Box of_a = box_of(triangle(a), boxes_[a.surface]), of_b = box_of(triangle(b), boxes_[b.surface]);
    visit_corners(a, b, of_b);
    visit_corners(b, a, of_a);
    for (int k = 0; k < 3; ++k) {
      if (!owns_edge(surface(a), a.triangle, k)) continue;
      const std::array<int, 2> edge = edge_of(triangle(a), k);
      const Box box = box_of_edge(a.surface, edge);
      if (!box.intersects(of_b)) continue;
      for (int l = 0; l < 3; ++l) {
        if (!owns_edge(surface(b), b.triangle, l)) continue;
        const std::array<int, 2> opposite = edge_of(triangle(b), l);
        if (box.intersects(box_of_edge(b.surface, opposite)))
          visit_edges(a.surface, edge, b.surface, opposite);
      }
    }
  }

 private:
  const MovingSurface& surface(TriangleId id) const { return surfaces_[id.surface]; }
  const Triangle& triangle(TriangleId id) const { return surface(id).triangles[id.triangle]; }

  Box box_of_edge(int surface, const std::array<int, 2>& edge) const {
    return boxes_[surface][edge[0]].merged(boxes_[surface][edge[1]]);
  }

  void visit_corners(TriangleId a, TriangleId b, const Box& of_b) const {
    if (!surface(b).has_faces) return;
    for (int k = 0; k < 3; ++k) {
      const int v = triangle(a)[k];
      if (!owns_corner(surface(a), a.triangle, k)) continue;
      if (a.surface == b.surface && has(triangle(b), v)) continue;
      if (!boxes_[a.surface][v].intersects(of_b)) continue;
      visit_({FeaturePair::Kind::vertex_triangle, a.surface, b.surface, {v, v}, {b.triangle, b.triangle}});
    }
  }

  void visit_edges(int surface, std::array<int, 2> edge, int other, std::array<int, 2> opposite) const {
    if (surface == other) {
      if (edge[0] == opposite[0] || edge[0] == opposite[1] || edge[1] == opposite[0] ||
          edge[1] == opposite[1])
        return;
      if (opposite < edge) std::swap(edge, opposite);
    }
    visit_({FeaturePair::Kind::edge_edge, surface, other, edge, opposite});
  }

  const std::vector<MovingSurface>& surfaces_;
  const Boxes& boxes_;
  const FeaturePairs::Visit& visit_;
};

/// Distance of a pair's features at the end of the motion.
double distance_at_end(const std::vector<MovingSurface>& surfaces, const FeaturePair& pair) {
  const std::vector<Vec3>&x = surfaces[pair.surface].end, &y = surfaces[pair.other].end;
  const Segment edge{x[pair.feature[0]], x[pair.feature[1]]};
  if (pair.kind == FeaturePair::Kind::edge_edge)
    return std::sqrt(distance_sq(edge, Segment{y[pair.opposite[0]], y[pair.opposite[1]]}));
  const auto& [a, b, c] = surfaces[pair.other].triangles[pair.opposite[0]];
  return std::sqrt(distance_sq(edge.from, Corners{y[a], y[b], y[c]}));
}

}  // namespace

MovingSurface::MovingSurface(std::vector<Triangle> of, Kind kind)
    : triangles(std::move(of)),
      is_cloth(kind == Kind::cloth),
      has_faces(kind != Kind::frame),
      owned(triangles.size()) {
  std::set<std::array<int, 2>> owned_before;  // edges, and vertices as edges to themselves
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    for (int k = 0; k < 3; ++k) {
      const int v = triangles[t][k];
      const std::array<int, 2> edge = edge_of(triangles[t], k);
      if (owned_before.insert({v, v}).second) owned[t] |= static_cast<unsigned char>(1 << k);
      if (edge[0] != edge[1] && owned_before.insert(edge).second)
        owned[t] |= static_cast<unsigned char>(8 << k);
    }
  }
}

FeaturePairs::FeaturePairs(int num_surfaces, double reach)
    : num_surfaces_(num_surfaces), reach_(reach), groups_(num_surfaces * num_surfaces) {}

bool FeaturePairs::for_each(const std::vector<MovingSurface>& surfaces, const MayMeet& may_meet,
                            const Visit& visit) {
  std::vector<Way> ways;
  bool is_flung = false;
  for (const MovingSurface& surface : surfaces) {
    ways.push_back(way_of(surface));
    is_flung |=
        surface.is_cloth && ways.back().most_astray > std::min(size_of(surface.start), size_of(surface.end));
  }
  if (is_flung) {
    for (Group& g : groups_) g.reach = 0;
    return false;
  }
  bool is_any_due = false;
  for (int a = 0; a < num_surfaces_; ++a) {
    for (int b = a; b < num_surfaces_; ++b) {
      Group& g = group(a, b);
      g.way = relative_way(ways[a], ways[b]);
      g.moved += g.way;
      g.is_due = g.moved > g.reach && may_meet(a, b);
      is_any_due |= g.is_due;
      if (g.is_due || !may_meet(a, b)) continue;
      for (auto near = g.near.begin(); near != g.near.end() && near->distance <= g.moved; ++near)
        visit(near->pair);
    }
  }
  if (is_any_due) rebuild(surfaces, visit);
  return true;
}

/// For surfaces with expired lists: visits the pairs of this motion, and lists those that are near at its end
/// if a list will last.
void FeaturePairs::rebuild(const std::vector<MovingSurface>& surfaces, const Visit& visit) {
  bool is_any_listed = false;
  for (Group& g : groups_) {
    if (!g.is_due) continue;
    g.moved = 0;
    g.reach = kSteps * g.way < reach_ ? reach_ : 0;
    g.near.clear();
    is_any_listed |= g.reach > 0;
  }
  const Visit visit_and_list = [&](const FeaturePair& pair) {
    visit(pair);
    Group& g = group(pair.surface, pair.other);
    if (g.reach == 0) return;
    const double distance = distance_at_end(surfaces, pair);
    if (distance <= g.reach) g.near.push_back({distance, pair});
  };
  const Boxes boxes = boxes_of_vertices(surfaces, is_any_listed ? 0.5 * reach_ + kRounding : 0);
  const PairsOfTriangles visit_pairs_of(surfaces, boxes, visit_and_list);
  Sweep(boxes_of_triangles(surfaces, boxes)).for_each_pair([&](TriangleId a, TriangleId b) {
    if (group(a.surface, b.surface).is_due) visit_pairs_of(a, b);
  });
  const auto is_nearer = [](const Near& p, const Near& q) { return p.distance < q.distance; };
  for (Group& g : groups_) {
    if (g.is_due) std::sort(g.near.begin(), g.near.end(), is_nearer);
  }
  reach_across_gaps(surfaces);
}

/// Boxes of the triangles that can meet others with expired lists.
std::vector<Sweep::Box> FeaturePairs::boxes_of_triangles(const std::vector<MovingSurface>& surfaces,
                                                         const Boxes& boxes) {
  Boxes::value_type whole;
  for (const std::vector<Box>& of_vertices : boxes) {
    Box& box = whole.emplace_back();
    for (const Box& vertex : of_vertices) box.extend(vertex);
  }
  std::vector<Sweep::Box> result;
  for (int s = 0; s < num_surfaces_; ++s) {
    const auto can_meet = [&](const Box& box) {
      for (int r = 0; r < num_surfaces_; ++r) {
        if (group(s, r).is_due && (r == s || whole[r].intersects(box))) return true;
      }
      return false;
    };
    const std::vector<Triangle>& triangles = surfaces[s].triangles;
    for (int t = 0; t < static_cast<int>(triangles.size()); ++t) {
      const Box box = box_of(triangles[t], boxes[s]);
      if (can_meet(box)) result.emplace_back(box.min(), box.max(), TriangleId{s, t});
    }
  }
  return result;
}

/// Distant surfaces need no list until they have moved by the gap between them.
void FeaturePairs::reach_across_gaps(const std::vector<MovingSurface>& surfaces) {
  std::vector<Bounds> bounds;
  for (const MovingSurface& surface : surfaces) bounds.push_back(bounds_of(surface.end));
  for (int a = 0; a < num_surfaces_; ++a) {
    for (int b = a + 1; b < num_surfaces_; ++b) {
      Group& g = group(a, b);
      if (g.is_due) g.reach = std::max(g.reach, gap_between(bounds[a], bounds[b]));
    }
  }
}

}  // namespace weft::engine::verify
