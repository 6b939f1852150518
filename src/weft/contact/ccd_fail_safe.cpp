#include "weft/contact/ccd_fail_safe.h"

#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <limits>

#include "weft/contact/collect.h"
#include "weft/geometry/distance.h"
#include "weft/mesh/solid.h"

namespace weft::engine {
namespace {

constexpr int kPairGrain = 1024;   // pairs per chunk
constexpr int kPushRounds = 6;     // of impulses, each followed by a new detection
constexpr int kPushPasses = 20;    // over all impulses in a round
constexpr int kZoneRounds = 60;    // zones halve their non-rigid remainder, and grow
constexpr double kMinShare = 0.1;  // of a zone's remainder: below, it moves rigidly

/// Separation in CCD: this share of the contact gap; where that is small, the floor [m].
constexpr double kSeparation = 0.1;
constexpr double kFloor = 1e-5;

/// Features farther apart than this many separations have no hit: gap and tolerance are at most 1.1.
constexpr double kFar = 1.15;

/// Features nearer than their separation at the start recover this share of the missing distance.
constexpr double kRecovery = 0.2;

/// Relative rounding error of positions stored as floats [1].
constexpr double kRounding = 1.2e-7;

/// The separation of features whose contact gap is `thickness` [m].
double separation_of(double thickness) { return std::max(kSeparation * thickness, kFloor); }

/// The target distance of the pair's impulse [m].
double target_for(const ImpactLimit& limit, double start) {
  const double recovered = start + kRecovery * (limit.separation - start);
  return std::max(limit.gap(start) + 2 * limit.tolerance(start), std::min(limit.separation, recovered));
}

/// Best-fitting rigid motion of weighted points: x ↦ R (x − from) + to.
class RigidFit {
 public:
  void add(double weight, const Vec3& start, const Vec3& end) {
    weights_ += weight;
    points_.push_back({weight, start, end});
    from_ += weight * start;
    to_ += weight * end;
  }

  void solve() {
    from_ /= weights_;
    to_ /= weights_;
    Mat3 covariance = Mat3::Zero();
    for (const Point& p : points_) covariance += p.weight * (p.end - to_) * (p.start - from_).transpose();
    const Eigen::JacobiSVD<Mat3> svd(covariance, Eigen::ComputeFullU | Eigen::ComputeFullV);
    Vec3 signs = Vec3::Ones();
    if ((svd.matrixU() * svd.matrixV().transpose()).determinant() < 0) signs.z() = -1;
    rotation_ = svd.matrixU() * signs.asDiagonal() * svd.matrixV().transpose();
  }

  Vec3 apply(const Vec3& x) const { return to_ + rotation_ * (x - from_); }

 private:
  struct Point {
    double weight;
    Vec3 start, end;
  };

  double weights_ = 0;
  std::vector<Point> points_;
  Vec3 from_ = Vec3::Zero(), to_ = Vec3::Zero();
  Mat3 rotation_ = Mat3::Identity();
};

}  // namespace

CcdFailSafeReport CcdFailSafe::resolve(const CcdFailSafeStep& step, Proximity& proximity,
                                       SurfaceMotion& motion, JobSystem& jobs) {
  step_ = step;
  proximity_ = &proximity;
  motion_ = &motion;
  only_moved_ = false;
  is_moved_.assign(motion.end.size(), 0);
  near_.reserve(num_cloth_vertices());
  CcdFailSafeReport report;
  pushes_.clear();
  parent_.clear();
  find_hits(jobs, report);
  report.hits = static_cast<int>(hits_.size());
  if (!hits_.empty()) push_apart(jobs, report);
  if (!hits_.empty()) join_zones(jobs, report);
  return report;
}

/// Detects hits of all pairs, or of those with a vertex that has moved since.
void CcdFailSafe::find_hits(JobSystem& jobs, CcdFailSafeReport& report) {
  hits_.clear();
  proximity_->update(*motion_, jobs);
  if (step_.clock && !only_moved_)
    step_.clock->add_look(proximity_->vertex_triangle().size() + proximity_->edge_edge().size());
  const auto collect = [&](const std::vector<FeaturePair>& pairs, const auto& test) {
    collect_in_order(
        jobs, static_cast<int>(pairs.size()), kPairGrain, chunks_,
        [&](int p, std::vector<Hit>& chunk) {
          Hit hit;
          if (test(pairs[p], hit)) chunk.push_back(hit);
        },
        [&](const std::vector<Hit>& chunk) { hits_.insert(hits_.end(), chunk.begin(), chunk.end()); });
  };
  collect(proximity_->vertex_triangle(),
          [&](const FeaturePair& pair, Hit& hit) { return test_vertex_triangle(pair, hit); });
  collect(proximity_->edge_edge(),
          [&](const FeaturePair& pair, Hit& hit) { return test_edge_edge(pair, hit); });
  for (int s = 0; s < static_cast<int>(step_.shapes->size()); ++s) {
    if (!(*step_.shapes)[s].is_mesh()) find_shape_hits(s);
  }
  std::fill(is_moved_.begin(), is_moved_.end(), char{0});
  only_moved_ = true;
  // Drop pairs that intersected before, features that leave a closed mesh, and infeasible pairs.
  std::erase_if(hits_, [&](const Hit& hit) {
    if (starts_intersecting(hit) || comes_from_inside(hit.constraint)) return true;
    if (hit.constraint.inverse_mass > 0) return false;
    add_infeasible(hit, report);
    return true;
  });
}

void CcdFailSafe::add_infeasible(const Hit& hit, CcdFailSafeReport& report) const {
  const Constraint& c = hit.constraint;
  report.infeasible.push_back({c.vertex[0], c.shape >= 0 ? -1 : c.vertex[3], c.shape});
}

bool CcdFailSafe::needs_test(const std::array<int, 4>& vertices, int count) const {
  if (!only_moved_) return true;
  return std::any_of(vertices.begin(), vertices.begin() + count, [&](int v) { return is_moved_[v] != 0; });
}

/// Whether the whole pair is in one zone. Rigid motion causes no hits within a zone: the straight lines
/// between are an affine map at every time.
bool CcdFailSafe::is_rigid(const std::array<int, 4>& vertices) const {
  if (parent_.empty()) return false;
  const auto root = [&](int v) { return v < num_cloth_vertices() ? find_root(v) : -1; };
  const int first = root(vertices[0]);
  return first >= 0 && share_[first] == 0 && root(vertices[1]) == first && root(vertices[2]) == first &&
         root(vertices[3]) == first;
}

/// `thickness` is the pair's contact gap; `vertex` is one of the pair's.
ImpactLimit CcdFailSafe::limit_for(double thickness, int vertex) const {
  const int cloth = mesh_of(*step_.first_vertex, std::min(vertex, num_cloth_vertices() - 1));
  const Vec3 offset = motion_->start[vertex] - (*step_.origins)[cloth];
  const double separation = separation_of(thickness);
  return {separation, std::min(kFloor, separation), kRounding * (1 + offset.norm())};
}

bool CcdFailSafe::test_vertex_triangle(const FeaturePair& pair, Hit& hit) const {
  const auto [i, j, k] = proximity_->surface().triangles[pair.b];
  hit.is_edge_edge = false;
  return test_pair(pair, {i, j, k, pair.a}, find_vertex_triangle_impact, hit);
}

bool CcdFailSafe::test_edge_edge(const FeaturePair& pair, Hit& hit) const {
  const std::array<int, 2>&a = proximity_->surface().edges[pair.a], &b = proximity_->surface().edges[pair.b];
  hit.is_edge_edge = true;
  return test_pair(pair, {a[0], a[1], b[0], b[1]}, find_edge_edge_impact, hit);
}

/// Whether triangles at the one feature intersect triangles at the other at the start. Intersected features
/// must be free to separate; stopping them would lock them in place.
bool CcdFailSafe::starts_intersecting(const Hit& hit) const {
  const Constraint& c = hit.constraint;
  if (c.shape >= 0) return false;
  const int middle = hit.is_edge_edge ? 2 : 3;
  const Surface& surface = proximity_->surface();
  const std::vector<Triangle>& triangles = surface.triangles;
  const std::span<const int> vertices = c.vertex;
  const std::vector<Vec3>& x = motion_->start;
  const auto pierces = [&](const Triangle& s, const Triangle& t) {
    for (int k = 0; k < 3; ++k) {
      const int v = s[k], w = s[(k + 1) % 3];
      const bool is_joined = has_vertex(t, v) || has_vertex(t, w);
      if (!is_joined && segment_triangle_distance(x[v], x[w], x[t[0]], x[t[1]], x[t[2]]).distance_sq == 0)
        return true;
    }
    return false;
  };
  bool is_pierced = false;
  surface.for_triangles_with(vertices.first(middle), [&](int s) {
    surface.for_triangles_with(vertices.subspan(middle), [&](int t) {
      is_pierced = is_pierced || pierces(triangles[s], triangles[t]) || pierces(triangles[t], triangles[s]);
    });
  });
  return is_pierced;
}

/// Winding number test: whether the point of cloth that meets a closed shell is inside of it at the start. The
/// side of the met face does not suffice: faces of a rotating mesh come from far, and a point behind a face's
/// plane may be outside, beyond the face's border.
bool CcdFailSafe::comes_from_inside(const Constraint& c) const {
  if (c.shape >= 0) return false;
  const int of_mesh = std::max(c.vertex[0], c.vertex[3]);
  const auto mesh = std::find_if(step_.bodies->begin(), step_.bodies->end(), [&](const ColliderMesh& m) {
    return of_mesh >= m.first_vertex && of_mesh < m.end_vertex;
  });
  if (mesh == step_.bodies->end() || !mesh->has_inside_at(of_mesh)) return false;
  Vec3 point = Vec3::Zero();
  for (int k = 0; k < c.num_vertices; ++k) {
    if (c.vertex[k] < num_cloth_vertices()) point += std::abs(c.weight[k]) * motion_->start[c.vertex[k]];
  }
  return compute_winding_number(mesh->solid, motion_->start, point) > 0;
}

template <class Find>
bool CcdFailSafe::test_pair(const FeaturePair& pair, const std::array<int, 4>& vertex, const Find& find,
                            Hit& hit) const {
  if (!needs_test(vertex, 4) || is_rigid(vertex) || is_caught(vertex, -1)) return false;
  const std::vector<Vec3>&x = motion_->start, &y = motion_->end;
  const double thickness = motion_->half_thickness[vertex[0]] + motion_->half_thickness[vertex[3]];
  const ImpactLimit limit = limit_for(std::min(thickness, double{pair.max_gap}), vertex[0]);
  const std::optional<Impact> impact = find({x[vertex[0]], x[vertex[1]], x[vertex[2]], x[vertex[3]]},
                                            {y[vertex[0]], y[vertex[1]], y[vertex[2]], y[vertex[3]]}, limit);
  if (!impact || impact->distance_before <= 0) return false;
  Constraint& c = hit.constraint;
  c = {};
  c.num_vertices = 4;
  c.vertex = vertex;
  c.weight = impact->weights;
  c.normal = impact->normal;
  c.target = target_for(limit, impact->distance_before);
  c.inverse_mass = c.inverse_mass_of(*step_.inverse_mass);
  return true;
}

void CcdFailSafe::find_shape_hits(int s) {
  const MovingShape& shape = (*step_.shapes)[s];
  const std::vector<Vec3>&x = motion_->start, &y = motion_->end;
  const bool is_plane = std::holds_alternative<Plane>(shape.before);
  const double reach = is_plane ? 0 : proximity_->longest_edge();
  const double way = farthest_way(*motion_, num_cloth_vertices());
  step_.clearance->find_near(s, way, reach + 2 * separation_of(step_.thickest), near_);
  if (near_.empty()) return;
  is_near_.assign(num_cloth_vertices(), 0);
  shape_end_.resize(num_cloth_vertices());
  for (const int v : near_) {
    const Vec3 end = shape.at_start(y[v]);
    const double most = (end - x[v]).norm() + reach + 2 * separation_of(motion_->half_thickness[v]);
    if (signed_distance(shape.before, x[v]).distance > most) continue;
    shape_end_[v] = end;
    is_near_[v] = 1;
  }
  Hit hit;
  auto known = std::find_if(step_.separations.begin(), step_.separations.end(),
                            [&](const Separation& separation) { return separation.shape == s; });
  for (const Triangle& t : proximity_->surface().triangles) {
    if (t[0] >= num_cloth_vertices()) break;
    const bool is_known = known != step_.separations.end() && known->shape == s && known->triangle == t;
    if (is_known && keeps(*known++)) continue;
    if (!is_near_[t[0]] && !is_near_[t[1]] && !is_near_[t[2]]) continue;
    if (!needs_test({t[0], t[1], t[2], 0}, 3) || is_non_colliding(t[0], s) || is_caught(t, s)) continue;
    if (test_triangle_shape(s, t, hit)) hits_.push_back(hit);
  }
}

/// Whether the separating axis holds: the triangle stays beyond all of the shape by more than the separation.
/// Tested in the shape's frame, where the shape is at rest and the triangle moves in straight lines.
bool CcdFailSafe::keeps(const Separation& separation) const {
  const MovingShape& shape = (*step_.shapes)[separation.shape];
  const Vec3 normal_at_start = shape.turned_back(separation.normal);
  double at_start = std::numeric_limits<double>::infinity(), at_end = at_start;
  for (const int v : separation.triangle) {
    at_start = std::min(at_start, normal_at_start.dot(motion_->start[v]));
    at_end = std::min(at_end, separation.normal.dot(motion_->end[v]));
  }
  const double room = std::min(at_start - support(shape.before, normal_at_start),
                               at_end - support(shape.after, separation.normal));
  return room > kFar * separation_of(motion_->half_thickness[separation.triangle[0]]);
}

bool CcdFailSafe::is_caught(std::span<const int> vertices, int shape) const {
  return step_.caught && step_.caught->includes(vertices, shape);
}

/// Whether a cloth vertex and a shape do not collide.
bool CcdFailSafe::is_non_colliding(int vertex, int shape) const {
  if (step_.non_colliding->empty()) return false;
  const std::size_t num_cloths = step_.first_vertex->size() - 1,
                    num_bodies = num_cloths + step_.shapes->size();
  return (*step_.non_colliding)[mesh_of(*step_.first_vertex, vertex) * num_bodies + num_cloths + shape] != 0;
}

/// Tested in the shape's frame, where the shape is at rest and the triangle moves in straight lines. A
/// triangle that penetrates the shape at the start may be as deep at the end.
bool CcdFailSafe::test_triangle_shape(int s, const Triangle& t, Hit& hit) const {
  const MovingShape& shape = (*step_.shapes)[s];
  std::array<Vec3, 3> x, way;
  double travel_sq = 0;
  for (int k = 0; k < 3; ++k) {
    x[k] = motion_->start[t[k]];
    way[k] = (is_near_[t[k]] ? shape_end_[t[k]] : shape.at_start(motion_->end[t[k]])) - x[k];
    travel_sq = std::max(travel_sq, way[k].squaredNorm());
  }
  const double travel = std::sqrt(travel_sq), separation = separation_of(motion_->half_thickness[t[0]]);
  const double reach = travel + 3 * separation;
  const TriangleSignedDistance before = signed_distance(shape.before, x[0], x[1], x[2], reach);
  if (before.distance > reach) return false;
  // The shape is convex: it lies behind its tangent plane at the point nearest to the triangle.
  const Vec3 nearest = point_at(before.weights, x[0], x[1], x[2]);
  double least = before.distance;
  for (int k = 0; k < 3; ++k)
    least = std::min(least, before.distance + before.normal.dot(x[k] + way[k] - nearest));
  if (least > kFar * separation) return false;

  const ImpactLimit limit = limit_for(motion_->half_thickness[t[0]], t[0]);
  const double lift = std::max(0.0, limit.floor - before.distance);
  struct Place {
    double distance;
    TriangleSignedDistance nearest;
  };
  const auto at = [&](double time) -> Place {
    if (time == 0) return {before.distance + lift, before};
    const TriangleSignedDistance d = signed_distance(shape.before, x[0] + time * way[0], x[1] + time * way[1],
                                                     x[2] + time * way[2], reach);
    return {d.distance + lift, d};
  };
  const auto impact = find_impact(at, travel, limit);
  if (!impact) return false;
  const TriangleSignedDistance& d = impact->place.nearest;
  const Vec3 foot = point_at(d.weights, x[0] + impact->time * way[0], x[1] + impact->time * way[1],
                             x[2] + impact->time * way[2]) -
                    d.distance * d.normal;
  hit.foot_start = foot;
  hit.foot_end = shape.at_end(foot);
  Constraint& c = hit.constraint;
  c = {};
  c.num_vertices = 3;
  c.vertex = {t[0], t[1], t[2], 0};
  c.weight = {d.weights[0], d.weights[1], d.weights[2], 0};
  c.normal = shape.turned(d.normal);
  c.target = c.normal.dot(hit.foot_end) + target_for(limit, before.distance + lift) - lift;
  c.shape = s;
  c.inverse_mass = c.inverse_mass_of(*step_.inverse_mass);
  for (int k = 0; k < 3; ++k) {
    const bool is_pinned = (*step_.inverse_mass)[t[k]] == 0;
    if (!is_pinned || signed_distance(shape.after, motion_->end[t[k]]).distance > limit.separation) continue;
    // Its pin takes it there. The free corners have other triangles.
    std::swap(c.vertex[0], c.vertex[k]);
    std::swap(c.weight[0], c.weight[k]);
    c.inverse_mass = 0;
    break;
  }
  return true;
}

/// Rounds to the nearest position that can be stored.
void CcdFailSafe::move(int vertex, const Vec3& to) {
  const Vec3& origin = (*step_.origins)[mesh_of(*step_.first_vertex, vertex)];
  motion_->end[vertex] = origin + (to - origin).cast<float>().cast<double>();
  is_moved_[vertex] = 1;
}

void CcdFailSafe::push_apart(JobSystem& jobs, CcdFailSafeReport& report) {
  pushed_ = motion_->end;
  for (int round = 0; round < kPushRounds && !hits_.empty(); ++round) {
    for (const Hit& hit : hits_) pushes_.push_back(hit.constraint);
    project_positions(*step_.inverse_mass, kPushPasses, pushes_, pushed_, near_pushes_);
    for (const Constraint& c : pushes_) {
      for (int k = 0; k < c.num_vertices; ++k) {
        if ((*step_.inverse_mass)[c.vertex[k]] > 0) move(c.vertex[k], pushed_[c.vertex[k]]);
      }
    }
    find_hits(jobs, report);
  }
}

void CcdFailSafe::join_zones(JobSystem& jobs, CcdFailSafeReport& report) {
  wanted_.assign(motion_->end.begin(), motion_->end.begin() + num_cloth_vertices());
  parent_.assign(num_cloth_vertices(), -1);
  share_.assign(num_cloth_vertices(), 1.0);
  is_carried_.assign(num_cloth_vertices(), 0);
  guides_.clear();
  for (int round = 0; round < kZoneRounds && !hits_.empty(); ++round) {
    has_grown_ = false;
    is_halved_.assign(num_cloth_vertices(), 0);
    for (const Hit& hit : hits_) add_to_zones(hit);
    if (!has_grown_) break;
    gather_zones();
    for (const Zone& zone : zones_) scale_zone(zone);
    find_hits(jobs, report);
  }
  for (const Hit& hit : hits_) add_infeasible(hit, report);
  report.zones = static_cast<int>(zones_.size());
}

int CcdFailSafe::find_root(int vertex) const {
  int root = vertex;
  if (parent_[root] < 0) return -1;
  while (parent_[root] != root) root = parent_[root];
  return root;
}

/// Merges the hit's vertices into one zone, which keeps half of its previous non-rigid share.
void CcdFailSafe::add_to_zones(const Hit& hit) {
  const Constraint& c = hit.constraint;
  int root = -1;
  for (int k = 0; k < c.num_vertices; ++k) {
    const int v = c.vertex[k];
    if (v >= num_cloth_vertices() || (*step_.inverse_mass)[v] == 0) continue;
    if (parent_[v] < 0) {
      parent_[v] = v;
      has_grown_ = true;
    }
    const int other = find_root(v);
    if (root < 0 || root == other) {
      root = other;
      continue;
    }
    parent_[other] = root;
    share_[root] = std::min(share_[root], share_[other]);
    is_halved_[root] |= is_halved_[other];
    is_carried_[root] |= is_carried_[other];
    has_grown_ = true;
  }
  for (int k = 0; k < c.num_vertices; ++k) {
    const int v = c.vertex[k];
    if (v < num_cloth_vertices() && (*step_.inverse_mass)[v] > 0) continue;
    guides_.push_back({root, motion_->start[v], motion_->end[v]});
  }
  if (c.shape >= 0) guides_.push_back({root, hit.foot_start, hit.foot_end});
  if (is_halved_[root] || is_carried_[root]) return;
  is_halved_[root] = 1;
  has_grown_ = true;
  is_carried_[root] = share_[root] == 0;
  share_[root] = share_[root] > kMinShare ? share_[root] / 2 : 0;
}

void CcdFailSafe::gather_zones() {
  zones_.clear();
  std::vector<int> zone_of(parent_.size(), -1);
  for (int v = 0; v < num_cloth_vertices(); ++v) {
    const int root = find_root(v);
    if (root < 0) continue;
    if (zone_of[root] < 0) {
      zone_of[root] = static_cast<int>(zones_.size());
      zones_.push_back({root, {}, {}});
    }
    zones_[zone_of[root]].vertices.push_back(v);
  }
  for (const Guide& guide : guides_) zones_[zone_of[find_root(guide.vertex)]].guides.push_back(&guide);
}

/// Guides weigh so much more than the zone's own motion that the latter only decides the freedom they leave;
/// for a carried zone not even that, so that it cannot rotate into its guides.
void CcdFailSafe::scale_zone(const Zone& zone) {
  constexpr double kGuideWeight = 1e6;
  const bool is_carried = is_carried_[zone.root] && !zone.guides.empty();
  Vec3 carried = Vec3::Zero();
  for (const Guide* guide : zone.guides) carried += (guide->end - guide->start) / zone.guides.size();
  RigidFit fit;
  double mass = 0;
  for (const int v : zone.vertices) {
    const double m = 1 / (*step_.inverse_mass)[v];
    mass += m;
    fit.add(m, motion_->start[v], is_carried ? Vec3(motion_->start[v] + carried) : wanted_[v]);
  }
  for (const Guide* guide : zone.guides) fit.add(kGuideWeight * mass, guide->start, guide->end);
  fit.solve();
  for (const int v : zone.vertices) {
    const Vec3 rigid = fit.apply(motion_->start[v]);
    move(v, rigid + share_[zone.root] * (wanted_[v] - rigid));
  }
}

}  // namespace weft::engine
