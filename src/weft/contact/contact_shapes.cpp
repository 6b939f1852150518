/// ContactSystem's primitive shapes: spheres, planes, capsules and boxes, against particles and triangles.

#include <algorithm>
#include <cmath>
#include <limits>

#include "weft/contact/contact_system.h"
#include "weft/geometry/distance.h"

namespace weft::engine {
namespace {

/// An edge or a triangle gets its own constraint, besides those of its corners, where it comes nearer to a
/// shape than they do by this distance [m] …
constexpr double kNearerThanCorners = 1e-6;
/// … and for the solve by this share of half the thickness: it keeps edges and triangles out of the shape.
constexpr double kMuchNearer = 0.6;

/// A shape counts as round if its radius is at least this many times the longest edge at rest.
constexpr double kRound = 2.4;

/// Particles keep half the thickness from a shape. Edges and triangles keep this share of it, so that cloth
/// rests on its particles only, unless cells are coarse: otherwise both would bear some of the same weight.
constexpr double kBetweenKeeps = 0.2;

/// Radius of spheres and capsules; other shapes are sharp.
double radius_of(const ColliderShape& shape) {
  if (const Sphere* sphere = std::get_if<Sphere>(&shape)) return sphere->radius;
  if (const Capsule* capsule = std::get_if<Capsule>(&shape)) return capsule->radius;
  return 0;
}

}  // namespace

bool ContactSystem::has_plain_shapes() const {
  return std::any_of(shapes_.begin(), shapes_.end(),
                     [](const MovingShape& shape) { return !shape.is_mesh(); });
}

/// `stretch`: how much longer than in the lists an edge may be [m].
void ContactSystem::generate_shape_constraints(double share_of_travel, double stretch) {
  const WorkScope scope(step_.clock, &WorkTimes::narrow_phase);
  is_near_shape_ = false;
  add_caught_constraints();
  if (!has_plain_shapes()) return;
  longest_edge_ = proximity_.longest_edge() + stretch;
  constexpr double kRoom = 1e-4;  // more than the CCD fail-safe needs [m]
  const double way = farthest_way(motion_, first_vertex_.back()),
               reach = 2 * thickest_ + longest_edge_ + kRoom;
  for (int s = 0; s < static_cast<int>(shapes_.size()); ++s) {
    if (shapes_[s].is_mesh()) continue;
    clearance_.find_near(s, (1 + share_of_travel) * way, reach, near_shape_);
    if (near_shape_.empty()) continue;
    is_near_shape_ = true;
    generate_constraints_of_shape(s, share_of_travel);
  }
}

/// Particles nearer than twice their gap plus `share_of_travel` of their motion in this step; and triangles
/// that are nearer than their corners. For the solve on round shapes edge midpoints replace triangles: a
/// triangle's nearest point moves across it as it tilts, and a solve that keeps an earlier point for a step
/// jitters.
void ContactSystem::generate_constraints_of_shape(int shape, double share_of_travel) {
  const MovingShape& moving = shapes_[shape];
  shape_distance_.assign(first_vertex_.back(), std::numeric_limits<double>::infinity());
  int cloth = 0;
  for (const int v : near_shape_) {
    const SignedDistance d = signed_distance(moving.after, motion_.end[v]);
    clearance_.set(shape, v, d.distance, (motion_.end[v] - motion_.start[v]).norm());
    shape_distance_[v] = d.distance;
    while (v >= first_vertex_[cloth + 1]) ++cloth;
    if (d.distance < shape_reach(v, share_of_travel) && inverse_mass_[v] > 0)
      add_shape_constraint(cloth, shape, 1, {v, v, v}, nearest_of(d, motion_.end[v], {1, 0, 0, 0}));
  }
  if (std::holds_alternative<Plane>(moving.after)) return;
  if (is_for_solve_ && is_round(shape)) {
    generate_edge_constraints(shape, share_of_travel);
  } else {
    generate_triangle_constraints(shape, share_of_travel);
  }
}

bool ContactSystem::is_round(int shape) const {
  return radius_of(shapes_[shape].after) > kRound * longest_rest_edge_;
}

/// The distance below which a vertex counts [m].
double ContactSystem::shape_reach(int v, double share_of_travel) const {
  return 2 * motion_.half_thickness[v] + share_of_travel * (motion_.end[v] - motion_.start[v]).norm();
}

void ContactSystem::generate_edge_constraints(int shape, double share_of_travel) {
  const double edge_reach = longest_edge_ / 2;
  int cloth = 0;
  for (const auto& [a, b] : proximity_.surface().edges) {
    if (a >= first_vertex_.back()) break;
    const double nearest = std::min(shape_distance_[a], shape_distance_[b]);
    const double reach = shape_reach(a, share_of_travel);
    if (nearest > reach + edge_reach) continue;
    const Vec3 middle = 0.5 * (motion_.end[a] + motion_.end[b]);
    const SignedDistance d = signed_distance(shapes_[shape].after, middle);
    while (a >= first_vertex_[cloth + 1]) ++cloth;
    if (d.distance < std::min(reach, nearest - kMuchNearer * motion_.half_thickness[a]))
      add_shape_constraint(cloth, shape, 2, {a, b, b}, nearest_of(d, middle, {0.5, 0.5, 0, 0}));
  }
}

void ContactSystem::generate_triangle_constraints(int shape, double share_of_travel) {
  const double triangle_reach = longest_edge_ / std::sqrt(3.0);
  const std::vector<Vec3>& x = motion_.end;
  int cloth = 0;
  for (const Triangle& t : proximity_.surface().triangles) {
    if (t[0] >= first_vertex_.back()) break;
    const double nearest = std::min({shape_distance_[t[0]], shape_distance_[t[1]], shape_distance_[t[2]]});
    const double reach = shape_reach(t[0], share_of_travel);
    if (nearest > reach + triangle_reach) continue;
    const double nearer =
        std::max(kNearerThanCorners, is_for_solve_ ? kMuchNearer * motion_.half_thickness[t[0]] : 0.0);
    const double farthest = std::min(reach, nearest - nearer);
    const TriangleSignedDistance d =
        signed_distance(shapes_[shape].after, x[t[0]], x[t[1]], x[t[2]], farthest);
    while (t[0] >= first_vertex_[cloth + 1]) ++cloth;
    if (d.distance < farthest)
      add_shape_constraint(cloth, shape, 3, t, nearest_of(d, x[t[0]], x[t[1]], x[t[2]]));
  }
}

void ContactSystem::add_shape_constraint(int cloth, int shape, int num_vertices, const Triangle& vertices,
                                         const Nearest& nearest) {
  const PairSettings& settings = pair_settings_[pair_index({.cloth = cloth}, {.collider = shape})];
  if (!settings.collide) return;
  Constraint c;
  c.num_vertices = num_vertices;
  c.vertex = {vertices[0], vertices[1], vertices[2], 0};
  c.shape = shape;
  update_plane(nearest, c);
  set_friction(settings, c);
  if (c.inverse_mass > 0 && !is_between(c)) constraints_.push_back(c);
}

ContactSystem::Nearest ContactSystem::nearest_of(const SignedDistance& d, const Vec3& p,
                                                 const std::array<double, 4>& weight) {
  return {d.distance, d.normal, p - d.distance * d.normal, weight};
}

ContactSystem::Nearest ContactSystem::nearest_of(const TriangleSignedDistance& d, const Vec3& a,
                                                 const Vec3& b, const Vec3& c) {
  const Vec3& w = d.weights;
  return {d.distance, d.normal, point_at(w, a, b, c) - d.distance * d.normal, {w[0], w[1], w[2], 0}};
}

ContactSystem::Nearest ContactSystem::find_nearest(const ColliderShape& shape, const Constraint& c,
                                                   const std::vector<Vec3>& x) {
  const Vec3 &a = x[c.vertex[0]], &b = x[c.vertex[1]], &e = x[c.vertex[2]];
  if (c.num_vertices == 1) return nearest_of(signed_distance(shape, a), a, {1, 0, 0, 0});
  if (c.num_vertices == 3) return nearest_of(signed_distance(shape, a, b, e), a, b, e);
  const Vec3 middle = 0.5 * (a + b);
  return nearest_of(signed_distance(shape, middle), middle, {0.5, 0.5, 0, 0});
}

/// Tangent plane of the shape at its point nearest to the particle, edge or triangle at the end of the step
/// (`at_end`). If that point lies beyond the shape's middle, the nearest point at the start is used.
void ContactSystem::update_plane(const Nearest& at_end, Constraint& c) const {
  const MovingShape& moving = shapes_[c.shape];
  Nearest nearest = at_end;
  if (nearest.distance < 0) {
    const Nearest before = find_nearest(moving.before, c, motion_.start);
    const Vec3 normal_before = moving.turned(before.normal);
    if (before.distance > 0 && nearest.normal.dot(normal_before) <= 0) {
      c.is_fixed = true;
      nearest = before;
      nearest.normal = normal_before;
      nearest.foot = moving.at_end(before.foot);
    }
  }
  c.normal = nearest.normal;
  c.weight = nearest.weight;
  c.target = c.normal.dot(nearest.foot) + clearance_of(c) - pinned_depth(c);
  c.surface_velocity = moving.velocity_at(nearest.foot, step_.step);
  c.inverse_mass = c.inverse_mass_of(inverse_mass_);
}

/// How much of an edge's or a triangle's depth in a primitive shape is that of pinned particles, which nothing can push
/// out [m]. The free ones beside them would have to make up for it, many times as far.
double ContactSystem::pinned_depth(const Constraint& c) const {
  double depth = 0;
  for (int k = 0; k < c.num_vertices; ++k) {
    const int v = c.vertex[k];
    if (inverse_mass_[v] > 0) continue;
    const double distance = signed_distance(shapes_[c.shape].after, motion_.end[v]).distance;
    depth += c.weight[k] * std::max(0.0, clearance_of(c) - distance);
  }
  return depth;
}

/// Separating axes for the CCD fail-safe, from the triangles that project_contacts found.
void ContactSystem::find_separations() {
  separations_.clear();
  for (const Constraint& c : constraints_) {
    if (c.shape < 0 || c.num_vertices < 3) continue;
    separations_.push_back({c.shape, {c.vertex[0], c.vertex[1], c.vertex[2]}, c.normal});
  }
}

/// Required distance from a primitive shape [m].
double ContactSystem::clearance_of(const Constraint& c) const {
  const double share = c.num_vertices == 1 ? 1 - pressed_in_ : kBetweenKeeps;
  return share * motion_.half_thickness[c.vertex[0]];
}

}  // namespace weft::engine
