#include "weft/contact/proximity.h"

#include <cmath>

#include "weft/contact/collect.h"
#include "weft/geometry/distance.h"

namespace weft {
namespace {

/// A tree this much looser than when it was built is built anew.
constexpr double kLoosest = 1.6;

/// The triangles around a vertex are its neighbours on the mesh. As long as their normals are near to their
/// sum, seen along it they do not overlap, and nothing of them can come close: within 30° when lists are
/// made, and such that none can turn over while they are kept.
constexpr double kSharp = 0.87;

/// So few triangles may all be near to each other, as long as they do not fly off [m].
constexpr int kFewTriangles = 500;
constexpr double kFarthest = 100;

/// No vertex may move farther against the rest than this many times the cloth's size [1].
constexpr double kMostOfSize = 10;

/// Of two neighbours' distance at rest, what contact may ask for.
constexpr float kShareOfRest = 0.5f;

}  // namespace

void Proximity::reset(Surface surface, std::vector<Vec3> rest, int num_cloth_vertices,
                      int num_cloth_triangles, const Slack& slack) {
  surface_ = std::move(surface);
  rest_ = std::move(rest);
  num_cloth_vertices_ = num_cloth_vertices;
  num_cloth_triangles_ = num_cloth_triangles;
  slacks_ = slack;
  slack_ = slack.most;
  cloth_tree_ = body_tree_ = AabbTree();
  // Room for the pairs of calm cloth, so that steps need not ask for it.
  const std::size_t room = 4 * surface_.num_vertices;
  chunks_.resize(1);
  for (auto* pairs :
       {&vertex_triangle_, &edge_edge_, &ordered_, &chunks_[0].vertex_triangle, &chunks_[0].edge_edge})
    pairs->reserve(room);
  fans_.reserve(room);
  made_for_.end.clear();
}

void Proximity::update(const SurfaceMotion& motion, JobSystem& jobs) {
  if (still_holds(motion)) return;
  rebuild(motion, jobs);
}

/// Whatever two features do in straight lines, each corner stays within the slack of where it was in the
/// motion that the lists were made for, at every time.
bool Proximity::still_holds(const SurfaceMotion& motion) const {
  if (made_for_.end.size() != motion.end.size() || motion.half_thickness != made_for_.half_thickness)
    return false;
  return is_within_slack(motion.start, made_for_.start) && is_within_slack(motion.end, made_for_.end);
}

/// But for what all cloth has moved in common.
bool Proximity::is_within_slack(const std::vector<Vec3>& x, const std::vector<Vec3>& reference) const {
  Vec3 mean = Vec3::Zero();
  for (int v = 0; v < num_cloth_vertices_; ++v) mean += x[v] - reference[v];
  mean /= std::max(1, num_cloth_vertices_);
  double farthest_sq = 0;
  for (std::size_t v = 0; v < x.size(); ++v)
    farthest_sq = std::max(farthest_sq, (x[v] - reference[v] - mean).squaredNorm());
  return farthest_sq <= made_with_ * made_with_;
}

void Proximity::box_vertices(const SurfaceMotion& motion) {
  constexpr double kRounding = 1e-6;  // of sums of floats, relative to the size of what is looked at
  const std::size_t n = motion.start.size();
  vertex_box_.resize(n);
  const Vec3 origin = motion.start[0];
  for (std::size_t v = 0; v < n; ++v) {
    const Vec3 at = motion.start[v] - origin, way = motion.end[v] - motion.start[v];
    const double margin = motion.half_thickness[v] + slack_ + kRounding * (at.norm() + way.norm());
    vertex_box_[v] = {make_aabb(at, at, margin), make_aabb(way, way)};
  }
}

MovingAabb Proximity::box_of_triangle(int triangle) const {
  const Triangle& t = surface_.triangles[triangle];
  MovingAabb box = vertex_box_[t[0]];
  box.merge(vertex_box_[t[1]]);
  box.merge(vertex_box_[t[2]]);
  return box;
}

/// Over the triangles [begin, end).
void Proximity::fit_tree(AabbTree& tree, int begin, int end, JobSystem& jobs) {
  const auto box_of = [&](int item) { return box_of_triangle(begin + item); };
  if (tree.num_items() == end - begin) {
    tree.refit(box_of, jobs);
    if (tree.looseness() < kLoosest) return;
  }
  std::vector<Aabb> boxes;
  for (int t = begin; t < end; ++t) boxes.push_back(box_of_triangle(t).box);
  tree.build(boxes, {surface_.triangles.begin() + begin, surface_.triangles.begin() + end}, jobs);
  tree.refit(box_of, jobs);
}

/// -1 if cloth moves against itself by less than its own size on the average.
int Proximity::find_wildest(const SurfaceMotion& motion) const {
  if (num_cloth_vertices_ == 0) return -1;
  Vec3 low = motion.start[0], high = low, drift = Vec3::Zero();
  for (int v = 0; v < num_cloth_vertices_; ++v) drift += motion.end[v] - motion.start[v];
  drift /= num_cloth_vertices_;
  double sum = 0, farthest = 0;
  int wildest = 0;
  for (int v = 0; v < num_cloth_vertices_; ++v) {
    low = low.cwiseMin(motion.start[v]);
    high = high.cwiseMax(motion.start[v]);
    const double travel = (motion.end[v] - motion.start[v] - drift).norm();
    sum += travel;
    if (travel <= farthest) continue;
    farthest = travel;
    wildest = v;
  }
  const double size =
      num_cloth_triangles_ > kFewTriangles ? (high - low).norm() : std::max((high - low).norm(), kFarthest);
  return sum <= num_cloth_vertices_ * size && farthest <= kMostOfSize * size ? -1 : wildest;
}

void Proximity::rebuild(const SurfaceMotion& motion, JobSystem& jobs) {
  vertex_triangle_.clear();
  edge_edge_.clear();
  wildest_ = find_wildest(motion);
  if (wildest_ >= 0) return made_for_.end.clear();
  box_vertices(motion);
  const int num_triangles = static_cast<int>(surface_.triangles.size());
  fit_tree(cloth_tree_, 0, num_cloth_triangles_, jobs);
  cloth_tree_.find_self_pairs(jobs, search_);
  add_pairs(motion, search_.pairs, 0, false, jobs);
  find_fans(motion);
  add_pairs(motion, fans_, 0, true, jobs);
  if (num_triangles > num_cloth_triangles_) {
    fit_tree(body_tree_, num_cloth_triangles_, num_triangles, jobs);
    cloth_tree_.find_pairs(body_tree_, jobs, search_);
    add_pairs(motion, search_.pairs, num_cloth_triangles_, false, jobs);
  }
  // The tree's shape, and with it the order, depends on what came before; contact must not.
  put_in_order(surface_.num_vertices, vertex_triangle_);
  put_in_order(static_cast<int>(surface_.edges.size()), edge_edge_);
  measure_edges(motion);
  made_for_ = motion;
  made_with_ = slack_;
  choose_slack();
}

/// Where cloth lies in layers, each moment of keeping would cost many pairs more.
void Proximity::choose_slack() {
  constexpr std::size_t kMany = 20, kFew = 4;  // pairs per vertex
  const std::size_t pairs = vertex_triangle_.size() + edge_edge_.size(), n = num_cloth_vertices_;
  if (pairs > kMany * n) slack_ = slacks_.least;
  if (pairs < kFew * n) slack_ = slacks_.most;
}

/// Each end may move by the slack before this is done again.
void Proximity::measure_edges(const SurfaceMotion& motion) {
  double longest_sq = 0;
  for (const auto& [i, j] : surface_.edges) {
    if (i < num_cloth_vertices_)
      longest_sq = std::max(longest_sq, (motion.end[j] - motion.end[i]).squaredNorm());
  }
  longest_edge_ = std::sqrt(longest_sq) + 2 * slack_;
}

/// Of all these pairs of triangles, the second one counted from `first`.
void Proximity::add_pairs(const SurfaceMotion& motion, const std::vector<ItemPair>& triangles, int first,
                          bool is_fan, JobSystem& jobs) {
  constexpr int kGrain = 2048;
  const auto append = [](const std::vector<FeaturePair>& from, std::vector<FeaturePair>& to) {
    to.insert(to.end(), from.begin(), from.end());
  };
  collect_in_order(
      jobs, static_cast<int>(triangles.size()), kGrain, chunks_,
      [&](int p, PairChunk& chunk) {
        add_pairs_of_triangles(motion, {triangles[p].a, triangles[p].b + first}, is_fan, chunk);
      },
      [&](const PairChunk& chunk) {
        append(chunk.vertex_triangle, vertex_triangle_);
        append(chunk.edge_edge, edge_edge_);
      });
}

/// By a, then by b, each once; a is below `end_of_a`.
void Proximity::put_in_order(int end_of_a, std::vector<FeaturePair>& pairs) {
  begin_of_a_.assign(end_of_a + 1, 0);
  for (const FeaturePair& p : pairs) ++begin_of_a_[p.a + 1];
  for (int a = 0; a < end_of_a; ++a) begin_of_a_[a + 1] += begin_of_a_[a];
  ordered_.resize(pairs.size());
  std::vector<int>& next = begin_of_a_;
  for (const FeaturePair& p : pairs) ordered_[next[p.a]++] = p;
  // Now next[a] is where a's pairs end.
  pairs.clear();
  for (int a = 0; a < end_of_a; ++a) {
    const auto begin = ordered_.begin() + (a > 0 ? next[a - 1] : 0), end = ordered_.begin() + next[a];
    std::sort(begin, end, [](const FeaturePair& x, const FeaturePair& y) { return x.b < y.b; });
    for (auto p = begin; p != end; ++p) {
      if (p == begin || p->b != (p - 1)->b) pairs.push_back(*p);
    }
  }
}

void Proximity::add_pairs_of_triangles(const SurfaceMotion& motion, const ItemPair& pair, bool is_fan,
                                       PairChunk& chunk) const {
  const Surface::OwnedFeatures &a = surface_.owned[pair.a], &b = surface_.owned[pair.b];
  const Triangle &ta = surface_.triangles[pair.a], &tb = surface_.triangles[pair.b];
  for (const int v : a.vertex) {
    if (v >= 0 && !has_vertex(tb, v)) add_vertex_triangle(motion, v, pair.b, is_fan, chunk);
  }
  for (const int v : b.vertex) {
    if (v >= 0 && !has_vertex(ta, v)) add_vertex_triangle(motion, v, pair.a, is_fan, chunk);
  }
  for (const int e : a.edge) {
    for (const int f : b.edge) {
      if (e >= 0 && f >= 0) add_edge_edge(motion, std::min(e, f), std::max(e, f), is_fan, chunk);
    }
  }
}

/// How near two features must be at the start to become close during the step: a and b are their corners.
/// However far both move, only what they move against each other brings them nearer.
template <std::size_t kA, std::size_t kB>
double Proximity::reach_between(const SurfaceMotion& motion, const std::array<int, kA>& a,
                                const std::array<int, kB>& b) const {
  double travel_sq = 0;
  for (const int v : a) {
    const Vec3 way = motion.end[v] - motion.start[v];
    for (const int w : b)
      travel_sq = std::max(travel_sq, (way - (motion.end[w] - motion.start[w])).squaredNorm());
  }
  return motion.half_thickness[a[0]] + motion.half_thickness[b[0]] + 2 * slack_ + std::sqrt(travel_sq);
}

/// distance(x) is that of the two features where vertices are at x. Neighbours on the mesh, in one fan, may
/// always come nearer than at rest.
template <class Distance>
void Proximity::add_pair(const SurfaceMotion& motion, FeaturePair pair, double reach, bool is_fan,
                         const Distance& distance, std::vector<FeaturePair>& pairs) const {
  if (distance(motion.start).distance_sq > reach * reach) return;
  if (is_fan) pair.max_gap = kShareOfRest * static_cast<float>(distance(rest_).distance());
  pairs.push_back(pair);
}

void Proximity::add_vertex_triangle(const SurfaceMotion& motion, int vertex, int triangle, bool is_fan,
                                    PairChunk& chunk) const {
  if (!vertex_box_[vertex].may_meet(box_of_triangle(triangle))) return;
  const Triangle& t = surface_.triangles[triangle];
  const auto distance = [&](const std::vector<Vec3>& x) {
    return point_triangle_distance(x[vertex], x[t[0]], x[t[1]], x[t[2]]);
  };
  const double reach = reach_between(motion, std::array{vertex}, t);
  add_pair(motion, {vertex, triangle}, reach, is_fan, distance, chunk.vertex_triangle);
}

void Proximity::add_edge_edge(const SurfaceMotion& motion, int a, int b, bool is_fan,
                              PairChunk& chunk) const {
  const std::array<int, 2>&e = surface_.edges[a], &f = surface_.edges[b];
  if (e[0] == f[0] || e[0] == f[1] || e[1] == f[0] || e[1] == f[1]) return;
  MovingAabb box_a = vertex_box_[e[0]], box_b = vertex_box_[f[0]];
  box_a.merge(vertex_box_[e[1]]);
  box_b.merge(vertex_box_[f[1]]);
  if (!box_a.may_meet(box_b)) return;
  const auto distance = [&](const std::vector<Vec3>& x) {
    return edge_edge_distance(x[e[0]], x[e[1]], x[f[0]], x[f[1]]);
  };
  add_pair(motion, {a, b}, reach_between(motion, e, f), is_fan, distance, chunk.edge_edge);
}

/// Marks the vertices at which the cloth makes a point, where it is at x.
void Proximity::mark_sharp(const std::vector<Vec3>& x) {
  fan_shape_.resize(num_cloth_triangles_);
  for (int t = 0; t < num_cloth_triangles_; ++t) {
    const auto [i, j, k] = surface_.triangles[t];
    const Vec3 area = (x[j] - x[i]).cross(x[k] - x[i]);
    const double longest_sq =
        std::max({(x[j] - x[i]).squaredNorm(), (x[k] - x[j]).squaredNorm(), (x[i] - x[k]).squaredNorm()});
    fan_shape_[t] = {area.stableNormalized(), longest_sq > 0 ? area.norm() / std::sqrt(longest_sq) : 0.0};
  }
  for (int v = 0; v < num_cloth_vertices_; ++v) {
    Vec3 sum = Vec3::Zero();
    for (const int t : surface_.triangles_at(v)) sum += fan_shape_[t].normal;
    const double length = sum.norm();
    for (const int t : surface_.triangles_at(v)) {
      const FanShape& shape = fan_shape_[t];
      const double facing = shape.normal.dot(sum);
      if (!(facing >= kSharp * length && facing * shape.height > 2 * slack_ * length)) is_sharp_[v] = 1;
    }
  }
}

/// Triangles that share a vertex or an edge are not reported by the tree. They matter only where the cloth
/// makes a point or a fold. Two that share an edge are found at both of its ends.
void Proximity::find_fans(const SurfaceMotion& motion) {
  fans_.clear();
  is_sharp_.assign(num_cloth_vertices_, 0);
  mark_sharp(motion.start);
  mark_sharp(motion.end);
  for (int v = 0; v < num_cloth_vertices_; ++v) {
    if (!is_sharp_[v]) continue;
    const std::span<const int> fan = surface_.triangles_at(v);
    for (std::size_t f = 0; f < fan.size(); ++f) {
      for (std::size_t g = f + 1; g < fan.size(); ++g) fans_.push_back({fan[f], fan[g]});
    }
  }
}

}  // namespace weft
