#pragma once
/// Energy audit of a step: the change of a world's energy, and the work that caused it.
///
///     Δ(kinetic + elastic + bending + gravitational) = W_pins + W_shapes + W_wind + W_hands + left over
///
/// What is left over is negative where damping, friction or the integrator dissipate, positive where energy
/// is made from nothing.
///
///     const AuditStart start = begin_energy_audit(world);
///     world.step(dt);
///     const EnergyAudit audit = finish_energy_audit(start, world);
///
/// Work is a force at the end of the step times the displacement in it, the balance of implicit Euler; the
/// error for smooth motion is of first order in the step. Work of shapes, and of pins against contacts, needs
/// World::track_contacts(true) before the step. Of a step cut into substeps (`explicit`, `xpbd`) the forces
/// are those of the last one: an audit of these needs steps of one substep.

#include "weft/world/world.h"

namespace weft::engine {

/// Energies of all cloths [J].
struct WorldEnergy {
  double kinetic = 0;
  double elastic = 0;  // of stretching and shearing
  double bending = 0;
  double gravitational = 0;  // zero at the world's origin

  double potential() const { return elastic + bending + gravitational; }
  double total() const { return kinetic + potential(); }
};

WorldEnergy compute_energy(const World& world);

/// The world before the step.
struct AuditStart {
  World::Snapshot state;
  WorldEnergy energy;
};

/// Of one step, or of several one after the other [J].
struct EnergyAudit {
  WorldEnergy energy;      // at the end
  double work_pins = 0;    // of pins that move, by their reaction m a − F; 0 exactly of pins that do not
  double work_shapes = 0;  // of colliders that move, by the contacts' forces
  double work_wind = 0;    // of the wind's drag, and of the air's drag and lift; still air takes energy
  double work_hands = 0;   // of grabs, by their springs and dampers
  double left_over = 0;

  double work() const { return work_pins + work_shapes + work_wind + work_hands; }
  EnergyAudit& operator+=(const EnergyAudit& next);
};

AuditStart begin_energy_audit(const World& world);

/// The world after one step from `start`, with the same cloths, pins, grabs, wind and colliders as during it.
/// A step that failed has no work, and leaves nothing over.
EnergyAudit finish_energy_audit(const AuditStart& start, const World& world);

}  // namespace weft::engine
