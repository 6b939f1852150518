/// Laboratory sheets, with examples calculated by hand.

#include "weft/laboratory.h"

#include <gtest/gtest.h>

#include <cmath>

#include "weft/error.h"

namespace weft::engine {
namespace {

const KesSheet kKes{.weight = 20,
                    .thickness = 0.5,
                    .extension_warp = 5,
                    .extension_weft = 8,
                    .shear = 1,
                    .bend_warp = 0.1,
                    .bend_weft = 0.05,
                    .hysteresis_warp = 0.1,
                    .hysteresis_weft = 0.03};

/// The wool of the published FAST report: it prints 5.56 and 5.02 µN·m, 26.17 N/m, and formabilities of 0.45
/// and 0.50 mm².
const FastSheet kFast{.weight = 168,
                      .thickness = 0.6,
                      .bending_length_warp = 15.0,
                      .bending_length_weft = 14.5,
                      .extension_5_warp = 0.67,
                      .extension_20_warp = 1.87,
                      .extension_5_weft = 0.40,
                      .extension_20_weft = 1.87,
                      .bias_extension = 4.7};

template <class Sheet>
std::string complaint(const Sheet& sheet) {
  try {
    fabric_from(sheet);
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

TEST(KesSheet, UnitsBecomeSi) {
  const Fabric f = fabric_from(kKes);
  EXPECT_NEAR(f.density, 0.2, 1e-12);
  EXPECT_NEAR(f.thickness, 0.5e-3, 1e-12);
  EXPECT_NEAR(f.bend_warp, 0.1 * 9.80665e-5, 1e-15);
  EXPECT_NEAR(f.bend_weft, 0.05 * 9.80665e-5, 1e-15);
  EXPECT_NEAR(f.bend_hysteresis_warp, 0.1 * 9.80665e-3, 1e-12);
  EXPECT_NEAR(f.bend_hysteresis_weft, 0.03 * 9.80665e-3, 1e-12);
  EXPECT_NEAR(f.g, 56.19, 0.005) << "as tables of units round it";
}

TEST(KesSheet, StraightCurveHasTheStiffnessAtFullTension) {
  const Fabric f = fabric_from(kKes);  // 500 gf/cm = 490.3 N/m
  EXPECT_NEAR(f.c11, 490.3325 / 0.05, 1e-6);
  EXPECT_NEAR(f.c22, 490.3325 / 0.08, 1e-6);
}

TEST(KesSheet, BentCurveIsSofterAtSmallTensionAndEndsAtFullTension) {
  KesSheet sheet = kKes;
  sheet.linearity_warp = 0.8;  // n = 1.5: ε(4 %) = 0.04^(2/3) EMT = 0.11696 · 0.05
  const Fabric f = fabric_from(sheet);
  EXPECT_NEAR(f.c11, 0.04 * 490.3325 / (0.1169607 * 0.05), 0.01);
  EXPECT_NEAR(f.stretch_warp.back().strain, 0.05, 1e-12);
  EXPECT_NEAR(f.stretch_warp.back().tension, 490.3325, 1e-6);
}

TEST(KesSheet, CurveHasTheLinearityOfTheSheet) {
  for (const double linearity : {0.5, 0.7, 1.0}) {
    KesSheet sheet = kKes;
    sheet.linearity_warp = linearity;
    const auto curve = fabric_from(sheet).stretch_warp;
    const StretchPoint &low = curve.front(), &high = curve.back();
    const double n = std::log(high.tension / low.tension) / std::log(high.strain / low.strain);
    // The work of T = T_max (ε/e)ⁿ is T_max e/(n + 1), that of a straight line ½ T_max e.
    EXPECT_NEAR(1 / (n + 1) / 0.5, linearity, 1e-12);
  }
}

TEST(KesSheet, NonsenseIsRefused) {
  KesSheet sheet = kKes;
  sheet.extension_weft = 0;
  EXPECT_EQ(complaint(sheet), "KES-F sheet: extension_weft (EMT) must be above 0");
  sheet = kKes;
  sheet.linearity_warp = 70;
  EXPECT_EQ(complaint(sheet), "KES-F sheet: linearity (LT) must be from 0.3 to 1");
  sheet = kKes;
  sheet.shear = -1;
  EXPECT_NE(complaint(sheet).find("fabric \"KES-F sheet\": g must be above 0 N/m"), std::string::npos);
}

TEST(FastSheet, GivesTheReportsOwnFigures) {
  const Fabric f = fabric_from(kFast);
  EXPECT_NEAR(f.density, 0.168, 1e-12);
  EXPECT_NEAR(f.bend_warp, 5.56e-6, 0.005e-6);
  EXPECT_NEAR(f.bend_weft, 5.02e-6, 0.005e-6);
  EXPECT_NEAR(f.g, 26.17, 0.005);
  // Formability, bending over stiffness at small tension: the report prints 0.45 and 0.50 mm² per cent.
  EXPECT_NEAR(100 * 1e6 * f.bend_warp / f.c11, 0.45, 0.01);
  EXPECT_NEAR(100 * 1e6 * f.bend_weft / f.c22, 0.50, 0.01);
  EXPECT_NEAR(f.c11, 14.7 / 0.012, 1e-6);
}

TEST(FastSheet, NonsenseIsRefused) {
  FastSheet sheet = kFast;
  sheet.extension_20_warp = sheet.extension_5_warp;
  EXPECT_EQ(complaint(sheet),
            "FAST sheet: extension_20_warp - extension_5_warp (E20-1 - E5-1) must be above 0");
  sheet = kFast;
  sheet.bias_extension = 0;
  EXPECT_EQ(complaint(sheet), "FAST sheet: bias_extension (EB5) must be above 0");
}

TEST(CloProperties, GramMillimetreAndSecondBecomeSi) {
  const Fabric f = fabric_from(CloProperties{.density = 150,
                                             .thickness = 0.4,
                                             .stretch_warp = 300000,
                                             .stretch_weft = 200000,
                                             .shear = 40000,
                                             .bend_warp = 8000,
                                             .bend_weft = 6000,
                                             .bend_bias = 7000,
                                             .friction = 0.25});
  EXPECT_NEAR(f.density, 0.150, 1e-12);
  EXPECT_NEAR(f.thickness, 0.4e-3, 1e-12);
  EXPECT_NEAR(f.c11, 300, 1e-9);
  EXPECT_NEAR(f.c22, 200, 1e-9);
  EXPECT_NEAR(f.g, 40, 1e-9);
  EXPECT_NEAR(f.bend_warp, 8e-6, 1e-15);
  EXPECT_NEAR(f.bend_weft, 6e-6, 1e-15);
  EXPECT_NEAR(f.bend_bias, 7e-6, 1e-15);
  EXPECT_EQ(f.friction, 0.25);
}

}  // namespace
}  // namespace weft::engine
