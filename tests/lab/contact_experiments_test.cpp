/// Contact obeys the laws that have formulas; `weft bench contact` has the same experiments finer and longer.

#include "weft/lab/contact_experiments.h"

#include <gtest/gtest.h>

#include <cmath>

namespace weft {
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
  // Not newton at 60 steps per second: there its two Newton steps overrate what tension presses on (a finding
  // of `weft bench contact`, 2.2 instead of 1.37).
  for (const auto& [integrator, steps] : {std::pair("implicit_euler", 60), std::pair("newton", 300)}) {
    const Capstan capstan =
        pull_over_drum({.integrator = integrator, .cells = 20, .steps_per_second = steps}, 0.3);
    EXPECT_NEAR(capstan.ratio, capstan.expected, 0.05 * capstan.expected) << integrator;
  }
}

TEST(ContactExperiments, ABallTakesTheSheetAlongIfFrictionIsEnough) {
  const Spin rough = spin_ball({.cells = 16}, 0.6);
  EXPECT_NEAR(rough.turned_sheet, rough.turned_ball, 0.05 * rough.turned_ball);
  // 0.9 m/s² are needed at the sheet's corners, µ g is 0.2.
  const Spin smooth = spin_ball({.integrator = "implicit_euler", .cells = 10}, 0.02);
  EXPECT_LT(smooth.turned_sheet, 0.8 * smooth.turned_ball) << "it slips";
}

TEST(ContactExperiments, AFoldInFreeFallGainsWhatGravityGives) {
  EXPECT_NEAR(drop_fold({.cells = 12}, 0.3).worst_gain, 1, 1e-3);
}

TEST(ContactExperiments, ASheetComesToRestOnAFloorAndIsBorneByIt) {
  const RestingSheet rest = rest_on({.cells = 12}, Support::floor, 4);
  EXPECT_LT(rest.kinetic, 1e-6);  // [J/kg]
  EXPECT_LT(rest.drift, 1e-3);
  EXPECT_LT(rest.rise, 1e-5) << "dropped without restitution it never rises; contact's own depth is 3 µm";
  EXPECT_NEAR(rest.force, 1, 0.01);
}

}  // namespace
}  // namespace weft
