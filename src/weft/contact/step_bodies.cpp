#include "weft/contact/step_bodies.h"

#include <algorithm>

namespace weft::engine {
namespace {

constexpr double kSlidingSpeed = 0.01;  // below, static friction applies [m/s]

/// Particles keep half the thickness from a shape. Edges and triangles keep this share of it, so that cloth
/// rests on its particles only, unless cells are coarse: otherwise both would bear some of the same weight.
constexpr double kBetweenKeeps = 0.2;

/// Penetration that a solve leaves at a collider, below this share of the gap, is kept.
constexpr double kPressedIn = 0.2;

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

double StepBodies::clearance_of(const Constraint& c, Purpose purpose) const {
  const double share = c.num_vertices == 1 ? required_share(purpose) : kBetweenKeeps;
  return share * motion.half_thickness[c.vertex[0]];
}

double StepBodies::gap_of(const Constraint& c, Purpose purpose) const {
  if (c.shape >= 0) return clearance_of(c, purpose);
  return motion.half_thickness[c.vertex[0]] + motion.half_thickness[c.vertex[3]];
}

}  // namespace weft::engine
