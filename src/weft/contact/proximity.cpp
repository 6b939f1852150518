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

/// If more than this share of the vertices have moved, all pairs are looked for anew.
constexpr double kManyMoved = 0.4;

/// What has used up more than this share of its slack is looked for anew together with what has left it.
constexpr double kSoon = 0.3;

/// No vertex may move farther against the rest than this many times the cloth's size [1].
constexpr double kMostOfSize = 10;

/// Of two neighbours' distance at rest, what contact may ask for.
constexpr float kShareOfRest = 0.5f;

constexpr int kFanGrain = 2048;  // pairs of triangles in a fan per chunk

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
  moved_.reserve(surface_.num_vertices);
  made_for_.end.clear();
}

void Proximity::let_pass(const std::vector<char>& passes) {
  if (passes == passes_) return;
  passes_ = passes;
  num_things_ = static_cast<std::size_t>(std::lround(std::sqrt(static_cast<double>(passes.size()))));
  made_for_.end.clear();
}

bool Proximity::pass(int triangle, int other) const {
  if (passes_.empty()) return false;
  return passes_[thing_of_triangle_[triangle] * num_things_ + thing_of_triangle_[other]] != 0;
}

void Proximity::update(const SurfaceMotion& motion, JobSystem& jobs) {
  if (made_for_.end.size() != motion.end.size() || motion.half_thickness != made_for_.half_thickness)
    return rebuild(motion, jobs);
  find_moved(motion);
  if (moved_.empty()) return;
  const bool are_many =
      static_cast<double>(moved_.size()) > kManyMoved * static_cast<double>(motion.end.size());
  if (are_many || slack_ != made_with_ || !renew(motion, jobs)) rebuild(motion, jobs);
}

/// What two features do in straight lines keeps their pair, as long as each corner stays within the slack of
/// where it was, at every time. Once one has left it, those that will soon do so count as well.
void Proximity::find_moved(const SurfaceMotion& motion) {
  moved_.clear();
  find_drift(motion);
  const auto is_within = [&](int v, double slack) {
    const double at_start_sq = (motion.start[v] - made_for_.start[v] - drift_at_start_).squaredNorm(),
                 at_end_sq = (motion.end[v] - made_for_.end[v] - drift_at_end_).squaredNorm();
    return (at_start_sq <= slack * slack) & (at_end_sq <= slack * slack);  // false for what is not a number
  };
  bool are_all_within = true;
  for (int v = 0; v < surface_.num_vertices; ++v) are_all_within &= is_within(v, made_with_);
  if (are_all_within) return;
  for (int v = 0; v < surface_.num_vertices; ++v) {
    if (!is_within(v, kSoon * made_with_)) moved_.push_back(v);
  }
}

/// What all cloth has moved in common.
void Proximity::find_drift(const SurfaceMotion& motion) {
  Vec3 at_start = Vec3::Zero(), at_end = Vec3::Zero();
  for (int v = 0; v < num_cloth_vertices_; ++v) {
    at_start += motion.start[v] - made_for_.start[v];
    at_end += motion.end[v] - made_for_.end[v];
  }
  const int count = std::max(1, num_cloth_vertices_);
  drift_at_start_ = at_start / count;
  drift_at_end_ = at_end / count;
}

/// Of the vertices in is_moved_ and the triangles in is_renewed_.
void Proximity::make_boxes(JobSystem& jobs) {
  constexpr int kGrain = 4096;
  vertex_box_.resize(surface_.num_vertices);
  triangle_box_.resize(surface_.triangles.size());
  parallel_for(jobs, surface_.num_vertices, kGrain, [&](int begin, int end) {
    for (int v = begin; v < end; ++v) {
      if (is_moved_[v]) vertex_box_[v] = box_of_vertex(v);
    }
  });
  parallel_for(jobs, static_cast<int>(surface_.triangles.size()), kGrain, [&](int begin, int end) {
    for (int t = begin; t < end; ++t) {
      if (!is_renewed_[t]) continue;
      const auto [i, j, k] = surface_.triangles[t];
      triangle_box_[t] = vertex_box_[i];
      triangle_box_[t].merge(vertex_box_[j]);
      triangle_box_[t].merge(vertex_box_[k]);
    }
  });
}

MovingAabb Proximity::box_of_vertex(int v) const {
  constexpr double kRounding = 1e-6;  // of sums of floats, relative to the size of what is looked at
  const Vec3 at = made_for_.start[v] - origin_, way = made_for_.end[v] - made_for_.start[v];
  const double margin = made_for_.half_thickness[v] + made_with_ + kRounding * (at.norm() + way.norm());
  return {make_aabb(at, at, margin), make_aabb(way, way)};
}

/// Over the triangles [begin, end).
void Proximity::fit_tree(AabbTree& tree, int begin, int end, JobSystem& jobs) {
  const auto box_of = [&](int item) { return triangle_box_[begin + item]; };
  if (tree.num_items() == end - begin) {
    tree.refit(box_of, jobs);
    if (tree.looseness() < kLoosest) return;
  }
  std::vector<Aabb> boxes;
  for (int t = begin; t < end; ++t) boxes.push_back(triangle_box_[t].box);
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
  made_for_ = motion;
  made_with_ = slack_;
  origin_ = motion.start[0];
  const int num_triangles = static_cast<int>(surface_.triangles.size());
  is_moved_.assign(surface_.num_vertices, 1);
  is_near_.assign(surface_.num_vertices, 1);
  is_renewed_.assign(num_triangles, 1);
  make_boxes(jobs);
  fit_tree(cloth_tree_, 0, num_cloth_triangles_, jobs);
  if (num_triangles > num_cloth_triangles_) fit_tree(body_tree_, num_cloth_triangles_, num_triangles, jobs);
  find_pairs(AabbTree::Extent::all, jobs);
}

/// The pairs of moved_ alone. False if the tree has become loose: all is to be looked for anew.
bool Proximity::renew(const SurfaceMotion& motion, JobSystem& jobs) {
  if (find_wildest(motion) >= 0) return false;
  mark_moved(motion);
  make_boxes(jobs);
  const int num_triangles = static_cast<int>(surface_.triangles.size());
  const auto fit = [&](AabbTree& tree, int begin, int end) {
    tree.mark(std::span(is_renewed_).subspan(begin, end - begin));
    tree.refit([&](int item) { return triangle_box_[begin + item]; }, jobs, AabbTree::Extent::marked);
    return tree.looseness() < kLoosest;
  };
  if (!fit(cloth_tree_, 0, num_cloth_triangles_)) return false;
  if (num_triangles > num_cloth_triangles_ && !fit(body_tree_, num_cloth_triangles_, num_triangles))
    return false;
  drop_pairs_of_moved();
  find_pairs(AabbTree::Extent::marked, jobs);
  return true;
}

/// … and where the lists now have them: where they would be had they not moved in common.
void Proximity::mark_moved(const SurfaceMotion& motion) {
  is_moved_.assign(surface_.num_vertices, 0);
  is_near_.assign(surface_.num_vertices, 0);
  is_renewed_.assign(surface_.triangles.size(), 0);
  for (const int v : moved_) {
    made_for_.start[v] = motion.start[v] - drift_at_start_;
    made_for_.end[v] = motion.end[v] - drift_at_end_;
    is_moved_[v] = 1;
    for (const int t : surface_.triangles_at(v)) {
      is_renewed_[t] = 1;
      for (const int w : surface_.triangles[t]) is_near_[w] = 1;
    }
  }
}

void Proximity::drop_pairs_of_moved() {
  const auto has_moved = [&](int edge) {
    const auto [i, j] = surface_.edges[edge];
    return is_moved_[i] || is_moved_[j];
  };
  std::erase_if(vertex_triangle_, [&](const FeaturePair& p) { return is_moved_[p.a] || is_renewed_[p.b]; });
  std::erase_if(edge_edge_, [&](const FeaturePair& p) { return has_moved(p.a) || has_moved(p.b); });
}

/// Of triangles of which one is in is_renewed_.
void Proximity::find_pairs(AabbTree::Extent extent, JobSystem& jobs) {
  const auto add_found = [&](int first, PairChunk& chunk) {
    for (const ItemPair& pair : chunk.triangles.pairs)
      add_pairs_of_triangles(pair.a, first + pair.b, false, chunk);
  };
  const auto add_within_cloth = [&](int part, PairChunk& chunk) {
    cloth_tree_.find_self_part(part, extent, chunk.triangles);
    add_found(0, chunk);
  };
  const auto add_on_bodies = [&](int part, PairChunk& chunk) {
    cloth_tree_.find_part(body_tree_, part, extent, chunk.triangles);
    add_found(num_cloth_triangles_, chunk);
  };
  const auto add_fan = [&](int p, PairChunk& chunk) {
    add_pairs_of_triangles(fans_[p].a, fans_[p].b, true, chunk);
  };
  add_pairs(cloth_tree_.num_self_parts(), 1, add_within_cloth, jobs);
  if (static_cast<int>(surface_.triangles.size()) > num_cloth_triangles_)
    add_pairs(cloth_tree_.num_parts_with(body_tree_), 1, add_on_bodies, jobs);
  find_fans(jobs);
  add_pairs(static_cast<int>(fans_.size()), kFanGrain, add_fan, jobs);
  // The tree's shape, and with it the order, depends on what came before; contact must not.
  put_in_order(surface_.num_vertices, vertex_triangle_);
  put_in_order(static_cast<int>(surface_.edges.size()), edge_edge_);
  measure_edges();
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
void Proximity::measure_edges() {
  double longest_sq = 0;
  for (const auto& [i, j] : surface_.edges) {
    if (i < num_cloth_vertices_)
      longest_sq = std::max(longest_sq, (made_for_.end[j] - made_for_.end[i]).squaredNorm());
  }
  longest_edge_ = std::sqrt(longest_sq) + 2 * made_with_;
}

/// What add(i, chunk) adds to a chunk for i from 0 to before `count`.
template <class Add>
void Proximity::add_pairs(int count, int grain, const Add& add, JobSystem& jobs) {
  const auto append = [](const std::vector<FeaturePair>& from, std::vector<FeaturePair>& to) {
    to.insert(to.end(), from.begin(), from.end());
  };
  collect_in_order(jobs, count, grain, chunks_, add, [&](const PairChunk& chunk) {
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

void Proximity::add_pairs_of_triangles(int first, int second, bool is_fan, PairChunk& chunk) const {
  if ((!is_renewed_[first] && !is_renewed_[second]) || pass(first, second)) return;
  const Surface::OwnedFeatures &a = surface_.owned[first], &b = surface_.owned[second];
  const Triangle &ta = surface_.triangles[first], &tb = surface_.triangles[second];
  for (const int v : a.vertex) {
    if (v >= 0 && !has_vertex(tb, v)) add_vertex_triangle(v, second, is_fan, chunk);
  }
  for (const int v : b.vertex) {
    if (v >= 0 && !has_vertex(ta, v)) add_vertex_triangle(v, first, is_fan, chunk);
  }
  std::array<MovingAabb, 3> box_b;
  for (int k = 0; k < 3; ++k) {
    if (b.edge[k] >= 0) box_b[k] = box_of_edge(b.edge[k]);
  }
  for (const int e : a.edge) {
    if (e < 0) continue;
    const MovingAabb box_e = box_of_edge(e);
    for (int k = 0; k < 3; ++k) {
      const int f = b.edge[k];
      if (f >= 0 && box_e.may_meet(box_b[k])) add_edge_edge(std::min(e, f), std::max(e, f), is_fan, chunk);
    }
  }
}

MovingAabb Proximity::box_of_edge(int edge) const {
  const auto [i, j] = surface_.edges[edge];
  MovingAabb box = vertex_box_[i];
  box.merge(vertex_box_[j]);
  return box;
}

/// How near two features must be at the start to become close during the step: a and b are their corners.
/// However far both move, only what they move against each other brings them nearer.
template <std::size_t kA, std::size_t kB>
double Proximity::reach_between(const std::array<int, kA>& a, const std::array<int, kB>& b) const {
  const SurfaceMotion& motion = made_for_;
  double travel_sq = 0;
  for (const int v : a) {
    const Vec3 way = motion.end[v] - motion.start[v];
    for (const int w : b)
      travel_sq = std::max(travel_sq, (way - (motion.end[w] - motion.start[w])).squaredNorm());
  }
  return motion.half_thickness[a[0]] + motion.half_thickness[b[0]] + 2 * made_with_ + std::sqrt(travel_sq);
}

/// distance(x) is that of the two features where vertices are at x. Neighbours on the mesh, in one fan, may
/// always come nearer than at rest.
template <class Distance>
void Proximity::add_pair(FeaturePair pair, double reach, bool is_fan, const Distance& distance,
                         std::vector<FeaturePair>& pairs) const {
  if (distance(made_for_.start).distance_sq > reach * reach) return;
  if (is_fan) pair.max_gap = kShareOfRest * static_cast<float>(distance(rest_).distance());
  pairs.push_back(pair);
}

void Proximity::add_vertex_triangle(int vertex, int triangle, bool is_fan, PairChunk& chunk) const {
  if (!vertex_box_[vertex].may_meet(triangle_box_[triangle])) return;
  const Triangle& t = surface_.triangles[triangle];
  const auto distance = [&](const std::vector<Vec3>& x) {
    return point_triangle_distance(x[vertex], x[t[0]], x[t[1]], x[t[2]]);
  };
  add_pair({vertex, triangle}, reach_between(std::array{vertex}, t), is_fan, distance, chunk.vertex_triangle);
}

void Proximity::add_edge_edge(int a, int b, bool is_fan, PairChunk& chunk) const {
  const std::array<int, 2>&e = surface_.edges[a], &f = surface_.edges[b];
  if (e[0] == f[0] || e[0] == f[1] || e[1] == f[0] || e[1] == f[1]) return;
  const auto distance = [&](const std::vector<Vec3>& x) {
    return edge_edge_distance(x[e[0]], x[e[1]], x[f[0]], x[f[1]]);
  };
  add_pair({a, b}, reach_between(e, f), is_fan, distance, chunk.edge_edge);
}

/// Of the triangles in is_renewed_, where vertices are at x.
void Proximity::find_fan_shapes(const std::vector<Vec3>& x, std::vector<FanShape>& shapes, JobSystem& jobs) {
  constexpr int kGrain = 2048;
  shapes.resize(num_cloth_triangles_);
  parallel_for(jobs, num_cloth_triangles_, kGrain, [&](int begin, int end) {
    for (int t = begin; t < end; ++t) {
      if (!is_renewed_[t]) continue;
      const auto [i, j, k] = surface_.triangles[t];
      const Vec3 area = (x[j] - x[i]).cross(x[k] - x[i]);
      const double longest_sq =
          std::max({(x[j] - x[i]).squaredNorm(), (x[k] - x[j]).squaredNorm(), (x[i] - x[k]).squaredNorm()});
      const double height = longest_sq > 0 ? area.norm() / std::sqrt(longest_sq) : 0.0;
      shapes[t] = {area.stableNormalized().cast<float>(), static_cast<float>(height)};
    }
  });
}

/// Whether the cloth makes a point there.
bool Proximity::is_sharp(int vertex, const std::vector<FanShape>& shapes) const {
  Eigen::Vector3f sum = Eigen::Vector3f::Zero();
  for (const int t : surface_.triangles_at(vertex)) sum += shapes[t].normal;
  const float length = sum.norm();
  for (const int t : surface_.triangles_at(vertex)) {
    const float facing = shapes[t].normal.dot(sum);
    const bool is_flat = facing >= kSharp * length && facing * shapes[t].height > 2 * made_with_ * length;
    if (!is_flat) return true;  // what is not a number either
  }
  return false;
}

/// Triangles that share a vertex or an edge are not reported by the tree. They matter only where the cloth
/// makes a point or a fold. Two that share an edge are found at both of its ends.
void Proximity::find_fans(JobSystem& jobs) {
  constexpr int kGrain = 2048;
  find_fan_shapes(made_for_.start, shape_at_start_, jobs);
  find_fan_shapes(made_for_.end, shape_at_end_, jobs);
  is_sharp_.resize(num_cloth_vertices_);
  parallel_for(jobs, num_cloth_vertices_, kGrain, [&](int begin, int end) {
    for (int v = begin; v < end; ++v) {
      if (is_near_[v]) is_sharp_[v] = is_sharp(v, shape_at_start_) || is_sharp(v, shape_at_end_);
    }
  });
  fans_.clear();
  for (int v = 0; v < num_cloth_vertices_; ++v) {
    if (!is_near_[v] || !is_sharp_[v]) continue;
    const std::span<const int> fan = surface_.triangles_at(v);
    for (std::size_t f = 0; f < fan.size(); ++f) {
      for (std::size_t g = f + 1; g < fan.size(); ++g) fans_.push_back({fan[f], fan[g]});
    }
  }
}

}  // namespace weft
