/// Valid and invalid fabrics, and the reported field.

#include "weft/fabric.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "weft/error.h"

namespace weft::engine {
namespace {

/// The one mistake of a fabric, as "field reason"; "" if none.
std::string mistake(const Fabric& fabric) {
  const std::vector<FabricMistake> mistakes = find_mistakes(fabric);
  EXPECT_LE(mistakes.size(), 1u);
  return mistakes.empty() ? "" : mistakes[0].field + " " + mistakes[0].reason;
}

TEST(Fabric, DefaultIsPossible) { EXPECT_EQ(mistake(Fabric()), ""); }

TEST(Fabric, NumbersOutOfRangeAreRefusedByName) {
  EXPECT_EQ(mistake({.density = -0.1}), "density must be above 0 kg/m², is -0.1");
  EXPECT_EQ(mistake({.c11 = 0}), "c11 must be above 0 N/m, is 0");
  EXPECT_EQ(mistake({.c22 = -5}), "c22 must be above 0 N/m, is -5");
  EXPECT_EQ(mistake({.g = -1}), "g must be above 0 N/m, is -1");
  EXPECT_EQ(mistake({.bend_warp = -1e-6}), "bend_warp must be 0 N·m or above, is -1e-06");
  EXPECT_EQ(mistake({.damping = 100}), "damping must be from 0 to 10 s (a time constant, not N·s/m), is 100");
  EXPECT_EQ(mistake({.thickness = 0}), "thickness must be from 1e-6 to 0.05 m, is 0");
  EXPECT_EQ(mistake({.friction = -0.3}), "friction must be from 0 to 10, is -0.3");
  EXPECT_EQ(mistake({.strain_limit = -0.01}), "strain_limit must be from 0 (none) to 10, is -0.01");
}

TEST(Fabric, NumbersThatAreNoneAreRefused) {
  const double nan = std::numeric_limits<double>::quiet_NaN(), inf = std::numeric_limits<double>::infinity();
  EXPECT_EQ(mistake({.density = nan}), "density must be above 0 kg/m², is nan");
  EXPECT_EQ(mistake({.c11 = inf}), "c11 must be above 0 N/m, is inf");
  EXPECT_EQ(mistake({.c12 = nan}), "c12 must be a finite number in N/m, is nan");
}

TEST(Fabric, MembraneMustBePositiveDefinite) {
  // The navy sweater of Wang et al. as measured.
  EXPECT_EQ(
      mistake({.c11 = 25.0, .c22 = 6.5, .c12 = -39.8, .g = 17.6}),
      "c12 must be less than √(c11 c22) = 12.75 N/m in magnitude, is -39.8: the membrane is not positive "
      "definite, so some stretching would release energy");
  EXPECT_EQ(mistake({.c11 = 100, .c22 = 100, .c12 = 99.9}), "");
}

TEST(Fabric, HeavierThanLeadIsRefused) {
  EXPECT_EQ(mistake({.density = 6, .thickness = 0.5e-3}),
            "density must be at most 5.67 kg/m², is 6: heavier than sheet lead of the fabric's thickness, "
            "0.0005 m");
  EXPECT_EQ(mistake({.density = 5.6, .thickness = 0.5e-3}), "");
}

TEST(Fabric, BiasBendingMustBePossible) {
  EXPECT_EQ(
      mistake({.bend_warp = 9e-6, .bend_weft = 1e-6, .bend_bias = 0.9e-6}),
      "bend_bias must be at least (√bend_warp − √bend_weft)²/4 = 1e-06 N·m, is 9e-07: some bending would "
      "release energy");
  EXPECT_EQ(mistake({.bend_warp = 9e-6, .bend_weft = 1e-6, .bend_bias = 1.01e-6}), "");
}

TEST(Fabric, PossibleBiasBendingIsNeverNegativeInAnyDirection) {
  const Fabric fabric{.bend_warp = 9e-6, .bend_weft = 1e-6, .bend_bias = 1.0001e-6};
  for (int i = 0; i < 360; ++i) {
    EXPECT_GT(bending_rigidity(fabric, std::cos(0.01 * i), std::sin(0.01 * i)), 0);
  }
}

TEST(Fabric, BendingRigidityIsTheGivenOneInTheThreeDirections) {
  const Fabric fabric{.bend_warp = 16e-6, .bend_weft = 24e-6, .bend_bias = 18e-6};
  constexpr double kRounding = 1e-19;  // of sums of numbers about 1e-5
  EXPECT_NEAR(bending_rigidity(fabric, 1, 0), 16e-6, kRounding);
  EXPECT_NEAR(bending_rigidity(fabric, 0, 1), 24e-6, kRounding);
  EXPECT_NEAR(bending_rigidity(fabric, std::sqrt(0.5), std::sqrt(0.5)), 18e-6, kRounding);
  EXPECT_NEAR(bending_rigidity(fabric, -std::sqrt(0.5), std::sqrt(0.5)), 18e-6, kRounding);
}

TEST(Fabric, StretchCurveMustRiseFromTheOrigin) {
  EXPECT_EQ(mistake({.stretch_warp = {{0.01, 20}, {0.02, 90}}}), "");
  EXPECT_EQ(mistake({.stretch_warp = {{0.02, 20}, {0.01, 90}}}),
            "stretch_warp must increase from the origin, does not at strain 0.01");
  EXPECT_EQ(mistake({.stretch_weft = {{0, 20}}}),
            "stretch_weft must increase from the origin, does not at strain 0");
}

TEST(Fabric, AllMistakesStandInOneSentence) {
  try {
    validate_fabric({.density = 0, .g = -1}, "jelly");
    FAIL() << "took an impossible fabric";
  } catch (const InputError& error) {
    EXPECT_STREQ(error.what(),
                 "fabric \"jelly\": density must be above 0 kg/m², is 0; g must be above 0 N/m, is -1");
  }
}

}  // namespace
}  // namespace weft::engine
