#include "weft/mesh/seams.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "weft/geometry/aabb_tree.h"
#include "weft/geometry/distance.h"

namespace weft::engine {
namespace {

constexpr double kRounding = 1 + 1e-9;  // tolerance for distances of exactly the limit [1]
constexpr double kMinAligned = 0.5;     // cosine of the angle between parallel borders [1]
constexpr double kMaxFold = 0.9;        // cosine of the angle between pieces, above: layers (25°) [1]
constexpr double kReach = 1.5;     // maximum distance of points that meet halfway, in sewing distances [1]
constexpr double kSnap = 1.0 / 3;  // shares of an edge up to this are not worth dividing it [1]
constexpr double kMinPace = 0.25;  // minimum speed of one border relative to the other [1]
constexpr double kMaxAstray = 3;   // maximum separation of borders in between, in sewing distances [1]
constexpr double kMinLength = 2;   // of a seam, in sewing distances [1]
constexpr double kMinSlenderness = 10;  // distance along a border over the distance across [1]
constexpr int kMaxRounds = 50;

std::pair<int, int> sorted(int a, int b) { return std::minmax({a, b}); }

}  // namespace

SeamFinder::SeamFinder(const TriangleMesh& mesh, double distance)
    : distance_(distance * kRounding), borders_(build_borders(mesh)) {
  const int n = mesh.num_vertices();
  group_.resize(n);
  std::iota(group_.begin(), group_.end(), 0);
  members_.resize(n);
  triangles_.resize(n);
  node_of_vertex_.assign(n, -1);
  is_sewn_.assign(borders_.nodes.size(), 0);
  for (int k = 0; k < static_cast<int>(borders_.nodes.size()); ++k) {
    const int v = borders_.nodes[k].vertex;
    node_of_vertex_[v] = k;
    members_[v] = {v};
  }
  for (int t = 0; t < mesh.num_triangles(); ++t) {
    for (const int v : mesh.triangles[t]) {
      if (node_of_vertex_[v] >= 0) triangles_[v].push_back(t);
    }
  }
}

void SeamFinder::sew_all() {
  for (int round = 0; round < kMaxRounds; ++round) {
    const std::size_t num_tried = tried_.size();
    for (const Seed& seed : find_seeds()) try_seam(seed);
    if (tried_.size() == num_tried) return;
  }
}

// ---- Seeds

std::vector<SeamFinder::Seed> SeamFinder::find_seeds() const {
  std::vector<int> edges;
  std::vector<Aabb> boxes;
  for (int n = 0; n < static_cast<int>(borders_.nodes.size()); ++n) {
    if (borders_.nodes[n].edge < 0 || is_sewn_[n]) continue;
    const Vec3 &p = borders_.nodes[n].position, &q = borders_.nodes[borders_.nodes[n].next].position;
    edges.push_back(n);
    boxes.push_back(make_aabb(p.cwiseMin(q), p.cwiseMax(q)));
  }
  AabbTree tree;
  tree.build(boxes, {}, *make_serial_jobs());
  std::vector<Seed> seeds;
  for (const int edge : edges) {
    for (const int node : {edge, borders_.nodes[edge].next}) {
      const Vec3& p = borders_.nodes[node].position;
      Seed best{2 * distance_, edge, node, -1};
      tree.for_each_overlapping(make_aabb(p, p, distance_), [&](int item) {
        const int other = edges[item];
        const double d = point_segment_distance(p, borders_.nodes[other].position,
                                                borders_.nodes[borders_.nodes[other].next].position)
                             .distance();
        if (d <= distance_ && may_sew(edge, other)) best = std::min(best, {d, edge, node, other});
      });
      if (best.other_edge >= 0) seeds.push_back(best);
    }
  }
  std::sort(seeds.begin(), seeds.end());
  return seeds;
}

bool SeamFinder::may_sew(int edge_a, int edge_b) const {
  if (edge_a == edge_b || is_sewn_[edge_a] || is_sewn_[edge_b]) return false;
  const auto& nodes = borders_.nodes;
  if (nodes[edge_a].next == edge_b || nodes[edge_b].next == edge_a) return false;
  const BorderEdge &a = borders_.edges[nodes[edge_a].edge], &b = borders_.edges[nodes[edge_b].edge];
  const double aligned = a.tangent.dot(b.tangent);
  if (std::abs(aligned) <= kMinAligned) return false;
  if (std::copysign(1.0, aligned) * a.side.dot(b.side) > kMaxFold) return false;
  if (tried_.contains(sorted(nodes[edge_a].edge, nodes[edge_b].edge))) return false;
  return a.piece != b.piece || may_sew_to_itself(edge_a, edge_b);
}

/// Excludes sewing across the cloth, as in a narrow ribbon, and around a corner of the border.
bool SeamFinder::may_sew_to_itself(int edge_a, int edge_b) const {
  const auto& nodes = borders_.nodes;
  const BorderEdge &a = borders_.edges[nodes[edge_a].edge], &b = borders_.edges[nodes[edge_b].edge];
  const Vec3 &a0 = nodes[edge_a].position, &a1 = nodes[nodes[edge_a].next].position;
  const Vec3 &b0 = nodes[edge_b].position, &b1 = nodes[nodes[edge_b].next].position;
  const EdgeEdgeDistance d = edge_edge_distance(a0, a1, b0, b1);
  const Vec3 across = (1 - d.t) * b0 + d.t * b1 - (1 - d.s) * a0 - d.s * a1;
  if (is_across_cloth(a, b, across)) return false;
  return a.border != b.border || borders_.distance_along(edge_a, edge_b) > kMinSlenderness * d.distance();
}

// ---- Along two borders

Vec3 SeamFinder::position(const BorderPlace& place) const {
  const BorderNode& n = borders_.nodes[place.node];
  return place.t == 0 ? n.position : n.position + place.t * (borders_.nodes[n.next].position - n.position);
}

/// The next part of an edge, as its start node; -1 at the end of an open border.
int SeamFinder::edge_ahead(const BorderPlace& place, int direction) const {
  if (place.t > 0) return place.node;
  if (direction < 0) return borders_.nodes[place.node].previous;
  return borders_.nodes[place.node].edge < 0 ? -1 : place.node;
}

/// The next node, or the seam's start if that comes first.
BorderPlace SeamFinder::next_place(const BorderPlace& place, int direction, const BorderPlace& start) const {
  const int edge = edge_ahead(place, direction);
  const bool is_start_ahead = start.t > 0 && start.node == edge &&
                              (direction > 0 ? start.t > place.t : place.t == 0 || start.t < place.t);
  if (is_start_ahead) return start;
  return {direction > 0 ? borders_.nodes[edge].next : edge, 0};
}

/// Interpolates towards the next node.
BorderPlace SeamFinder::between(const BorderPlace& place, int direction, double share) const {
  const double to = direction > 0 ? 1 : 0;
  const double from = direction < 0 && place.t == 0 ? 1 : place.t;
  return {edge_ahead(place, direction), from + share * (to - from)};
}

/// Shortest edge of the mesh at the place.
double SeamFinder::shortest_edge_at(const BorderPlace& place) const {
  const BorderNode& n = borders_.nodes[place.node];
  const bool is_vertex = place.t == 0 && n.t == 0;
  double length = std::numeric_limits<double>::infinity();
  if (n.edge >= 0) length = borders_.edges[n.edge].length;
  if (is_vertex && n.previous >= 0)
    length = std::min(length, borders_.edges[borders_.nodes[n.previous].edge].length);
  return length;
}

/// Distance of p from the border near one of its places.
double SeamFinder::find_gap(const Vec3& p, const BorderPlace& place) const {
  double nearest = (p - position(place)).norm();
  for (const int direction : {1, -1}) {
    BorderPlace at = place;
    for (double way = 0; way <= 2 * distance_;) {
      if (edge_ahead(at, direction) < 0) break;
      const BorderPlace next = next_place(at, direction, place);
      const Vec3 from = position(at), to = position(next);
      nearest = std::min(nearest, point_segment_distance(p, from, to).distance());
      way += (to - from).norm();
      at = next;
      if (at == place) break;
    }
  }
  return nearest;
}

bool SeamFinder::become_one(const Stitch& start, const BorderPlace& a, const BorderPlace& b) const {
  if (a == start.a && b == start.b) return true;
  if (a.t > 0 || b.t > 0) return false;
  return group_[borders_.nodes[a.node].vertex] == group_[borders_.nodes[b.node].vertex];
}

bool SeamFinder::find_step(const Stitch& start, const Stitch& at, int direction_a, int direction_b,
                           Step& step) const {
  const BorderPlace a = next_place(at.a, direction_a, start.a), b = next_place(at.b, direction_b, start.b);
  if (become_one(start, a, b)) {
    step = {{a, b}, 0, a == b || (a == start.a && b == start.b)};
    return true;
  }
  const Vec3 from_a = position(at.a), from_b = position(at.b), to_a = position(a), to_b = position(b);
  const double way_a = (to_a - from_a).norm(), way_b = (to_b - from_b).norm();
  double share_a = point_segment_distance(to_b, from_a, to_a).t;  // of b on the segment to a
  double share_b = point_segment_distance(to_a, from_b, to_b).t;
  const bool must_divide_a = a == start.a, must_divide_b = b == start.b;
  const double snap = kSnap * std::min(shortest_edge_at(a), shortest_edge_at(b));
  const bool is_end = (1 - share_a) * way_a <= snap && (1 - share_b) * way_b <= snap;
  const bool may_join = !must_divide_a && !must_divide_b && (to_a - to_b).norm() <= kReach * distance_;
  if (may_join && (is_end || (share_a == 1 && share_b == 1))) {
    step = {{a, b}, std::min(find_gap(to_a, b), find_gap(to_b, a)), false};
    return step.gap <= distance_;
  }
  if (must_divide_a && must_divide_b) return false;

  // The node passed first divides the other border: the nearer pair.
  const auto keep_pace = [](double share, double way, double other_way) {
    return share == 1 ? 0.75 : std::max(share, std::min(0.5, kMinPace * other_way / way));
  };
  const Stitch divides_a = {between(at.a, direction_a, keep_pace(share_a, way_a, way_b)), b};
  const Stitch divides_b = {a, between(at.b, direction_b, keep_pace(share_b, way_b, way_a))};
  const double apart_a = (position(divides_a.a) - to_b).norm(),
               apart_b = (position(divides_b.b) - to_a).norm();
  const bool is_a = must_divide_a || (!must_divide_b && apart_a < apart_b);
  step = {is_a ? divides_a : divides_b, is_a ? find_gap(to_b, divides_a.a) : find_gap(to_a, divides_b.b),
          false};
  return step.gap <= distance_ && (is_a ? apart_a : apart_b) <= kReach * distance_;
}

bool SeamFinder::may_go_on(int edge_a, int edge_b) const {
  return edge_a >= 0 && edge_b >= 0 && edge_a != edge_b && !is_sewn_[edge_a] && !is_sewn_[edge_b];
}

/// Follows both borders while they stay near each other; trims the end where they are no longer parallel.
SeamFinder::Run SeamFinder::run_along(const Stitch& start, int direction_a, int direction_b) const {
  Run run;
  SeamMeasures all;
  double astray = 0;
  std::size_t num_good = 0;
  const int first_a = edge_ahead(start.a, direction_a), first_b = edge_ahead(start.b, direction_b);
  for (Stitch at = start; astray <= kMaxAstray * distance_; at = run.stitches.back()) {
    const int edge_a = edge_ahead(at.a, direction_a), edge_b = edge_ahead(at.b, direction_b);
    if (!may_go_on(edge_a, edge_b) || edge_a == first_b || edge_b == first_a) break;
    Step step;
    if (!find_step(start, at, direction_a, direction_b, step)) break;
    run.stitches.push_back(step.to);
    const Vec3 way_a = position(step.to.a) - position(at.a), way_b = position(step.to.b) - position(at.b);
    const double length = std::max(way_a.norm(), way_b.norm());
    const BorderEdge &a = borders_.edges[borders_.nodes[edge_a].edge],
                     &b = borders_.edges[borders_.nodes[edge_b].edge];
    all.add({length, step.gap, direction_a * direction_b * a.side.dot(b.side) * length});
    astray += length;
    if (step.closes || way_a.dot(way_b) > kMinAligned * way_a.norm() * way_b.norm()) {
      astray = 0;
      num_good = run.stitches.size();
      run.measures = all;
    }
    if (step.closes) break;
  }
  run.stitches.resize(num_good);
  run.is_closed = num_good > 0 && run.stitches.back() == start;
  return run;
}

Stitch SeamFinder::make_start(const Seed& seed) const {
  const auto& nodes = borders_.nodes;
  const BorderNode &node = nodes[seed.node], &from = nodes[seed.other_edge], &to = nodes[from.next];
  const BorderPlace a{seed.node, 0}, ends[2] = {{seed.other_edge, 0}, {from.next, 0}};
  for (const BorderPlace& end : ends) {
    if (group_[node.vertex] == group_[nodes[end.node].vertex]) return {a, end};
  }
  const double t = point_segment_distance(node.position, from.position, to.position).t;
  const double length = (to.position - from.position).norm();
  for (int k = 0; k < 2; ++k) {
    const double rest = (k == 0 ? t : 1 - t) * length;
    if (rest == 0 || (rest <= kSnap * std::min(shortest_edge_at(a), shortest_edge_at(ends[k])) &&
                      (position(ends[k]) - node.position).norm() <= kReach * distance_))
      return {a, ends[k]};
  }
  return {a, {seed.other_edge, t}};
}

/// Runs both ways from the seed.
Seam SeamFinder::find_seam(const Seed& seed) const {
  const Stitch start = make_start(seed);
  const BorderEdge &a = borders_.edges[borders_.nodes[seed.edge].edge],
                   &b = borders_.edges[borders_.nodes[seed.other_edge].edge];
  Seam seam;
  seam.direction_b = a.tangent.dot(b.tangent) > 0 ? 1 : -1;
  const Run ahead = run_along(start, 1, seam.direction_b);
  const Run back = ahead.is_closed ? Run{} : run_along(start, -1, -seam.direction_b);
  seam.is_closed = ahead.is_closed;
  seam.stitches.assign(back.stitches.rbegin(), back.stitches.rend());
  seam.stitches.push_back(start);
  seam.stitches.insert(seam.stitches.end(), ahead.stitches.begin(), ahead.stitches.end());
  if (seam.is_closed) seam.stitches.pop_back();
  seam.measures = ahead.measures;
  seam.measures.add(back.measures);
  return seam;
}

void SeamFinder::try_seam(const Seed& seed) {
  if (!may_sew(seed.edge, seed.other_edge)) return;
  Seam seam = find_seam(seed);
  tried_.insert(sorted(borders_.nodes[seed.edge].edge, borders_.nodes[seed.other_edge].edge));
  for (const Stitch& s : seam.stitches)
    tried_.insert(sorted(borders_.nodes[s.a.node].edge, borders_.nodes[s.b.node].edge));
  if (seam.measures.length < kMinLength * distance_) return;
  if (seam.measures.fold > kMaxFold * seam.measures.length) return;
  sew(seam);
}

// ---- Sewing

/// Divides edges at places that are not nodes, and makes them nodes.
void SeamFinder::divide_at(std::vector<BorderPlace*> places) {
  std::erase_if(places, [](const BorderPlace* p) { return p->t == 0; });
  std::sort(places.begin(), places.end(), [](const BorderPlace* l, const BorderPlace* r) {
    return std::pair(l->node, -l->t) < std::pair(r->node, -r->t);
  });
  for (std::size_t i = 0, end = 0; i < places.size(); i = end) {
    const int node = places[i]->node;
    const double from = borders_.nodes[node].t, to = borders_.end_of(node);
    for (; end < places.size() && places[end]->node == node; ++end) {
      const int added = borders_.divide(node, from + places[end]->t * (to - from));
      add_divided(added, node);
      *places[end] = {added, 0};
    }
  }
}

void SeamFinder::add_divided(int node, int divided) {
  const BorderNode& n = borders_.nodes[node];
  is_sewn_.push_back(is_sewn_[divided]);
  group_.push_back(n.vertex);
  members_.push_back({n.vertex});
  node_of_vertex_.push_back(node);
  triangles_.push_back({borders_.edges[n.edge].triangle});
}

void SeamFinder::sew(Seam& seam) {
  std::vector<BorderPlace*> places;
  for (Stitch& s : seam.stitches) places.insert(places.end(), {&s.a, &s.b});
  seam.num_divided = static_cast<int>(
      std::count_if(places.begin(), places.end(), [](const BorderPlace* p) { return p->t > 0; }));
  divide_at(places);
  std::vector<char> is_joined;
  for (const Stitch& s : seam.stitches)
    is_joined.push_back(unite(borders_.nodes[s.a.node].vertex, borders_.nodes[s.b.node].vertex));
  const std::size_t num = seam.stitches.size();
  for (std::size_t i = 0; i + (seam.is_closed ? 0 : 1) < num; ++i) {
    const Stitch &from = seam.stitches[i], &to = seam.stitches[(i + 1) % num];
    if (!is_joined[i] || !is_joined[(i + 1) % num]) continue;
    is_sewn_[from.a.node] = 1;
    is_sewn_[seam.direction_b > 0 ? from.b.node : to.b.node] = 1;
  }
  seams_.push_back(std::move(seam));
}

/// False if it would move a point too far or join two corners of a triangle.
bool SeamFinder::unite(int vertex_a, int vertex_b) {
  const auto [low, high] = sorted(group_[vertex_a], group_[vertex_b]);
  if (low == high) return true;
  std::vector<int> all = members_[low];
  all.insert(all.end(), members_[high].begin(), members_[high].end());
  if (!may_unite(members_[low], members_[high], all)) return false;
  for (const int v : members_[high]) group_[v] = low;
  members_[high].clear();
  members_[low] = std::move(all);
  return true;
}

bool SeamFinder::may_unite(const std::vector<int>& group_a, const std::vector<int>& group_b,
                           const std::vector<int>& all) const {
  const Vec3 mean = mean_position(all);
  const auto moves_too_far = [&](int v) { return (position_of(v) - mean).norm() > distance_; };
  if (std::any_of(all.begin(), all.end(), moves_too_far)) return false;
  for (const int a : group_a) {
    for (const int b : group_b) {
      if (share_triangle(a, b)) return false;
    }
  }
  return true;
}

/// Two neighbours on a divided edge may still merge: the edge then has one division fewer.
bool SeamFinder::share_triangle(int a, int b) const {
  const BorderNode &node_a = borders_.nodes[node_of_vertex_[a]], &node_b = borders_.nodes[node_of_vertex_[b]];
  const bool are_neighbours = node_a.next == node_of_vertex_[b] || node_b.next == node_of_vertex_[a];
  if (are_neighbours && (node_a.t > 0 || node_b.t > 0)) return false;
  return std::find_first_of(triangles_[a].begin(), triangles_[a].end(), triangles_[b].begin(),
                            triangles_[b].end()) != triangles_[a].end();
}

Vec3 SeamFinder::position_of(int vertex) const { return borders_.nodes[node_of_vertex_[vertex]].position; }

Vec3 SeamFinder::mean_position(const std::vector<int>& vertices) const {
  Vec3 sum = Vec3::Zero();
  for (const int v : vertices) sum += position_of(v);
  return sum / static_cast<double>(vertices.size());
}

}  // namespace weft::engine
