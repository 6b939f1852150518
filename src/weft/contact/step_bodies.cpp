#include "weft/contact/step_bodies.h"

#include <algorithm>
#include <variant>

namespace weft::engine {
namespace {

constexpr double kSlidingSpeed = 0.01;  // below, static friction applies [m/s]

/// Particles keep half the thickness from a shape. Triangles keep this share of it, so that cloth rests on its
/// particles only: otherwise both would bear some of the same weight.
constexpr double kBetweenKeeps = 0.2;

/// A shape counts as round if its radius is at least this many times the longest edge at rest …
constexpr double kRound = 2.4;
/// … and triangles may sag by this share of half the thickness before particles keep more.
constexpr double kMaySag = 0.5;

/// Penetration that a solve leaves at a collider, below this share of the gap, is kept.
constexpr double kPressedIn = 0.2;

/// Radius of balls and capsules; 0 for other shapes [m].
double radius_of(const ColliderShape& shape) {
  if (const Sphere* sphere = std::get_if<Sphere>(&shape)) return sphere->radius;
  if (const Capsule* capsule = std::get_if<Capsule>(&shape)) return capsule->radius;
  return 0;
}

}  // namespace

double required_share(Purpose purpose) { return purpose == Purpose::after_solve ? 1 - kPressedIn : 1; }

bool StepBodies::has_plain_shapes() const {
  return std::any_of(shapes.begin(), shapes.end(), [](const MovingShape& shape) { return !shape.is_mesh(); });
}

double StepBodies::friction_of(const PairSettings& settings, const Constraint& c) const {
  if (!settings.has_static_friction()) return settings.friction;
  Vec3 slide = -c.surface_velocity;
  for (int k = 0; k < c.num_vertices; ++k) slide += c.weight[k] * velocity_before[c.vertex[k]];
  slide -= slide.dot(c.normal) * c.normal;
  return slide.norm() < kSlidingSpeed ? settings.static_friction : settings.friction;
}

bool StepBodies::is_round(int shape, int vertex) const {
  return radius_of(shapes[shape].after) > kRound * numbering.rest_edges_at(vertex).longest;
}

/// A chord of radius r sags by r²/2R on a sphere of radius R.
double StepBodies::lift_of(int shape, int vertex, Purpose purpose) const {
  if (purpose == Purpose::projection || !is_round(shape, vertex)) return 0;
  const double sag = numbering.rest_circle_sq[vertex] / (2 * radius_of(shapes[shape].after));
  return std::max(0.0, sag - kMaySag * motion.half_thickness[vertex]);
}

/// The minimal enclosing circle of a triangle has a radius of at most its longest edge over √3 (Jung).
double StepBodies::most_lift() const {
  double longest = 0;
  for (const RestEdges& edges : numbering.rest_edges) longest = std::max(longest, edges.longest);
  return longest / (6 * kRound);
}

double StepBodies::clearance_of(const Constraint& c, Purpose purpose) const {
  const bool is_lifted = c.num_vertices == 1 && !c.is_between;
  return gap_of(c, purpose) + (is_lifted ? lift_of(c.shape, c.vertex[0], purpose) : 0);
}

double StepBodies::gap_of(const Constraint& c, Purpose purpose) const {
  if (c.shape >= 0) {
    const double share = c.num_vertices == 1 ? required_share(purpose) : kBetweenKeeps;
    return share * motion.half_thickness[c.vertex[0]];
  }
  return motion.half_thickness[c.vertex[0]] + motion.half_thickness[c.vertex[3]];
}

}  // namespace weft::engine
