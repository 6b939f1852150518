#pragma once
/// Small experiments with contact whose outcome a formula tells: each builds its world, runs it and measures.
/// `weft bench contact` prints them, tests hold them to their tolerances.

#include <string>

namespace weft {

struct ContactExperiment {
  std::string integrator = "newton";
  int cells = 24;             // per side of the cloth [1]
  int steps_per_second = 60;  // [1/s]
};

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
  double force = 0;    // of all contacts over the weight, at the end [1]
};
enum class Support { ball, floor };
RestingSheet rest_on(const ContactExperiment& setup, Support support, double seconds);

/// A sheet on a ball that is spun up to half a turn per second within a second. Not longer: on a smooth ball
/// no sheet stays.
struct Spin {
  double turned_ball = 0, turned_sheet = 0;  // after that second [rad]
  double expected = 0;  // of a rigid flat sheet: µ g ⟨r⟩/(2⟨r²⟩), or the ball's [rad]
};
Spin spin_ball(const ContactExperiment& setup, double friction);

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

}  // namespace weft
