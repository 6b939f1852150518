/// ContactSystem's plain shapes: spheres, planes, capsules and boxes, against particles and triangles.

#include <algorithm>
#include <cmath>

#include "weft/contact/contact_system.h"
#include "weft/geometry/distance.h"

namespace weft {
namespace {

/// An edge or a triangle counts beside its corners where it comes this much nearer to a shape than they do
/// [m] …
constexpr double kNearerThanCorners = 1e-6;
/// … and for the solve by this share of half the thickness: what keeps edges and triangles out of the shape.
constexpr double kMuchNearer = 0.6;

/// A shape is round whose radius is so many times the longest edge at rest.
constexpr double kRound = 2.4;

/// Particles keep half the thickness from a shape. What is between them keeps this share of it, so that cloth
/// rests on its particles alone unless cells are coarse: others would bear some of the same weight.
constexpr double kBetweenKeeps = 0.2;

/// A ball around the shape; planes have none.
struct Bound {
  Vec3 center = Vec3::Zero();
  double radius = std::numeric_limits<double>::infinity();
};
Bound bound_of(const Sphere& s) { return {s.center, s.radius}; }
Bound bound_of(const Plane&) { return {}; }
Bound bound_of(const Capsule& c) { return {0.5 * (c.a + c.b), 0.5 * (c.b - c.a).norm() + c.radius}; }
Bound bound_of(const OrientedBox& b) { return {b.center, b.half_size.norm()}; }
Bound bound_of(const MeshShape&) { return {}; }

/// Of balls and capsules; others are sharp.
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

/// `stretch`: how much longer than the lists have it an edge may be [m].
void ContactSystem::collect_shapes(double share_of_travel, double stretch) {
  const WorkScope scope(step_.clock, &WorkTimes::narrow_phase);
  if (!has_plain_shapes()) return;
  longest_edge_ = proximity_.longest_edge() + stretch;
  for (int s = 0; s < static_cast<int>(shapes_.size()); ++s) {
    if (!shapes_[s].is_mesh()) collect_shape(s, share_of_travel);
  }
}

/// Particles nearer than their gap and as much again, and `share_of_travel` of their way in this step; and
/// what is nearer than its corners: triangles, but for the solve on round shapes the middles of edges. A
/// triangle's nearest point runs to and fro over it as it tilts, and a solve that holds it for a step by a
/// point from before trembles.
void ContactSystem::collect_shape(int shape, double share_of_travel) {
  const MovingShape& moving = shapes_[shape];
  const Bound bound = std::visit([](const auto& s) { return bound_of(s); }, moving.after);
  const double triangle_reach = longest_edge_ / std::sqrt(3.0);
  const int num_vertices = first_vertex_.back();
  shape_distance_.resize(num_vertices);
  bool is_any_near = false;
  for (int v = 0; v < num_vertices; ++v) {
    const double reach = shape_reach(v, share_of_travel);
    const Vec3& p = motion_.end[v];
    shape_distance_[v] = std::numeric_limits<double>::infinity();
    const double farthest = bound.radius + reach + triangle_reach;
    if ((p - bound.center).squaredNorm() > farthest * farthest) continue;
    shape_distance_[v] = signed_distance(moving.after, p).distance;
    is_any_near = true;
    if (shape_distance_[v] < reach && inverse_mass_[v] > 0) add_shape_constraint(shape, 1, {v, v, v});
  }
  if (!is_any_near || std::holds_alternative<Plane>(moving.after)) return;
  const bool is_for_solve = share_of_travel > 0;
  const bool is_round = radius_of(moving.after) > kRound * longest_rest_edge_;
  if (is_for_solve && is_round) {
    collect_edges(shape, share_of_travel);
  } else {
    collect_triangles(shape, share_of_travel);
  }
}

/// How near a vertex must be to count [m].
double ContactSystem::shape_reach(int v, double share_of_travel) const {
  return 2 * motion_.half_thickness[v] + share_of_travel * (motion_.end[v] - motion_.start[v]).norm();
}

void ContactSystem::collect_edges(int shape, double share_of_travel) {
  const double edge_reach = longest_edge_ / 2;
  for (const auto& [a, b] : proximity_.surface().edges) {
    if (a >= first_vertex_.back()) break;
    const double nearest = std::min(shape_distance_[a], shape_distance_[b]);
    const double reach = shape_reach(a, share_of_travel);
    if (nearest > reach + edge_reach) continue;
    const Vec3 middle = 0.5 * (motion_.end[a] + motion_.end[b]);
    const double distance = signed_distance(shapes_[shape].after, middle).distance;
    if (distance < std::min(reach, nearest - kMuchNearer * motion_.half_thickness[a]))
      add_shape_constraint(shape, 2, {a, b, b});
  }
}

void ContactSystem::collect_triangles(int shape, double share_of_travel) {
  const double triangle_reach = longest_edge_ / std::sqrt(3.0);
  const std::vector<Vec3>& x = motion_.end;
  for (const Triangle& t : proximity_.surface().triangles) {
    if (t[0] >= first_vertex_.back()) break;
    const double nearest = std::min({shape_distance_[t[0]], shape_distance_[t[1]], shape_distance_[t[2]]});
    const double reach = shape_reach(t[0], share_of_travel);
    if (nearest > reach + triangle_reach) continue;
    const double distance = signed_distance(shapes_[shape].after, x[t[0]], x[t[1]], x[t[2]], reach).distance;
    const double nearer =
        std::max(kNearerThanCorners, share_of_travel * kMuchNearer * motion_.half_thickness[t[0]]);
    if (distance < std::min(reach, nearest - nearer)) add_shape_constraint(shape, 3, t);
  }
}

void ContactSystem::add_shape_constraint(int shape, int num_vertices, const Triangle& vertices) {
  Constraint c;
  c.num_vertices = num_vertices;
  c.vertex = {vertices[0], vertices[1], vertices[2], 0};
  c.shape = shape;
  const PairLaw& law = laws_[law_of(place_of(vertices[0]), {.collider = shape})];
  if (!law.collide) return;
  take_plane(c);
  set_friction(law, c);
  if (c.inverse_mass > 0) constraints_.push_back(c);
}

ContactSystem::Nearest ContactSystem::find_nearest(const ColliderShape& shape, const Constraint& c,
                                                   const std::vector<Vec3>& x) {
  const Vec3 &a = x[c.vertex[0]], &b = x[c.vertex[1]], &e = x[c.vertex[2]];
  if (c.num_vertices < 3) {
    const bool is_edge = c.num_vertices == 2;
    const Vec3 p = is_edge ? Vec3(0.5 * (a + b)) : a;
    const SignedDistance d = signed_distance(shape, p);
    return {d.distance, d.normal, p - d.distance * d.normal,
            is_edge ? std::array<double, 4>{0.5, 0.5, 0, 0} : std::array<double, 4>{1, 0, 0, 0}};
  }
  const TriangleSignedDistance d = signed_distance(shape, a, b, e);
  return {d.distance,
          d.normal,
          point_at(d.weights, a, b, e) - d.distance * d.normal,
          {d.weights[0], d.weights[1], d.weights[2], 0}};
}

/// The plane that touches the shape where the particle, edge or triangle is nearest at the end of the step;
/// unless that lies beyond the shape's middle: then where it was nearest at the start.
void ContactSystem::take_plane(Constraint& c) const {
  const MovingShape& moving = shapes_[c.shape];
  Nearest nearest = find_nearest(moving.after, c, motion_.end);
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
  c.target = c.normal.dot(nearest.foot) + clearance_of(c);
  c.surface_velocity = moving.velocity_at(nearest.foot, step_.step);
  c.inverse_mass = c.inverse_mass_of(inverse_mass_);
}

/// From a plain shape [m].
double ContactSystem::clearance_of(const Constraint& c) const {
  const double share = c.num_vertices == 1 ? 1 - pressed_in_ : kBetweenKeeps;
  return share * motion_.half_thickness[c.vertex[0]];
}

}  // namespace weft
