#pragma once
/// Small contact experiments with a known analytic result: each builds and runs a world, and measures it.
/// `weft bench contact` prints the results; tests check them against tolerances.

#include <string>

#include "weft/core/vec.h"
#include "weft/world/world.h"

namespace weft::engine::lab {

struct ContactExperiment {
  std::string integrator = "newton";
  int cells = 24;             // per side of the cloth [1]
  int steps_per_second = 60;  // [1/s]
};

/// Coulomb's law over the sliding contacts, faster than 5 mm/s, of one step or summed over several.
struct FrictionAudit {
  int sliding = 0;          // contacts [1]
  double tangential = 0;    // Σ |T| [N]
  double limit = 0;         // µ Σ N [N]
  double torque = 0;        // of T on cloth, about the axis [N·m]
  double torque_limit = 0;  // µ Σ N r, r the distance from the axis: if all slide around it [N·m]

  FrictionAudit& operator+=(const FrictionAudit& next);
};

/// A vertical axis by default.
struct Axis {
  Vec3 point = Vec3::Zero();       // [m]
  Vec3 direction = Vec3::UnitY();  // unit length
};

/// Audit of the contacts that a world tracked in its last step, of length `step` [s], all with the same
/// coefficient of friction [1]. The velocity of cloth is that of the nearest particle. The solver's residual
/// at a particle counts as force of its contacts, so that Σ |T| also measures the convergence of the solve.
FrictionAudit audit_friction(const World& world, double step, double friction, const Axis& axis = {});

/// A sheet that starts at rest on a slope.
struct Slide {
  double acceleration = 0;  // down the slope, from the distance in 0.4 s [m/s²]
  double expected = 0;      // g (sin α − µ cos α), or 0 if it sticks [m/s²]
};
Slide slide_on_incline(const ContactExperiment& setup, double angle_deg, double friction);

/// Capstan experiment: a strip over half a turn of a rotating drum, held at both ends. The drum is a capsule,
/// or rigid cloth: a tube of pinned particles.
///
///          ___
///        /  ↻  \          T_tight / T_slack = e^{µ θ},  θ = π
///       |   .   |
///     T_slack  T_tight
struct Capstan {
  double ratio = 0;     // of the tensions at the ends [1]
  double expected = 0;  // [1]
};
enum class Drum { capsule, cloth };
Capstan pull_over_drum(const ContactExperiment& setup, double friction, Drum drum = Drum::capsule);

/// A sheet at rest on a support.
struct RestingSheet {
  double kinetic = 0;  // maximum in the second half of the time [J/kg]
  double speed = 0;    // median of the root mean square in the second half [m/s]
  double drift = 0;    // of the middle in the second half [m]
  double rise = 0;     // maximum rise of the middle in a step, over the whole time [m]
  double force = 0;    // of all contacts over the weight, mean of the second half [1]
};
enum class Support { ball, floor };
RestingSheet rest_on(const ContactExperiment& setup, Support support, double seconds);

/// A sheet on a ball that is spun up to half a turn per second within a second. Not longer, because every
/// sheet slides off a smooth ball.
struct Spin {
  double turned_ball = 0, turned_sheet = 0;  // rotation after that second [rad]
  double expected = 0;     // of a rigid flat sheet: µ g ⟨r⟩/(2⟨r²⟩), or the ball's [rad]
  FrictionAudit friction;  // over that second
  double torque = 0;       // from the sheet's angular momentum, over the audit's limit [1]
};
Spin spin_ball(const ContactExperiment& setup, double friction);

/// A square sheet on a turntable: the floor rotates about the vertical through its middle, with constant
/// angular acceleration from rest.
struct Turntable {
  double acceleration = 0;  // of the sheet's mean angular velocity in 0.3 s [rad/s²]
  /// The smaller of the floor's and a rigid sheet's µ g ⟨r⟩/⟨r²⟩ over its particles. For many particles the
  /// latter is (√2 + asinh 1) µ g over the side [rad/s²].
  double expected = 0;
  FrictionAudit friction;
  double torque = 0;  // as in Spin [1]
};
Turntable turn_table(const ContactExperiment& setup, double friction, double floor_acceleration);

/// A sheet on a larger one, all of whose particles are pinned and move sideways with constant acceleration
/// from rest.
struct CarriedSheet {
  double acceleration = 0;  // of its mean velocity in 0.3 s [m/s²]
  double expected = 0;      // the smaller of the lower one's and µ g [m/s²]
  FrictionAudit friction;
};
CarriedSheet carry_sheet(const ContactExperiment& setup, double friction, double lower_acceleration);

/// A sheet folded in two in free fall, its halves within contact distance of each other.
struct FoldedFall {
  double worst_gain = 0;  // of mean velocity in a step, over g h; the value farthest from 1 [1]
};
FoldedFall drop_fold(const ContactExperiment& setup, double seconds);

/// Two free sheets that collide.
struct Collision {
  double momentum_change = 0;  // maximum, over one sheet's momentum [1]
  int contacts = 0;            // maximum [1]
};
Collision collide_sheets(const ContactExperiment& setup, double seconds);

}  // namespace weft::engine::lab
