#pragma once
/// Energy audit of a step: the change of a world's energy, and the work that caused it.
///
///     Δ(kinetic + elastic + bending + gravitational) = W_pins + W_shapes + W_wind + W_grabs + left_over
///
/// `left_over` is negative where damping, friction or the integrator dissipates energy, and positive where
/// energy is created.
///
///     const AuditStart start = begin_energy_audit(world);
///     world.step(dt);
///     const EnergyAudit audit = finish_energy_audit(start, world);
///
/// Work is the force at the end of the step times the displacement in it, as implicit Euler balances energy.
/// For smooth motion the error is of first order in the step. The work of shapes, and of pins against
/// contacts, requires World::track_contacts(true) before the step. For a step with substeps (`explicit`,
/// `xpbd`) the forces are those of the last one: audit these integrators with steps of one substep.

#include "weft/world/world.h"

namespace weft::engine {

/// Energies of all cloths [J].
struct WorldEnergy {
  double kinetic = 0;
  double elastic = 0;  // stretching and shearing
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

/// Audit of one step, or of several consecutive ones [J].
struct EnergyAudit {
  WorldEnergy energy;      // at the end
  double work_pins = 0;    // of moving pins, by their reaction m a − F; exactly 0 for pins at rest
  double work_shapes = 0;  // of moving colliders, by the contact forces
  double work_wind = 0;    // of wind drag, and aerodynamic drag and lift; still air takes energy
  double work_hands = 0;   // of grabs, by their springs and dampers, and of closing seams
  double left_over = 0;

  double work() const { return work_pins + work_shapes + work_wind + work_hands; }
  EnergyAudit& operator+=(const EnergyAudit& next);
};

AuditStart begin_energy_audit(const World& world);

/// `world` must be one step after `start`, with the same cloths, pins, grabs, wind and colliders as during
/// it. For a failed step work and left_over are zero.
EnergyAudit finish_energy_audit(const AuditStart& start, const World& world);

}  // namespace weft::engine
