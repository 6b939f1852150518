#include "weft/contact/shape_constraints.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "weft/geometry/distance.h"
#include "weft/geometry/shape_distance.h"

namespace weft::engine {
namespace {

/// An edge or a triangle gets its own constraint, besides those of its corners, where it comes nearer to a
/// shape than they do by this distance [m] …
constexpr double kNearerThanCorners = 1e-6;
/// … and for the solve by this share of half the thickness: it keeps edges and triangles out of the shape.
constexpr double kMuchNearer = 0.6;

/// A shape counts as round if its radius is at least this many times the longest edge at rest.
constexpr double kRound = 2.4;

/// The point of a particle, edge midpoint or triangle that is nearest to a primitive shape.
struct Nearest {
  double distance;
  Vec3 normal, foot;  // outwards; on the surface
  std::array<double, 4> weight;
};

/// Radius of spheres and capsules; other shapes are sharp.
double radius_of(const ColliderShape& shape) {
  if (const Sphere* sphere = std::get_if<Sphere>(&shape)) return sphere->radius;
  if (const Capsule* capsule = std::get_if<Capsule>(&shape)) return capsule->radius;
  return 0;
}

Nearest nearest_of(const SignedDistance& d, const Vec3& p, const std::array<double, 4>& weight) {
  return {d.distance, d.normal, p - d.distance * d.normal, weight};
}

Nearest nearest_of(const TriangleSignedDistance& d, const Vec3& a, const Vec3& b, const Vec3& c) {
  const Vec3& w = d.weights;
  return {d.distance, d.normal, point_at(w, a, b, c) - d.distance * d.normal, {w[0], w[1], w[2], 0}};
}

Nearest find_nearest(const ColliderShape& shape, const Constraint& c, const std::vector<Vec3>& x) {
  const Vec3 &a = x[c.vertex[0]], &b = x[c.vertex[1]], &e = x[c.vertex[2]];
  if (c.num_vertices == 1) return nearest_of(signed_distance(shape, a), a, {1, 0, 0, 0});
  if (c.num_vertices == 3) return nearest_of(signed_distance(shape, a, b, e), a, b, e);
  const Vec3 middle = 0.5 * (a + b);
  return nearest_of(signed_distance(shape, middle), middle, {0.5, 0.5, 0, 0});
}

/// How much of an edge's or a triangle's depth in a primitive shape is that of pinned particles, which nothing can push
/// out [m]. The free ones beside them would have to make up for it, many times as far.
double pinned_depth(const StepBodies& bodies, Purpose purpose, const Constraint& c) {
  double depth = 0;
  for (int k = 0; k < c.num_vertices; ++k) {
    const int v = c.vertex[k];
    if (bodies.inverse_mass[v] > 0) continue;
    const double distance = signed_distance(bodies.shapes[c.shape].after, bodies.motion.end[v]).distance;
    depth += c.weight[k] * std::max(0.0, bodies.clearance_of(c, purpose) - distance);
  }
  return depth;
}

/// If the point nearest at the end of the step lies beyond the shape's middle, the nearest point at the start is
/// used.
void set_plane(const StepBodies& bodies, Purpose purpose, const Nearest& at_end, Constraint& c) {
  const MovingShape& moving = bodies.shapes[c.shape];
  Nearest nearest = at_end;
  if (nearest.distance < 0) {
    const Nearest before = find_nearest(moving.before, c, bodies.motion.start);
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
  c.target = c.normal.dot(nearest.foot) + bodies.clearance_of(c, purpose) - pinned_depth(bodies, purpose, c);
  c.surface_velocity = moving.velocity_at(nearest.foot, bodies.step);
  c.inverse_mass = c.inverse_mass_of(bodies.inverse_mass);
}

/// The distance below which a vertex counts [m].
double reach_of(const ShapeConstraints::Input& in, int v) {
  const SurfaceMotion& motion = in.bodies.motion;
  return 2 * motion.half_thickness[v] + in.share_of_travel * (motion.end[v] - motion.start[v]).norm();
}

void add_constraint(const ShapeConstraints::Input& in, int shape, int num_vertices, const Triangle& vertices,
                    const Nearest& nearest, std::vector<Constraint>& constraints) {
  const int cloth = in.bodies.numbering.cloth_of(vertices[0]);
  const PairSettings& settings = in.bodies.pairs.of({.cloth = cloth}, {.collider = shape});
  if (!settings.collide) return;
  Constraint c;
  c.num_vertices = num_vertices;
  c.vertex = {vertices[0], vertices[1], vertices[2], 0};
  c.shape = shape;
  set_plane(in.bodies, in.purpose, nearest, c);
  c.friction = in.bodies.friction_of(settings, c);
  if (c.inverse_mass > 0 && !in.caught.replaces(c)) constraints.push_back(c);
}

}  // namespace

void update_plane(const StepBodies& bodies, Purpose purpose, Constraint& c) {
  set_plane(bodies, purpose, find_nearest(bodies.shapes[c.shape].after, c, bodies.motion.end), c);
}

double distance_at_start(const StepBodies& bodies, const Constraint& c) {
  return find_nearest(bodies.shapes[c.shape].before, c, bodies.motion.start).distance;
}

bool is_round(const StepBodies& bodies, int shape) {
  return radius_of(bodies.shapes[shape].after) > kRound * bodies.numbering.longest_rest_edge;
}

void ShapeConstraints::begin_step(const StepBodies& bodies, double travel) {
  clearance_.begin_step(bodies.shapes, bodies.num_cloth_vertices(), travel);
}

bool ShapeConstraints::generate(const Input& in, std::vector<Constraint>& constraints) {
  const StepBodies& bodies = in.bodies;
  if (!bodies.has_plain_shapes()) return false;
  constexpr double kRoom = 1e-4;  // more than the CCD fail-safe needs [m]
  const double way = farthest_way(bodies.motion, bodies.num_cloth_vertices()),
               reach = 2 * bodies.thickest + in.longest_edge + kRoom;
  bool is_near = false;
  for (int s = 0; s < static_cast<int>(bodies.shapes.size()); ++s) {
    if (bodies.shapes[s].is_mesh()) continue;
    clearance_.find_near(s, (1 + in.share_of_travel) * way, reach, near_);
    if (near_.empty()) continue;
    is_near = true;
    generate_for(in, s, constraints);
  }
  return is_near;
}

/// Particles in reach; and triangles that are nearer than their corners. For the solve on round shapes edge
/// midpoints replace triangles: a triangle's nearest point moves across it as it tilts, and a solve that keeps
/// an earlier point for a step jitters.
void ShapeConstraints::generate_for(const Input& in, int shape, std::vector<Constraint>& constraints) {
  const StepBodies& bodies = in.bodies;
  const std::vector<Vec3>& x = bodies.motion.end;
  const ColliderShape& at_end = bodies.shapes[shape].after;
  distance_.assign(bodies.num_cloth_vertices(), std::numeric_limits<double>::infinity());
  for (const int v : near_) {
    const SignedDistance d = signed_distance(at_end, x[v]);
    clearance_.set(shape, v, d.distance, (x[v] - bodies.motion.start[v]).norm());
    distance_[v] = d.distance;
    if (d.distance < reach_of(in, v) && bodies.inverse_mass[v] > 0)
      add_constraint(in, shape, 1, {v, v, v}, nearest_of(d, x[v], {1, 0, 0, 0}), constraints);
  }
  if (std::holds_alternative<Plane>(at_end)) return;
  if (in.purpose == Purpose::solve && is_round(bodies, shape))
    generate_for_edges(in, shape, constraints);
  else
    generate_for_triangles(in, shape, constraints);
}

void ShapeConstraints::generate_for_edges(const Input& in, int shape,
                                          std::vector<Constraint>& constraints) const {
  const StepBodies& bodies = in.bodies;
  const std::vector<Vec3>& x = bodies.motion.end;
  const double edge_reach = in.longest_edge / 2;
  for (const auto& [a, b] : bodies.surface->edges) {
    if (!bodies.numbering.is_of_cloth(a)) break;
    const double nearest = std::min(distance_[a], distance_[b]), reach = reach_of(in, a);
    if (nearest > reach + edge_reach) continue;
    const Vec3 middle = 0.5 * (x[a] + x[b]);
    const SignedDistance d = signed_distance(bodies.shapes[shape].after, middle);
    if (d.distance < std::min(reach, nearest - kMuchNearer * bodies.motion.half_thickness[a]))
      add_constraint(in, shape, 2, {a, b, b}, nearest_of(d, middle, {0.5, 0.5, 0, 0}), constraints);
  }
}

void ShapeConstraints::generate_for_triangles(const Input& in, int shape,
                                              std::vector<Constraint>& constraints) const {
  const StepBodies& bodies = in.bodies;
  const std::vector<Vec3>& x = bodies.motion.end;
  const double triangle_reach = in.longest_edge / std::sqrt(3.0);
  for (const Triangle& t : bodies.surface->triangles) {
    if (!bodies.numbering.is_of_cloth(t[0])) break;
    const double nearest = std::min({distance_[t[0]], distance_[t[1]], distance_[t[2]]});
    const double reach = reach_of(in, t[0]);
    if (nearest > reach + triangle_reach) continue;
    const double nearer =
        std::max(kNearerThanCorners,
                 in.purpose == Purpose::solve ? kMuchNearer * bodies.motion.half_thickness[t[0]] : 0.0);
    const double farthest = std::min(reach, nearest - nearer);
    const TriangleSignedDistance d =
        signed_distance(bodies.shapes[shape].after, x[t[0]], x[t[1]], x[t[2]], farthest);
    if (d.distance < farthest)
      add_constraint(in, shape, 3, t, nearest_of(d, x[t[0]], x[t[1]], x[t[2]]), constraints);
  }
}

}  // namespace weft::engine
