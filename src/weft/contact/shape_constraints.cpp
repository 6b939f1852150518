#include "weft/contact/shape_constraints.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "weft/geometry/distance.h"
#include "weft/geometry/shape_distance.h"

namespace weft::engine {
namespace {

/// A triangle gets its own constraint, besides those of its corners, where it comes nearer to a shape than they
/// do by this distance [m] …
constexpr double kNearerThanCorners = 1e-6;
/// … and for the solve by this share of half the thickness: it keeps triangles out of the shape.
constexpr double kMuchNearer = 0.6;

/// The point of a particle or triangle that is nearest to a primitive shape.
struct Nearest {
  double distance;
  Vec3 normal, foot;  // outwards; on the surface
  std::array<double, 4> weight;
};

Nearest nearest_of(const SignedDistance& d, const Vec3& p) {
  return {d.distance, d.normal, p - d.distance * d.normal, {1, 0, 0, 0}};
}

Nearest nearest_of(const TriangleSignedDistance& d, const Vec3& a, const Vec3& b, const Vec3& c) {
  const Vec3& w = d.weights;
  return {d.distance, d.normal, point_at(w, a, b, c) - d.distance * d.normal, {w[0], w[1], w[2], 0}};
}

Nearest find_nearest(const ColliderShape& shape, const Constraint& c, const std::vector<Vec3>& x) {
  const Vec3 &a = x[c.vertex[0]], &b = x[c.vertex[1]], &e = x[c.vertex[2]];
  if (c.num_vertices == 1) return nearest_of(signed_distance(shape, a), a);
  return nearest_of(signed_distance(shape, a, b, e), a, b, e);
}

/// How much of a triangle's depth in a primitive shape is that of pinned particles, which nothing can push
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

/// Adds a triangle's constraint where it is nearer to the shape than its corners, of which one is `nearest`.
void add_triangle(const ShapeConstraints::Input& in, int shape, const Triangle& t, double nearest,
                  std::vector<Constraint>& constraints) {
  const std::vector<Vec3>& x = in.bodies.motion.end;
  const double nearer =
      std::max(kNearerThanCorners,
               in.purpose == Purpose::solve ? kMuchNearer * in.bodies.motion.half_thickness[t[0]] : 0.0);
  const double farthest = std::min(reach_of(in, t[0]), nearest - nearer);
  const TriangleSignedDistance d =
      signed_distance(in.bodies.shapes[shape].after, x[t[0]], x[t[1]], x[t[2]], farthest);
  if (d.distance < farthest)
    add_constraint(in, shape, 3, t, nearest_of(d, x[t[0]], x[t[1]], x[t[2]]), constraints);
}

}  // namespace

void update_plane(const StepBodies& bodies, Purpose purpose, Constraint& c) {
  set_plane(bodies, purpose, find_nearest(bodies.shapes[c.shape].after, c, bodies.motion.end), c);
}

double distance_at_start(const StepBodies& bodies, const Constraint& c) {
  return find_nearest(bodies.shapes[c.shape].before, c, bodies.motion.start).distance;
}

void ShapeConstraints::begin_step(const StepBodies& bodies, double travel) {
  clearance_.begin_step(bodies.shapes, bodies.num_cloth_vertices(), travel);
}

bool ShapeConstraints::generate(const Input& in, double longest_edge, std::vector<Constraint>& constraints) {
  const StepBodies& bodies = in.bodies;
  if (!bodies.has_plain_shapes()) return false;
  constexpr double kRoom = 1e-4;  // more than the CCD fail-safe needs [m]
  const double way = farthest_way(bodies.motion, bodies.num_cloth_vertices()),
               reach = 2 * bodies.thickest + longest_edge + kRoom;
  bool is_near = false;
  for (int s = 0; s < static_cast<int>(bodies.shapes.size()); ++s) {
    if (bodies.shapes[s].is_mesh()) continue;
    clearance_.find_near(s, (1 + in.share_of_travel) * way, reach, near_);
    if (near_.empty()) continue;
    is_near = true;
    generate_for(in, s, longest_edge, constraints);
  }
  return is_near;
}

/// Particles in reach; and triangles that are nearer than their corners.
void ShapeConstraints::generate_for(const Input& in, int shape, double longest_edge,
                                    std::vector<Constraint>& constraints) {
  const StepBodies& bodies = in.bodies;
  const std::vector<Vec3>& x = bodies.motion.end;
  const ColliderShape& at_end = bodies.shapes[shape].after;
  distance_.assign(bodies.num_cloth_vertices(), std::numeric_limits<double>::infinity());
  for (const int v : near_) {
    const SignedDistance d = signed_distance(at_end, x[v]);
    clearance_.set(shape, v, d.distance, (x[v] - bodies.motion.start[v]).norm());
    distance_[v] = d.distance;
    const double reach = reach_of(in, v) + bodies.lift_of(shape, v, in.purpose);
    if (d.distance < reach && bodies.inverse_mass[v] > 0)
      add_constraint(in, shape, 1, {v, v, v}, nearest_of(d, x[v]), constraints);
  }
  if (!std::holds_alternative<Plane>(at_end)) generate_for_triangles(in, shape, longest_edge, constraints);
}

/// In a solve not on round shapes: the nearest point of a triangle moves across it as it tilts, and a solve that keeps
/// an earlier point for a step jitters.
void ShapeConstraints::generate_for_triangles(const Input& in, int shape, double longest_edge,
                                              std::vector<Constraint>& constraints) const {
  const StepBodies& bodies = in.bodies;
  const double triangle_reach = longest_edge / std::sqrt(3.0);
  for (const Triangle& t : bodies.surface->triangles) {
    if (!bodies.numbering.is_of_cloth(t[0])) break;
    if (in.purpose == Purpose::solve && bodies.is_round(shape, t[0])) continue;
    const double nearest = std::min({distance_[t[0]], distance_[t[1]], distance_[t[2]]});
    if (nearest <= reach_of(in, t[0]) + triangle_reach) add_triangle(in, shape, t, nearest, constraints);
  }
}

void ShapeConstraints::lower_between(const Input& in, std::span<const Constraint> before,
                                     std::vector<Constraint>& constraints) const {
  const StepBodies& bodies = in.bodies;
  if (bodies.shapes.size() < 2) return;
  std::vector<std::pair<int, int>> lifted;  // vertices, and numbers of constraints
  for (std::size_t n = 0; n < constraints.size(); ++n) {
    const Constraint& c = constraints[n];
    if (c.shape >= 0 && !c.is_caught && c.num_vertices == 1 && !c.is_between &&
        bodies.lift_of(c.shape, c.vertex[0], in.purpose) > 0)
      lifted.emplace_back(c.vertex[0], static_cast<int>(n));
  }
  if (lifted.empty()) return;
  std::sort(lifted.begin(), lifted.end());
  std::vector<std::pair<int, int>> beside;  // shapes, and triangles at lowered particles
  const auto lower_at = [&](int vertex, const auto& is_chosen) {
    auto at = std::lower_bound(lifted.begin(), lifted.end(), std::pair(vertex, 0));
    for (; at != lifted.end() && at->first == vertex; ++at) {
      Constraint& c = constraints[at->second];
      if (c.is_between || !is_chosen(c)) continue;
      c.is_between = true;
      c.target -= bodies.lift_of(c.shape, vertex, in.purpose);
      for (const int t : bodies.surface->triangles_at(vertex)) beside.emplace_back(c.shape, t);
    }
  };
  for (const Constraint& c : before) {
    if (c.is_between) lower_at(c.vertex[0], [&](const Constraint& now) { return now.shape == c.shape; });
  }
  for (const Constraint& c : constraints) {
    if (c.is_caught || (c.shape < 0 && !bodies.numbering.is_on_body(c))) continue;
    for (int k = 0; k < c.num_vertices; ++k) {
      if (!bodies.numbering.is_of_cloth(c.vertex[k]) || c.weight[k] == 0) continue;
      const double side = c.weight[k] < 0 ? -1 : 1;
      lower_at(c.vertex[k], [&](const Constraint& now) { return side * now.normal.dot(c.normal) < 0; });
    }
  }
  if (in.purpose != Purpose::solve) return;  // triangles have constraints already
  std::sort(beside.begin(), beside.end());
  beside.erase(std::unique(beside.begin(), beside.end()), beside.end());
  std::vector<std::pair<int, Triangle>> known;
  for (const Constraint& c : constraints) {
    if (c.shape >= 0 && c.num_vertices == 3)
      known.push_back({c.shape, {c.vertex[0], c.vertex[1], c.vertex[2]}});
  }
  std::sort(known.begin(), known.end());
  for (const auto& [shape, t] : beside) {
    const Triangle& corners = bodies.surface->triangles[t];
    if (std::binary_search(known.begin(), known.end(), std::pair(shape, corners))) continue;
    double nearest = std::numeric_limits<double>::infinity();
    for (const int v : corners)
      nearest = std::min(nearest, signed_distance(bodies.shapes[shape].after, bodies.motion.end[v]).distance);
    add_triangle(in, shape, corners, nearest, constraints);
  }
}

}  // namespace weft::engine
