#include "weft/contact/solve_contacts.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "weft/contact/shape_constraints.h"

namespace weft::engine {
namespace {

/// Contact stiffness in the solve, relative to the inertia m/h². A higher value lets cloth penetrate less and
/// leaves less to the contact projection. Penetration at rest under gravity is g h²/1000, 3 µm at 60 steps
/// per second.
constexpr double kShapeStiffness = 1000;
constexpr double kPairStiffness = 300;

/// A force that is known before the solve, as that of gas or one that lasts, presses features together by this
/// share of their gap.
constexpr double kPressed = 0.1;

/// Contacts that slide farther than this share of a mean edge in a step have no use for the forces of earlier ones.
constexpr double kFarSlide = 0.5;

/// For contacts that carry the pressure of gas on the particles around them [N/m].
double pressure_stiffness(const Constraint& c, double gap, const StepBodies& bodies) {
  double force = 0;
  for (int k = 0; k < c.num_vertices; ++k) {
    const int v = c.vertex[k];
    if (!bodies.numbering.is_of_cloth(v)) continue;
    const BodyPlace at = bodies.numbering.place_of(v);
    const ContactCloth& cloth = bodies.cloths[at.cloth];
    if (cloth.pressure > 0)
      force += std::abs(c.weight[k]) * cloth.pressure * cloth.model->topology->area[at.index];
  }
  return force / (kPressed * gap);
}

/// Whether the features are predicted to slide over other cells within the step.
bool slides_far(const Constraint& c, const StepBodies& bodies) {
  Vec3 way = -bodies.step * c.surface_velocity;
  double edge = std::numeric_limits<double>::infinity();
  for (int k = 0; k < c.num_vertices; ++k) {
    const int v = c.vertex[k];
    way += c.weight[k] * (bodies.motion.end[v] - bodies.motion.start[v]);
    if (bodies.numbering.is_of_cloth(v)) edge = std::min(edge, bodies.numbering.rest_edges_at(v).mean);
  }
  return (way - way.dot(c.normal) * c.normal).norm() > kFarSlide * edge;
}

/// Penetration of a collider, 0 for cloth. For a primitive shape relative to its start pose, because the
/// constraint's plane moves in a straight line.
double depth_at_start(const Constraint& c, const StepBodies& bodies) {
  if (c.is_caught) return 0;
  if (c.shape >= 0) return bodies.clearance_of(c, Purpose::solve) - distance_at_start(bodies, c);
  return bodies.numbering.is_on_body(c) ? c.target - c.normal.dot(c.sum(bodies.motion.start)) : 0;
}

}  // namespace

Contact make_contact(const Constraint& c, const StepBodies& bodies, const ContactMemory& memory) {
  const double h = bodies.step;
  Contact contact{.num_particles = 0,
                  .normal = c.normal,
                  .offset = c.target,
                  .gap = bodies.gap_of(c, Purpose::solve),
                  .depth_before = depth_at_start(c, bodies),
                  .friction = c.friction,
                  .stick_point = h * c.surface_velocity};
  const double inertial = (c.shape >= 0 ? kShapeStiffness : kPairStiffness) / (c.inverse_mass * h * h),
               usual = std::max(inertial, pressure_stiffness(c, contact.gap, bodies));
  contact.stiffness = usual;
  contact.lasting_force = slides_far(c, bodies) ? 0 : memory.lasting_force(c);
  if (contact.lasting_force > 0) {
    contact.stiffness =
        std::clamp(contact.lasting_force / (kPressed * contact.gap), usual, kMostStiff * usual);
    contact.stiffened = contact.stiffness / usual;
  }
  for (int k = 0; k < c.num_vertices; ++k) {
    const int v = c.vertex[k];
    const double w = c.weight[k];
    if (bodies.numbering.is_of_cloth(v)) {
      const Vec3& origin = bodies.cloths[bodies.numbering.cloth_of(v)].state->origin;
      contact.particle[contact.num_particles] = v;
      contact.weight[contact.num_particles++] = w;
      contact.offset -= w * c.normal.dot(origin);
      contact.stick_point += w * (bodies.motion.start[v] - origin);
    } else {
      contact.offset -= w * c.normal.dot(bodies.motion.end[v]);
      contact.stick_point -= w * (bodies.motion.end[v] - bodies.motion.start[v]);
    }
  }
  return contact;
}

}  // namespace weft::engine
