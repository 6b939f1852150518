/// Contact experiments with analytic results; `weft bench contact` runs them finer and longer.

#include "lab/contact/contact_experiments.h"

#include <gtest/gtest.h>

#include <cmath>
#include <string>

namespace weft::engine::lab {
namespace {

TEST(ContactExperiments, OnAnInclineNewtonSlidesAsCoulombSays) {
  // At 60 steps per second, as scenes are run. tan 30° = 0.577.
  for (const double friction : {0.0, 0.2, 0.4}) {
    const Slide slide = slide_on_incline({.cells = 10}, 30, friction);
    EXPECT_NEAR(slide.acceleration, slide.expected, 0.03 * slide.expected) << friction;
  }
  EXPECT_LT(std::abs(slide_on_incline({.cells = 10}, 30, 0.59).acceleration), 0.02)
      << "2 % above the tangent";
}

TEST(ContactExperiments, ADrumPullsByTheCapstanEquation) {
  for (const double friction : {0.1, 0.3, 0.5}) {
    const Capstan capstan = pull_over_drum({.cells = 20}, friction);
    EXPECT_NEAR(capstan.ratio, capstan.expected, 0.05 * capstan.expected) << friction;
  }
  for (const double friction : {0.3, 0.5}) {
    const Capstan coarse = pull_over_drum({.cells = 8}, friction);
    EXPECT_NEAR(coarse.ratio, coarse.expected, 0.06 * coarse.expected)
        << friction << ", of edges as long as r/3";
  }
  const Capstan other = pull_over_drum({.integrator = "implicit_euler", .cells = 20}, 0.3);
  EXPECT_NEAR(other.ratio, other.expected, 0.05 * other.expected) << "another integrator";
}

TEST(ContactExperiments, ClothPullsTautClothByTheCapstanEquation) {
  for (const double friction : {0.1, 0.3, 0.5}) {
    const Capstan capstan = pull_over_drum({.cells = 20}, friction, Drum::cloth);
    EXPECT_NEAR(capstan.ratio, capstan.expected, 0.05 * capstan.expected) << friction;
  }
}

TEST(ContactExperiments, ABallTakesTheSheetAlongAsFarAsFrictionCan) {
  // For every mesh. An incomplete solve gives 0.78 to 1.56 of the analytic value.
  for (const int cells : {8, 16, 24, 32, 48}) {
    for (const double friction : {0.02, 0.03}) {
      const Spin spin = spin_ball({.cells = cells}, friction);
      EXPECT_NEAR(spin.turned_sheet, spin.expected, 0.06 * spin.expected) << cells << " cells, " << friction;
    }
  }
  const Spin sticking = spin_ball({.cells = 24}, 0.6);
  EXPECT_NEAR(sticking.turned_sheet, sticking.expected, 0.02 * sticking.expected);
}

TEST(ContactExperiments, ATurntableTakesTheSheetAlongUntilFrictionIsAllUsedUp) {
  for (const char* integrator : {"newton", "implicit_euler"}) {
    const ContactExperiment setup{.integrator = integrator, .cells = 12};
    const Turntable slow = turn_table(setup, 0.1, 4);
    EXPECT_EQ(slow.expected, 4) << "0.1 g is enough for the corners";
    EXPECT_NEAR(slow.acceleration, 4, 0.02 * 4) << integrator;
    EXPECT_EQ(slow.friction.sliding, 0) << integrator;
    const Turntable fast = turn_table(setup, 0.1, 20);
    EXPECT_NEAR(fast.expected, 0.1 * 9.81 * (std::sqrt(2.0) + std::asinh(1.0)) / 0.3, 0.02 * fast.expected)
        << "of a square of 0.3 m; of 12 cells its inertia is 2/12² more";
    // Implicit Euler, with contact in the solve, loses (ω h)² of angular momentum per step: 1 % in total.
    EXPECT_NEAR(fast.acceleration, fast.expected, 0.025 * fast.expected) << integrator;
    EXPECT_NEAR(fast.torque, 1, 0.025) << integrator;
    EXPECT_NEAR(fast.friction.torque, fast.friction.torque_limit, 0.02 * fast.friction.torque_limit)
        << integrator;
    EXPECT_NEAR(fast.friction.tangential, fast.friction.limit, 0.02 * fast.friction.limit) << integrator;
  }
}

TEST(ContactExperiments, ASheetThatMovesTakesAnotherAlong) {
  for (const char* integrator : {"newton", "implicit_euler"}) {
    const ContactExperiment setup{.integrator = integrator, .cells = 8};
    const CarriedSheet slow = carry_sheet(setup, 0.3, 1);
    EXPECT_NEAR(slow.acceleration, 1, 0.01) << integrator << " sticks";
    const CarriedSheet fast = carry_sheet(setup, 0.3, 6);
    EXPECT_NEAR(fast.expected, 0.3 * 9.81, 1e-9);
    EXPECT_NEAR(fast.acceleration, fast.expected,
                (integrator == std::string("newton") ? 0.2 : 0.03) * fast.expected)
        << integrator << " slides; with newton friction is too weak (docs/explanation/contact.md)";
  }
  // Up to two cells per step; beyond, sheets hook into each other in single steps.
  for (const int cells : {24, 32}) {
    const CarriedSheet fine = carry_sheet({.cells = cells}, 0.3, 4);
    EXPECT_NEAR(fine.acceleration, fine.expected, 0.25 * fine.expected) << cells;
  }
}

TEST(ContactExperiments, TheAuditOfASheetOnABallAgreesWithItsAngularMomentum) {
  const Spin spin = spin_ball({.cells = 24}, 0.03);
  EXPECT_GT(spin.friction.sliding, 60 * 100) << "it slides all the time";
  // The residual of the solve counts as contact force.
  EXPECT_NEAR(spin.torque, 1, 0.1);
  EXPECT_NEAR(spin.friction.torque, spin.friction.torque_limit, 0.15 * spin.friction.torque_limit);
}

TEST(ContactExperiments, AFoldInFreeFallGainsWhatGravityGives) {
  EXPECT_NEAR(drop_fold({.cells = 12}, 0.3).worst_gain, 1, 1e-4);
}

TEST(ContactExperiments, SheetsThatFlyIntoEachOtherKeepTheirCommonMomentum) {
  for (const char* name : {"newton", "implicit_euler"}) {
    const Collision collision = collide_sheets({.integrator = name, .cells = 10}, 0.5);
    EXPECT_LT(collision.momentum_change, 1e-6) << name << "; solved one after the other it was 0.3";
    EXPECT_GT(collision.contacts, 100) << name;
  }
}

TEST(ContactExperiments, ASheetComesToRestOnABallWithAnyCells) {
  for (const int cells : {8, 16, 28}) {
    const RestingSheet rest = rest_on({.cells = cells}, Support::ball, 10);
    EXPECT_LT(rest.speed, 1e-3) << cells << "; with edges' middles in the solve it was 60 mm/s on 16 cells";
    EXPECT_LT(rest.kinetic, 5e-5) << cells << "; now and then a fold snaps";
    EXPECT_LT(rest.drift, 1e-3) << cells;
    EXPECT_NEAR(rest.force, 1, 1e-3) << cells;
  }
}

TEST(ContactExperiments, ASheetComesToRestOnAFloorAndIsBorneByIt) {
  const RestingSheet rest = rest_on({.cells = 12}, Support::floor, 4);
  EXPECT_LT(rest.kinetic, 1e-6);  // [J/kg]
  EXPECT_LT(rest.drift, 1e-3);
  EXPECT_LT(rest.rise, 1e-5) << "dropped without restitution it never rises; contact's own depth is 3 µm";
  EXPECT_NEAR(rest.force, 1, 0.01);
}

}  // namespace
}  // namespace weft::engine::lab
