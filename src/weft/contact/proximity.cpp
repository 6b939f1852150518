#include "weft/contact/proximity.h"

#include <cmath>

#include "weft/contact/collect.h"

namespace weft::engine {
namespace {

/// A tree that is this much looser than after its build is rebuilt.
constexpr double kLoosest = 1.6;

/// The triangles of a one-ring are mesh neighbours. While their normals are near to their sum, they do not
/// overlap seen along it, and cannot come close: within 30° when lists are made, and such that none can turn
/// over while the lists are valid.
constexpr float kSharp = 0.87f;

/// Up to this many triangles may all be near to each other, unless they fly off [m].
constexpr int kFewTriangles = 500;
constexpr double kFarthest = 100;

/// If more than this share of the vertices moved, all pairs are searched again.
constexpr double kManyMoved = 0.4;

/// Vertices that used more than this share of their slack are searched again with those that exceeded it.
constexpr double kSoon = 0.3;

/// Limit of a vertex's motion relative to the others, in cloth sizes [1].
constexpr double kMaxRelativeMotion = 10;

/// The share of two neighbours' rest distance that contact may require.
constexpr float kShareOfRest = 0.5f;

constexpr int kOneRingGrain = 2048;  // triangle pairs of a one-ring per chunk

}  // namespace

void Proximity::reset(Surface surface, Patches patches, std::vector<Vec3> rest, int num_cloth_vertices,
                      int num_cloth_triangles, const Slack& slack) {
  surface_ = std::move(surface);
  patches_ = std::move(patches);
  rest_ = std::move(rest);
  num_cloth_vertices_ = num_cloth_vertices;
  num_cloth_triangles_ = num_cloth_triangles;
  slacks_ = slack;
  slack_ = slack.most;
  cloth_tree_ = body_tree_ = AabbTree();
  // Reserve for the pairs of calm cloth, so that steps do not allocate.
  const std::size_t room = 4 * surface_.num_vertices;
  constexpr std::size_t kChunks = 4;  // filled by one thread at a time
  chunks_.resize(kChunks);
  for (auto* pairs : {&vertex_triangle_, &edge_edge_, &ordered_}) pairs->reserve(room);
  for (PairChunk& chunk : chunks_) {
    chunk.vertex_triangle.reserve(room / kChunks);
    chunk.edge_edge.reserve(room / kChunks);
  }
  one_ring_pairs_.reserve(room);
  moved_.reserve(surface_.num_vertices);
  const std::size_t patch_room = 32 * patches_.size();
  near_patches_.reserve(patch_room);
  folded_pairs_.reserve(patch_room);
  patch_pairs_.reserve(patch_room);
  patch_pairs_before_.reserve(patch_room);
  parts_.resize(1);
  parts_[0].pairs.reserve(patch_room);
  parts_[0].leaf_pairs.reserve(patch_room);
  triangle_box_.resize(surface_.triangles.size());
  is_searched_.reserve(patches_.size());
  tight_for_.clear();
  made_for_.end.clear();
}

/// From the lists of cloths that lie at rest side by side along x, with all colliders beyond the last one.
void Proximity::find_tight(const std::vector<double>& half_thickness, JobSystem& jobs) {
  tight_for_ = half_thickness;
  is_tight_.assign(surface_.num_vertices, 0);
  if (num_cloth_vertices_ == 0) return;
  const double thickest = *std::max_element(half_thickness.begin(), half_thickness.end());
  const double room = 4 * (thickest + slacks_.most);
  std::vector<double> low, high;  // (cloths)
  for (int v = 0; v < num_cloth_vertices_; ++v) {
    const std::size_t body = body_of(v);
    if (body >= low.size()) {
      low.resize(body + 1, std::numeric_limits<double>::infinity());
      high.resize(body + 1, -low[body]);
    }
    low[body] = std::min(low[body], rest_[v].x());
    high[body] = std::max(high[body], rest_[v].x());
  }
  std::vector<double> shift;  // (cloths)
  double end = 0;
  for (std::size_t body = 0; body < low.size(); ++body) {
    shift.push_back(end - low[body]);
    end += high[body] - low[body] + room;
  }
  SurfaceMotion rest{.start = rest_, .end = {}, .half_thickness = half_thickness};
  for (int v = 0; v < num_cloth_vertices_; ++v) rest.start[v].x() += shift[body_of(v)];
  rest.start.resize(surface_.num_vertices, Vec3(end, 0, 0));
  rest.end = rest.start;
  rebuild(rest, jobs);
  const auto mark = [&](double distance, std::span<const int> a, std::span<const int> b) {
    if (distance >= half_thickness[a[0]] + half_thickness[b[0]]) return;
    for (const std::span<const int> feature : {a, b}) {
      for (const int v : feature) is_tight_[v] = 1;
    }
  };
  for (const FeaturePair& p : vertex_triangle_)
    mark(distance_to_triangle(p, rest.start).distance(), {&p.a, 1}, surface_.triangles[p.b]);
  for (const FeaturePair& p : edge_edge_)
    mark(distance_of_edges(p, rest.start).distance(), surface_.edges[p.a], surface_.edges[p.b]);
  slack_ = slacks_.most;
  num_calm_ = 0;
}

/// The body of a cloth vertex; vertices of no triangle collide with none.
int Proximity::body_of(int vertex) const {
  const std::span<const int> one_ring = surface_.triangles_at(vertex);
  return one_ring.empty() || body_of_triangle_.empty() ? 0 : body_of_triangle_[one_ring[0]];
}

void Proximity::set_non_colliding(const std::vector<char>& non_colliding) {
  if (non_colliding == non_colliding_) return;
  non_colliding_ = non_colliding;
  num_bodies_ = static_cast<std::size_t>(std::lround(std::sqrt(static_cast<double>(non_colliding.size()))));
  tight_for_.clear();
  made_for_.end.clear();
}

bool Proximity::is_non_colliding(int triangle, int other) const {
  if (non_colliding_.empty()) return false;
  return non_colliding_[body_of_triangle_[triangle] * num_bodies_ + body_of_triangle_[other]] != 0;
}

void Proximity::update(const SurfaceMotion& motion, JobSystem& jobs) {
  const WorkScope scope(clock_, &WorkTimes::lists);
  if (made_for_.end.size() != motion.end.size() || motion.half_thickness != made_for_.half_thickness) {
    if (tight_for_ != motion.half_thickness) find_tight(motion.half_thickness, jobs);
    rebuild(motion, jobs);
  } else {
    find_moved(motion);
    if (moved_.empty()) return;
    const bool are_many =
        static_cast<double>(moved_.size()) > kManyMoved * static_cast<double>(motion.end.size());
    if (are_many || is_among_ || slack_ != made_with_ || !renew(motion, jobs)) rebuild(motion, jobs);
  }
  while (diverged_vertex_ < 0 && slack_ < made_with_) rebuild(motion, jobs);
  if (clock_) ++clock_->times.list_renewals;
}

/// A pair stays valid while each corner, moving in straight lines, is at every time within the slack of its
/// position at the last search. Once a vertex has left it, those that will soon do so count as well.
void Proximity::find_moved(const SurfaceMotion& motion) {
  moved_.clear();
  find_drift(motion);
  const auto is_within = [&](int v, double slack) {
    const double at_start_sq = (motion.start[v] - made_for_.start[v] - drift_at_start_).squaredNorm(),
                 at_end_sq = (motion.end[v] - made_for_.end[v] - drift_at_end_).squaredNorm();
    return (at_start_sq <= slack * slack) & (at_end_sq <= slack * slack);  // false for NaN
  };
  constexpr int kBlock = 256;  // no branch per vertex
  bool are_all_within = true;
  for (int begin = 0; begin < surface_.num_vertices && are_all_within; begin += kBlock) {
    const int end = std::min(begin + kBlock, surface_.num_vertices);
    for (int v = begin; v < end; ++v) are_all_within &= is_within(v, made_with_);
  }
  if (are_all_within) return;
  for (int v = 0; v < surface_.num_vertices; ++v) {
    if (!is_within(v, kSoon * made_with_)) moved_.push_back(v);
  }
}

/// The common displacement of all cloth.
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

/// Measures the vertices in is_moved_, and the patches in is_renewed_patch_.
void Proximity::measure_patches(JobSystem& jobs) {
  constexpr int kGrain = 4096, kPatchGrain = 512;
  const auto num_vertices = static_cast<std::size_t>(surface_.num_vertices);
  for (Moment* moment : {&at_start_, &at_end_}) {
    moment->x.resize(num_vertices);
    moment->patches.resize(patches_.num_cloth());
  }
  patch_box_.resize(patches_.size());
  constexpr float kRounding = 2e-6f;  // of float sums, relative to the measured size
  margin_.resize(num_vertices);
  parallel_for(jobs, surface_.num_vertices, kGrain, [&](int begin, int end) {
    for (int v = begin; v < end; ++v) {
      if (!is_moved_[v]) continue;
      const Float4 start = to_float4(made_for_.start[v] - origin_),
                   last = to_float4(made_for_.end[v] - origin_);
      at_start_.x[v] = start;
      at_end_.x[v] = last;
      const float size = std::max(start.cwiseAbs().maxCoeff(), last.cwiseAbs().maxCoeff());
      margin_[v] = static_cast<float>(made_for_.half_thickness[v] + made_with_) + kRounding * size;
    }
  });
  parallel_for(jobs, patches_.size(), kPatchGrain, [&](int begin, int end) {
    for (int p = begin; p < end; ++p) {
      if (!is_renewed_patch_[p]) continue;
      patch_box_[p] = box_of(patches_.vertices(p));
      if (p >= patches_.num_cloth()) continue;
      at_start_.patches[p] = patches_.measure(p, at_start_.x);
      at_end_.patches[p] = patches_.measure(p, at_end_.x);
    }
  });
}

/// Neighbours that no window excludes, of the windows that have changed.
void Proximity::find_folded() {
  is_flat_.resize(patches_.num_windows());
  for (int w = 0; w < patches_.num_windows(); ++w) {
    bool has_changed = false;
    float margin = 0;
    for (const int p : patches_.members(w)) {
      has_changed |= is_renewed_patch_[p] != 0;
      margin = std::max(margin, margin_[patches_.vertices(p)[0]]);
    }
    if (has_changed)
      is_flat_[w] = patches_.least_distance(w, at_start_.patches, at_end_.patches) > 2 * margin;
  }
  is_folded_.assign(patches_.num_cloth(), 0);
  folded_pairs_.clear();
  for (const Patches::Neighbours& pair : patches_.neighbours()) {
    bool is_folded = true;
    for (int n = pair.first_window; n < pair.end_window; ++n)
      is_folded = is_folded && !is_flat_[patches_.window(n)];
    if (!is_folded) continue;
    is_folded_[pair.a] = is_folded_[pair.b] = 1;
    folded_pairs_.push_back({pair.a, pair.b});
  }
}

SweptBox Proximity::box_of(std::span<const int> vertices) const {
  SweptBox box;
  for (const int v : vertices) {
    const Float4 &x = at_start_.x[v], way = at_end_.x[v] - x;
    const Float4 margin = Float4::Constant(margin_[v]);
    box.min = box.min.cwiseMin(x - margin);
    box.max = box.max.cwiseMax(x + margin);
    box.way_min = box.way_min.cwiseMin(way);
    box.way_max = box.way_max.cwiseMax(way);
  }
  return box;
}

/// Builds over the patches [begin, end).
void Proximity::build_tree(AabbTree& tree, int begin, int end, JobSystem& jobs) {
  std::vector<Aabb> boxes;
  for (int p = begin; p < end; ++p) boxes.push_back(patch_box_[p].to_aabb().box);
  tree.build(boxes, {}, jobs);
}

/// Returns false if the tree has become loose.
bool Proximity::refit_tree(AabbTree& tree, int begin, AabbTree::Extent extent, JobSystem& jobs) {
  if (extent == AabbTree::Extent::marked)
    tree.mark(std::span(is_renewed_patch_).subspan(begin, tree.num_items()));
  tree.refit([&](int item) { return patch_box_[begin + item].to_aabb(); }, jobs, extent);
  return tree.looseness() < kLoosest;
}

/// Returns -1 if cloth moves against itself by less than its own size on average.
int Proximity::find_diverged_vertex(const SurfaceMotion& motion) const {
  if (num_cloth_vertices_ == 0) return -1;
  Vec3 low = motion.start[0], high = low, least = motion.end[0] - low, most = least;
  for (int v = 0; v < num_cloth_vertices_; ++v) {
    const Vec3 way = motion.end[v] - motion.start[v];
    low = low.cwiseMin(motion.start[v]);
    high = high.cwiseMax(motion.start[v]);
    least = least.cwiseMin(way);
    most = most.cwiseMax(way);
  }
  if ((most - least).norm() <= (high - low).norm()) return -1;
  Vec3 drift = Vec3::Zero();
  for (int v = 0; v < num_cloth_vertices_; ++v) drift += motion.end[v] - motion.start[v];
  drift /= num_cloth_vertices_;
  double sum = 0, farthest = 0;
  int fastest = 0;
  for (int v = 0; v < num_cloth_vertices_; ++v) {
    const double travel = (motion.end[v] - motion.start[v] - drift).norm();
    sum += travel;
    if (travel <= farthest) continue;
    farthest = travel;
    fastest = v;
  }
  const double size =
      num_cloth_triangles_ > kFewTriangles ? (high - low).norm() : std::max((high - low).norm(), kFarthest);
  return sum <= num_cloth_vertices_ * size && farthest <= kMaxRelativeMotion * size ? -1 : fastest;
}

void Proximity::rebuild(const SurfaceMotion& motion, JobSystem& jobs) {
  vertex_triangle_.clear();
  edge_edge_.clear();
  patch_pairs_.clear();
  is_among_ = false;
  diverged_vertex_ = find_diverged_vertex(motion);
  if (diverged_vertex_ >= 0) return made_for_.end.clear();
  made_for_ = motion;
  made_with_ = slack_;
  origin_ = motion.start[0];
  is_moved_.assign(surface_.num_vertices, 1);
  is_near_.assign(surface_.num_vertices, 1);
  is_renewed_.assign(surface_.triangles.size(), 1);
  is_renewed_patch_.assign(patches_.size(), 1);
  measure_patches(jobs);
  const auto fit = [&](AabbTree& tree, int begin, int end) {
    if (tree.num_items() == end - begin && refit_tree(tree, begin, AabbTree::Extent::all, jobs)) return;
    build_tree(tree, begin, end, jobs);
    refit_tree(tree, begin, AabbTree::Extent::all, jobs);
  };
  fit(cloth_tree_, 0, patches_.num_cloth());
  if (has_bodies()) fit(body_tree_, patches_.num_cloth(), patches_.size());
  find_folded();
  find_near_patches(AabbTree::Extent::all, jobs);
  find_pairs(jobs);
}

void Proximity::update_among(const SurfaceMotion& motion, std::span<const ItemPair> patch_pairs, double slack,
                             JobSystem& jobs) {
  const WorkScope scope(clock_, &WorkTimes::lists);
  if (tight_for_ != motion.half_thickness) find_tight(motion.half_thickness, jobs);
  vertex_triangle_.clear();
  edge_edge_.clear();
  patch_pairs_.clear();
  diverged_vertex_ = -1;
  is_among_ = true;
  made_for_ = motion;
  made_with_ = slack;
  origin_ = motion.start[0];
  mark_patches(patch_pairs);
  measure_patches(jobs);
  is_folded_.assign(patches_.num_cloth(), 0);
  for (const auto& [a, b] : patch_pairs) {
    const bool are_neighbours = patches_.are_neighbours(a, b);
    if (are_neighbours) is_folded_[a] = is_folded_[b] = 1;
    if (are_neighbours || patch_box_[a].may_meet(patch_box_[b]))
      patch_pairs_.push_back({a, b, are_neighbours});
  }
  std::sort(patch_pairs_.begin(), patch_pairs_.end());
  find_pairs(jobs);
  if (clock_) ++clock_->times.list_renewals;
}

/// Marks the patches to measure, and the vertices around them.
void Proximity::mark_patches(std::span<const ItemPair> patch_pairs) {
  is_moved_.assign(surface_.num_vertices, 0);
  is_near_.assign(surface_.num_vertices, 0);
  is_renewed_.assign(surface_.triangles.size(), 0);
  is_renewed_patch_.assign(patches_.size(), 0);
  for (const auto& [a, b] : patch_pairs) is_renewed_patch_[a] = is_renewed_patch_[b] = 1;
  for (int p = 0; p < patches_.num_cloth(); ++p) {
    if (!is_renewed_patch_[p]) continue;
    for (const int v : patches_.vertices(p)) {
      is_near_[v] = 1;
      for (const int t : surface_.triangles_at(v)) {
        for (const int w : surface_.triangles[t]) is_moved_[w] = 1;
      }
    }
  }
}

/// Searches only the pairs of moved_. Returns false if the tree has become loose: all pairs are searched.
bool Proximity::renew(const SurfaceMotion& motion, JobSystem& jobs) {
  if (find_diverged_vertex(motion) >= 0) return false;
  mark_moved(motion);
  measure_patches(jobs);
  if (!refit_tree(cloth_tree_, 0, AabbTree::Extent::marked, jobs)) return false;
  if (has_bodies() && !refit_tree(body_tree_, patches_.num_cloth(), AabbTree::Extent::marked, jobs))
    return false;
  find_folded();
  drop_pairs_of_moved();
  find_near_patches(AabbTree::Extent::marked, jobs);
  find_pairs(jobs);
  return true;
}

/// … and stores their new positions in the lists, less the common drift.
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
  for (int p = 0; p < patches_.size(); ++p) {
    const std::span<const int> vertices = patches_.vertices(p);
    is_renewed_patch_[p] =
        std::any_of(vertices.begin(), vertices.end(), [&](int v) { return is_moved_[v] != 0; });
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

/// The pairs of patches that may meet: pairs with a changed patch are searched, the others are kept.
void Proximity::find_near_patches(AabbTree::Extent extent, JobSystem& jobs) {
  near_patches_.clear();
  const int num_cloth = patches_.num_cloth();
  const auto search = [&](int count, int first_of_b, const auto& find) {
    collect_in_order(jobs, count, 1, parts_, find, [&](const PairPart& part) {
      for (const ItemPair& pair : part.pairs) near_patches_.push_back({pair.a, first_of_b + pair.b});
    });
  };
  search(cloth_tree_.num_self_parts(), 0,
         [&](int part, PairPart& found) { cloth_tree_.find_self_part(part, extent, found); });
  if (has_bodies()) {
    search(cloth_tree_.num_parts_with(body_tree_), num_cloth,
           [&](int part, PairPart& found) { cloth_tree_.find_part(body_tree_, part, extent, found); });
  }

  patch_pairs_.swap(patch_pairs_before_);
  patch_pairs_.clear();
  const auto has_changed = [&](int a, int b) { return is_renewed_patch_[a] || is_renewed_patch_[b]; };
  for (const PatchPair& pair : patch_pairs_before_) {
    if (!pair.are_neighbours && !has_changed(pair.a, pair.b)) patch_pairs_.push_back(pair);
  }
  for (const auto& [a, b] : near_patches_) {
    if (has_changed(a, b) && !patches_.are_neighbours(a, b)) patch_pairs_.push_back({a, b});
  }
  for (const auto& [a, b] : folded_pairs_) patch_pairs_.push_back({a, b, true});
  std::sort(patch_pairs_.begin(), patch_pairs_.end());
  auto before = patch_pairs_before_.begin();
  for (PatchPair& pair : patch_pairs_) {
    while (before != patch_pairs_before_.end() && *before < pair) ++before;
    pair.is_new = before == patch_pairs_before_.end() || *before != pair;
    if (!pair.is_new || !pair.are_neighbours) continue;
    for (const int p : {pair.a, pair.b}) {
      for (const int v : patches_.vertices(p)) is_near_[v] = 1;
    }
  }
}

/// Boxes of the triangles that may meet others.
void Proximity::measure_triangles(JobSystem& jobs) {
  constexpr int kGrain = 256;
  is_searched_.assign(patches_.size(), 0);
  for (const PatchPair& pair : patch_pairs_) {
    if (pair.is_new || is_renewed_patch_[pair.a] || is_renewed_patch_[pair.b])
      is_searched_[pair.a] = is_searched_[pair.b] = 1;
  }
  triangle_box_.resize(surface_.triangles.size());
  parallel_for(jobs, patches_.size(), kGrain, [&](int begin, int end) {
    for (int p = begin; p < end; ++p) {
      if (!is_searched_[p]) continue;
      for (const int t : patches_.triangles(p)) triangle_box_[t] = box_of(surface_.triangles[t]);
    }
  });
}

/// Searches patch pairs that are new, and triangle pairs with one in is_renewed_.
void Proximity::find_pairs(JobSystem& jobs) {
  constexpr int kGrain = 16;
  longest_edge_.reset();
  if (!patch_pairs_.empty()) measure_triangles(jobs);
  const auto add_near = [&](int p, PairChunk& chunk) { add_pairs_of_patches(patch_pairs_[p], chunk); };
  const auto add_one_ring_pair = [&](int p, PairChunk& chunk) {
    const auto [a, b] = one_ring_pairs_[p];
    add_pairs_of_triangles(a, b, box_of(surface_.triangles[a]), box_of(surface_.triangles[b]), true, chunk);
  };
  add_pairs(static_cast<int>(patch_pairs_.size()), kGrain, add_near, jobs);
  find_one_ring_pairs(jobs);
  add_pairs(static_cast<int>(one_ring_pairs_.size()), kOneRingGrain, add_one_ring_pair, jobs);
  // The shape of the tree, and so the order, depends on earlier steps; contact must not.
  put_in_order(surface_.num_vertices, vertex_triangle_);
  put_in_order(static_cast<int>(surface_.edges.size()), edge_edge_);
  choose_slack();
}

/// The slack is halved where many pairs are listed, because each is tested several times a step. It is
/// doubled again after several searches with few.
void Proximity::choose_slack() {
  constexpr int kCalm = 8;                    // searches that have found few pairs
  constexpr std::size_t kMany = 6, kFew = 1;  // pairs per vertex
  const std::size_t pairs = vertex_triangle_.size() + edge_edge_.size(), n = num_cloth_vertices_;
  num_calm_ = pairs < kFew * n ? num_calm_ + 1 : 0;
  if (pairs > kMany * n) slack_ = std::max(slacks_.least, slack_ / 2);
  if (num_calm_ < kCalm) return;
  num_calm_ = 0;
  slack_ = std::min(slacks_.most, 2 * slack_);
}

/// Each end may move by the slack before edges are searched again.
double Proximity::longest_edge() {
  if (longest_edge_) return *longest_edge_;
  if (diverged_vertex_ >= 0) return std::numeric_limits<double>::infinity();
  double longest_sq = 0;
  for (const auto& [i, j] : surface_.edges) {
    if (i >= num_cloth_vertices_) break;
    longest_sq = std::max(longest_sq, (made_for_.end[j] - made_for_.end[i]).squaredNorm());
  }
  longest_edge_ = std::sqrt(longest_sq) + 2 * made_with_;
  return *longest_edge_;
}

/// Collects the pairs that add(i, chunk) appends to a chunk, for i in [0, count).
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

/// Sorts by a, then by b, and removes duplicates; a is below `end_of_a`.
void Proximity::put_in_order(int end_of_a, std::vector<FeaturePair>& pairs) {
  if (pairs.empty()) return;
  begin_of_a_.assign(end_of_a + 1, 0);
  for (const FeaturePair& p : pairs) ++begin_of_a_[p.a + 1];
  for (int a = 0; a < end_of_a; ++a) begin_of_a_[a + 1] += begin_of_a_[a];
  ordered_.resize(pairs.size());
  std::vector<int>& next = begin_of_a_;
  for (const FeaturePair& p : pairs) ordered_[next[p.a]++] = p;
  // Now next[a] is the end of a's pairs.
  pairs.clear();
  for (int a = 0; a < end_of_a; ++a) {
    const auto begin = ordered_.begin() + (a > 0 ? next[a - 1] : 0), end = ordered_.begin() + next[a];
    std::sort(begin, end, [](const FeaturePair& x, const FeaturePair& y) { return x.b < y.b; });
    for (auto p = begin; p != end; ++p) {
      if (p == begin || p->b != (p - 1)->b) pairs.push_back(*p);
    }
  }
}

void Proximity::add_pairs_of_patches(const PatchPair& pair, PairChunk& chunk) const {
  if (!pair.is_new && !is_renewed_patch_[pair.a] && !is_renewed_patch_[pair.b]) return;
  const std::span<const int> first = patches_.triangles(pair.a), second = patches_.triangles(pair.b);
  std::array<int, Patches::kMaxTriangles> near{};  // triangles of the second patch that may meet the first
  std::size_t num_near = 0;
  for (const int t : second) {
    if (patch_box_[pair.a].may_meet(triangle_box_[t])) near[num_near++] = t;
  }
  for (std::size_t m = 0; m < first.size(); ++m) {
    const int s = first[m];
    const SweptBox& box = triangle_box_[s];
    if (!patch_box_[pair.b].may_meet(box)) continue;
    for (std::size_t n = pair.a == pair.b ? m + 1 : 0; n < num_near; ++n) {
      const int t = near[n];
      if (!pair.is_new && !is_renewed_[s] && !is_renewed_[t]) continue;
      if (!box.may_meet(triangle_box_[t]) ||
          num_shared_vertices(surface_.triangles[s], surface_.triangles[t]) > 0)
        continue;
      if (is_non_colliding(s, t) || stay_apart(s, t)) continue;
      const auto [low, high] = std::minmax(s, t);
      add_pairs_of_triangles(low, high, triangle_box_[low], triangle_box_[high], false, chunk);
    }
  }
}

/// Whether a plane normal to the line between their centres separates two triangles at all times: along any
/// direction, points that move in straight lines are nearest at the start or at the end.
bool Proximity::stay_apart(int first, int second) const {
  const Triangle &a = surface_.triangles[first], &b = surface_.triangles[second];
  const std::vector<Float4>&x = at_start_.x, &y = at_end_.x;
  const auto centre = [&](const Triangle& t) -> Float4 {
    return x[t[0]] + x[t[1]] + x[t[2]] + y[t[0]] + y[t[1]] + y[t[2]];
  };
  const auto highest = [](const Float4& n, const std::vector<Float4>& at, const Triangle& t) {
    return std::max({n.dot(at[t[0]]), n.dot(at[t[1]]), n.dot(at[t[2]])});
  };
  const auto margin = [&](const Triangle& t) {
    return std::max({margin_[t[0]], margin_[t[1]], margin_[t[2]]});
  };
  const Float4 towards = centre(b) - centre(a), back = -towards;
  const float room = (margin(a) + margin(b)) * towards.norm();
  return highest(towards, y, a) + highest(back, y, b) < -room &&
         highest(towards, x, a) + highest(back, x, b) < -room;
}

void Proximity::add_pairs_of_triangles(int first, int second, const SweptBox& box_a, const SweptBox& box_b,
                                       bool is_one_ring_pair, PairChunk& chunk) const {
  const Surface::OwnedFeatures &a = surface_.owned[first], &b = surface_.owned[second];
  const Triangle &ta = surface_.triangles[first], &tb = surface_.triangles[second];
  for (const int v : a.vertex) {
    if (v >= 0 && !has_vertex(tb, v) && box_of({&v, 1}).may_meet(box_b))
      add_vertex_triangle(v, second, is_one_ring_pair, chunk);
  }
  for (const int v : b.vertex) {
    if (v >= 0 && !has_vertex(ta, v) && box_of({&v, 1}).may_meet(box_a))
      add_vertex_triangle(v, first, is_one_ring_pair, chunk);
  }
  std::array<SweptBox, 3> sides;
  for (int k = 0; k < 3; ++k) {
    if (b.edge[k] >= 0) sides[k] = box_of(surface_.edges[b.edge[k]]);
  }
  for (const int e : a.edge) {
    if (e < 0) continue;
    const SweptBox side = box_of(surface_.edges[e]);
    for (int k = 0; k < 3; ++k) {
      const int f = b.edge[k];
      if (f >= 0 && side.may_meet(sides[k]))
        add_edge_edge(std::min(e, f), std::max(e, f), is_one_ring_pair, chunk);
    }
  }
}

/// The distance at the start below which two features may become close during the step: a and b are their
/// corners. Only their relative motion counts, however far both move.
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

/// a and b are the corners of the two features, distance(x) is their distance with vertices at x. Mesh
/// neighbours may always come nearer than at rest, other layers of a cloth as near as at rest.
template <std::size_t kA, std::size_t kB, class Distance>
void Proximity::add_pair(FeaturePair pair, const std::array<int, kA>& a, const std::array<int, kB>& b,
                         bool is_one_ring_pair, const Distance& distance,
                         std::vector<FeaturePair>& pairs) const {
  const double reach = reach_between(a, b);
  if (distance(made_for_.start).distance_sq > reach * reach) return;
  if (is_one_ring_pair || are_tight(a[0], b[0])) {
    const float share = is_one_ring_pair || are_beside(a, b) ? kShareOfRest : 1.0f;
    pair.max_gap = share * static_cast<float>(distance(rest_).distance());
  }
  pairs.push_back(pair);
}

bool Proximity::are_tight(int vertex, int other) const {
  return is_tight_[vertex] && is_tight_[other] && body_of(vertex) == body_of(other);
}

/// Whether the two share a vertex, or are joined by an edge.
bool Proximity::are_beside(std::span<const int> a, std::span<const int> b) const {
  for (const int v : a) {
    for (const int t : surface_.triangles_at(v)) {
      for (const int w : b) {
        if (has_vertex(surface_.triangles[t], w)) return true;
      }
    }
  }
  return false;
}

void Proximity::add_vertex_triangle(int vertex, int triangle, bool is_one_ring_pair, PairChunk& chunk) const {
  const FeaturePair pair{vertex, triangle};
  const auto distance = [&](const std::vector<Vec3>& x) { return distance_to_triangle(pair, x); };
  add_pair(pair, std::array{vertex}, surface_.triangles[triangle], is_one_ring_pair, distance,
           chunk.vertex_triangle);
}

void Proximity::add_edge_edge(int a, int b, bool is_one_ring_pair, PairChunk& chunk) const {
  const std::array<int, 2>&e = surface_.edges[a], &f = surface_.edges[b];
  if (e[0] == f[0] || e[0] == f[1] || e[1] == f[0] || e[1] == f[1]) return;
  const FeaturePair pair{a, b};
  const auto distance = [&](const std::vector<Vec3>& x) { return distance_of_edges(pair, x); };
  add_pair(pair, e, f, is_one_ring_pair, distance, chunk.edge_edge);
}

PointTriangleDistance Proximity::distance_to_triangle(const FeaturePair& pair,
                                                      const std::vector<Vec3>& x) const {
  const auto [i, j, k] = surface_.triangles[pair.b];
  return point_triangle_distance(x[pair.a], x[i], x[j], x[k]);
}

EdgeEdgeDistance Proximity::distance_of_edges(const FeaturePair& pair, const std::vector<Vec3>& x) const {
  const auto [i, j] = surface_.edges[pair.a];
  const auto [k, l] = surface_.edges[pair.b];
  return edge_edge_distance(x[i], x[j], x[k], x[l]);
}

/// Whether the cloth forms a sharp tip at a vertex, with vertices at x: seen along the sum of its normals, a
/// triangle is tilted too far, or is too narrow to stay as it is.
bool Proximity::is_sharp(int vertex, const std::vector<Float4>& x) const {
  constexpr std::size_t kMaxRingTriangles = 16;  // one-ring triangles that are measured
  const std::span<const int> one_ring = surface_.triangles_at(vertex);
  if (one_ring.size() > kMaxRingTriangles) return true;
  struct Shape {
    Eigen::Vector3f normal;
    float height;  // the least of three [m]
  };
  std::array<Shape, kMaxRingTriangles> shapes;
  Eigen::Vector3f sum = Eigen::Vector3f::Zero();
  for (std::size_t f = 0; f < one_ring.size(); ++f) {
    const auto [i, j, k] = surface_.triangles[one_ring[f]];
    const Eigen::Vector3f a = (x[j] - x[i]).xyz(), b = (x[k] - x[i]).xyz(), area = a.cross(b);
    const float size = area.norm(),
                longest_sq = std::max({a.squaredNorm(), b.squaredNorm(), (b - a).squaredNorm()});
    if (!(size > 0)) return true;
    shapes[f] = {area / size, size / std::sqrt(longest_sq)};
    sum += shapes[f].normal;
  }
  const float length = sum.norm(), width = static_cast<float>(slacks_.narrow);
  for (std::size_t f = 0; f < one_ring.size(); ++f) {
    const float facing = shapes[f].normal.dot(sum);
    const bool is_flat = facing >= kSharp * length && facing * shapes[f].height > width * length;
    if (!is_flat) return true;  // NaN too
  }
  return false;
}

/// One-ring pairs (triangles that share a vertex) matter only where the cloth forms a sharp tip or a fold.
/// Two that share an edge are found at both of its ends.
void Proximity::find_one_ring_pairs(JobSystem& jobs) {
  constexpr int kGrain = 2048;
  is_in_fold_.assign(num_cloth_vertices_, 0);
  for (int p = 0; p < patches_.num_cloth(); ++p) {
    if (!is_folded_[p]) continue;
    for (const int v : patches_.vertices(p)) is_in_fold_[v] = is_near_[v];
  }
  is_sharp_.resize(num_cloth_vertices_);
  parallel_for(jobs, num_cloth_vertices_, kGrain, [&](int begin, int end) {
    for (int v = begin; v < end; ++v) {
      if (is_in_fold_[v]) is_sharp_[v] = is_sharp(v, at_start_.x) || is_sharp(v, at_end_.x);
    }
  });
  one_ring_pairs_.clear();
  for (int v = 0; v < num_cloth_vertices_; ++v) {
    if (!is_in_fold_[v] || !is_sharp_[v]) continue;
    const std::span<const int> one_ring = surface_.triangles_at(v);
    for (std::size_t f = 0; f < one_ring.size(); ++f) {
      for (std::size_t g = f + 1; g < one_ring.size(); ++g) {
        if (!is_non_colliding(one_ring[f], one_ring[g]))
          one_ring_pairs_.push_back({one_ring[f], one_ring[g]});
      }
    }
  }
}

}  // namespace weft::engine
