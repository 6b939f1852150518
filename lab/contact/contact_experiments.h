#pragma once
/// Small experiments with contact whose outcome a formula tells: each builds its world, runs it and measures.
/// `weft bench contact` prints them, tests hold them to their tolerances.

#include <string>

#include "weft/world/world.h"
#include "weft/core/vec.h"

namespace weft::engine::lab {



struct ContactExperiment {
  std::string integrator = "newton";
  int cells = 24;             // per side of the cloth [1]
  int steps_per_second = 60;  // [1/s]
};

/// Coulomb's law over the contacts that slide, faster than 5 mm/s: of one step, or summed over several.
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

/// Of the contacts that a world tracked in its last step, of length `step` [s], all of the same coefficient
/// of friction [1]. Cloth's velocity is that of the nearest particle. What the solver has left over at a
/// particle counts as its contacts' force, so that Σ |T| also tells how far the solve was from its end.
FrictionAudit audit_friction(const World& world, double step, double friction, const Axis& axis = {});

/// A sheet that starts at rest on a slope.
struct Slide {
  double acceleration = 0;  // down the slope, from the way in 0.4 s [m/s²]
  double expected = 0;      // g (sin α − µ cos α), or 0 where friction holds it [m/s²]
};
Slide slide_on_incline(const ContactExperiment& setup, double angle_deg, double friction);

/// A strip over a drum that turns under it, half a turn round, held at both ends:
///
///          ___
///        /  ↻  \          T_tight / T_slack = e^{µ θ},  θ = π
///       |   .   |
///     T_slack  T_tight
struct Capstan {
  double ratio = 0;     // of the tensions at the ends [1]
  double expected = 0;  // [1]
};
Capstan pull_over_drum(const ContactExperiment& setup, double friction);

/// A sheet that lies on something for a while.
struct RestingSheet {
  double kinetic = 0;  // the most in the second half of the time [J/kg]
  double drift = 0;    // of the middle in the second half [m]
  double rise = 0;     // the most that the middle ever rose by from one step to the next [m]
  double force = 0;    // of all contacts over the weight, mean of the second half [1]
};
enum class Support { ball, floor };
RestingSheet rest_on(const ContactExperiment& setup, Support support, double seconds);

/// A sheet on a ball that is spun up to half a turn per second within a second. Not longer: on a smooth ball
/// no sheet stays.
struct Spin {
  double turned_ball = 0, turned_sheet = 0;  // after that second [rad]
  double expected = 0;     // of a rigid flat sheet: µ g ⟨r⟩/(2⟨r²⟩), or the ball's [rad]
  FrictionAudit friction;  // over that second
  double torque = 0;       // by the sheet's angular momentum, over the audit's limit [1]
};
Spin spin_ball(const ContactExperiment& setup, double friction);

/// A square sheet on a floor that turns under it, about the vertical through its middle, faster and faster
/// from rest on.
struct Turntable {
  double acceleration = 0;  // of the sheet's mean angular velocity in 0.3 s [rad/s²]
  /// The floor's, or a rigid sheet's µ g ⟨r⟩/⟨r²⟩ if that is less, of its particles: of many (√2 + asinh 1) µ
  /// g over the side [rad/s²].
  double expected = 0;
  FrictionAudit friction;
  double torque = 0;  // as in Spin [1]
};
Turntable turn_table(const ContactExperiment& setup, double friction, double floor_acceleration);

/// A sheet on a larger one that is pinned everywhere and moves sideways, faster and faster from rest on.
struct CarriedSheet {
  double acceleration = 0;  // of its mean velocity in 0.3 s [m/s²]
  double expected = 0;      // the lower one's, or µ g if that is less [m/s²]
  FrictionAudit friction;
};
CarriedSheet carry_sheet(const ContactExperiment& setup, double friction, double lower_acceleration);

/// A sheet folded in two that falls freely, its halves within reach of each other.
struct FoldedFall {
  double worst_gain = 0;  // of mean velocity in a step, over g h, the farthest from 1 [1]
};
FoldedFall drop_fold(const ContactExperiment& setup, double seconds);

/// Two free sheets that fly into each other.
struct Collision {
  double momentum_change = 0;  // over one sheet's momentum, at most [1]
  int contacts = 0;            // at the most [1]
};
Collision collide_sheets(const ContactExperiment& setup, double seconds);

}  // namespace weft::engine::lab
