#include "weft/verify/feature_pairs.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>
#include <utility>

#include "weft/verify/distance.h"
#include "weft/verify/sweep.h"

namespace weft::verify {
namespace {

constexpr double kRounding = 1e-9;  // of distances and of how far surfaces have moved [m]

using Bounds = Eigen::AlignedBox3d;

/// The way that a surface makes, but for the mean.
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

/// No two points of the surfaces move farther than this relative to each other.
double relative_way(const Way& a, const Way& b) {
  return a.most_astray + b.most_astray + (a.mean - b.mean).norm() + kRounding;
}

Bounds bounds_of(const std::vector<Vec3>& positions) {
  Bounds bounds;
  for (const Vec3& p : positions) bounds.extend(p);
  return bounds;
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

/// Calls visit for the pairs of two triangles' own features.
class PairsOfTriangles {
 public:
  PairsOfTriangles(const std::vector<MovingSurface>& surfaces, const FeaturePairs::Visit& visit)
      : surfaces_(surfaces), visit_(visit) {}

  void operator()(TriangleId a, TriangleId b) const {
    visit_corners(a, b);
    visit_corners(b, a);
    if (b < a) std::swap(a, b);
    for (int k = 0; k < 3; ++k) {
      if (!owns_edge(surface(a), a.triangle, k)) continue;
      for (int l = 0; l < 3; ++l) {
        if (owns_edge(surface(b), b.triangle, l)) 
          visit_edges(a.surface, edge_of(triangle(a), k), b.surface, edge_of(triangle(b), l));
      }
    }
  }

 private:
  const MovingSurface& surface(TriangleId id) const { return surfaces_[id.surface]; }
  const Triangle& triangle(TriangleId id) const { return surface(id).triangles[id.triangle]; }

  void visit_corners(TriangleId a, TriangleId b) const {
    if (!surface(b).has_faces) return;
    for (int k = 0; k < 3; ++k) {
      const int vertex = triangle(a)[k];
      if (!owns_corner(surface(a), a.triangle, k)) continue;
      if (a.surface == b.surface && has(triangle(b), vertex)) continue;
      visit_({FeaturePair::Kind::vertex_triangle, a.surface, b.surface, {vertex, vertex}, {b.triangle, b.triangle}});
    }
  }

  void visit_edges(int surface, std::array<int, 2> edge, int other, std::array<int, 2> opposite) const {
    if (surface == other) {
      if (edge[0] == opposite[0] || edge[0] == opposite[1] || edge[1] == opposite[0] || edge[1] == opposite[1])
        return;
      if (opposite < edge) std::swap(edge, opposite);
    }
    visit_({FeaturePair::Kind::edge_edge, surface, other, edge, opposite});
  }

  const std::vector<MovingSurface>& surfaces_;
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

/// The boxes in which triangles move relative to the cloths' mean motion, enlarged by `margin`, of all that
/// can meet cloth.
std::vector<Sweep::Box> moving_boxes(const std::vector<MovingSurface>& surfaces, double margin) {
  Vec3 mean = Vec3::Zero();
  double num_vertices = 0;
  for (const MovingSurface& surface : surfaces) {
    if (!surface.is_cloth) continue;
    for (std::size_t i = 0; i < surface.start.size(); ++i) mean += surface.end[i] - surface.start[i];
    num_vertices += static_cast<double>(surface.start.size());
  }
  mean /= std::max(1.0, num_vertices);

  std::vector<Sweep::Box> boxes;
  Bounds of_cloth;
  for (int s = 0; s < static_cast<int>(surfaces.size()); ++s) {  // cloths come first
    const MovingSurface& surface = surfaces[s];
    for (int t = 0; t < static_cast<int>(surface.triangles.size()); ++t) {
      Bounds box;
      for (const int v : surface.triangles[t]) {
        box.extend(surface.start[v]);
        box.extend(surface.end[v] - mean);
      }
      box = Bounds(box.min() - Vec3::Constant(margin), box.max() + Vec3::Constant(margin));
      if (surface.is_cloth) of_cloth.extend(box);
      if (surface.is_cloth || of_cloth.intersects(box)) boxes.emplace_back(box.min(), box.max(), TriangleId{s, t});
    }
  }
  return boxes;
}

}  // namespace

MovingSurface::MovingSurface(std::vector<Triangle> of, Kind kind)
    : triangles(std::move(of)), is_cloth(kind == Kind::cloth), has_faces(kind != Kind::frame), owned(triangles.size()) {
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

void FeaturePairs::for_each(const std::vector<MovingSurface>& surfaces, const MayMeet& may_meet,
                            const Visit& visit) {
  std::vector<Way> ways;
  for (const MovingSurface& surface : surfaces) ways.push_back(way_of(surface));
  bool is_beyond_reach = false;
  for (int a = 0; a < num_surfaces_; ++a) {
    for (int b = a; b < num_surfaces_; ++b) {
      Group& g = group(a, b);
      g.may_meet = may_meet(a, b);
      if (!g.may_meet) continue;
      g.way = relative_way(ways[a], ways[b]);
      g.moved += g.way;
      is_beyond_reach |= g.moved > g.reach;
    }
  }
  if (is_beyond_reach) return rebuild(surfaces, visit);
  for (const Group& g : groups_) {
    for (auto near = g.near.begin(); near != g.near.end() && near->distance <= g.moved; ++near) visit(near->pair);
  }
}

/// Visits the pairs of this motion, and lists those that are near at its end of surfaces that are slow.
void FeaturePairs::rebuild(const std::vector<MovingSurface>& surfaces, const Visit& visit) {
  bool is_any_slow = false;
  for (Group& g : groups_) {
    g.moved = 0;
    g.reach = g.may_meet && 2 * g.way < reach_ ? reach_ : 0;  // a list is to last
    g.near.clear();
    is_any_slow |= g.reach > 0;
  }
  const Visit visit_and_list = [&](const FeaturePair& pair) {
    visit(pair);
    Group& g = group(pair.surface, pair.other);
    if (g.reach == 0) return;
    const double distance = distance_at_end(surfaces, pair);
    if (distance <= g.reach) g.near.push_back({distance, pair});
  };
  const PairsOfTriangles visit_pairs_of(surfaces, visit_and_list);
  const double margin = is_any_slow ? 0.5 * reach_ + kRounding : 0;
  Sweep(moving_boxes(surfaces, margin)).for_each_pair([&](TriangleId a, TriangleId b) {
    if (group(a.surface, b.surface).may_meet) visit_pairs_of(a, b);
  });
  const auto is_nearer = [](const Near& p, const Near& q) { return p.distance < q.distance; };
  for (Group& g : groups_) std::sort(g.near.begin(), g.near.end(), is_nearer);
  reach_across_gaps(surfaces);
}

/// Surfaces that are far apart need no list until they have moved by what is between them.
void FeaturePairs::reach_across_gaps(const std::vector<MovingSurface>& surfaces) {
  std::vector<Bounds> bounds;
  for (const MovingSurface& surface : surfaces) bounds.push_back(bounds_of(surface.end));
  for (int a = 0; a < num_surfaces_; ++a) {
    for (int b = a + 1; b < num_surfaces_; ++b)
      group(a, b).reach = std::max(group(a, b).reach, gap_between(bounds[a], bounds[b]));
  }
}

}  // namespace weft::verify
