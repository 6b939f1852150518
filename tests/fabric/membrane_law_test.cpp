/// The membrane's response to strain, against formulas.

#include "weft/fabric/membrane_law.h"

#include <gtest/gtest.h>

#include "weft/core/random.h"
#include "weft/laboratory.h"

namespace weft::engine {
namespace {

const std::vector<StretchPoint> kCurve = {{0.01, 10}, {0.02, 30}, {0.05, 210}};

double green(double extension) { return extension + extension * extension / 2; }

/// Force per width at rest of a strip stretched along warp, nothing across [N/m].
double tension(const MembraneLaw& law, double extension) {
  return membrane_response(law, {green(extension), 0, 0}).stress[0] * (1 + extension);
}

TEST(MembraneLaw, PassesThroughThePointsOfAStretchCurve) {
  const Mat3 c = Vec3(1200, 700, 50).asDiagonal();
  const MembraneLaw law(c, {}, make_stretch_kinks(kCurve, 1200));
  for (const StretchPoint& p : kCurve) EXPECT_NEAR(tension(law, p.strain), p.tension, 1e-9 * p.tension);
  EXPECT_NEAR(tension(law, 0.005), 5, 0.05);   // straight from the origin
  EXPECT_NEAR(tension(law, 0.035), 120, 3);    // straight between points
  EXPECT_NEAR(tension(law, 0.06), 270, 8);     // extrapolated beyond the last one
  EXPECT_NEAR(tension(law, -0.01), -12, 0.2);  // c11 in compression
  EXPECT_EQ(membrane_response(law, {0, 0.02, 0.1}).stress, c * Vec3(0, 0.02, 0.1));
}

TEST(MembraneLaw, HasStressAndTangentThatAreItsEnergysDerivatives) {
  Mat3 c = Vec3(1200, 700, 50).asDiagonal();
  c(0, 1) = c(1, 0) = 200;
  const StrainLimit limit{0.04, 0.06, 5000};
  const MembraneLaw law(c, limit, make_stretch_kinks(kCurve, 1200), make_stretch_kinks({{0.03, 60}}, 700));
  Random random(3);
  constexpr double kStep = 1e-6;
  for (int n = 0; n < 200; ++n) {
    const Vec3 e(random.uniform(-0.05, 0.08), random.uniform(-0.05, 0.08), random.uniform(-0.1, 0.1));
    const MembraneResponse here = membrane_response(law, e);
    for (int k = 0; k < 3; ++k) {
      const Vec3 d = kStep * Vec3::Unit(k);
      const MembraneResponse after = membrane_response(law, e + d), before = membrane_response(law, e - d);
      EXPECT_NEAR((after.energy - before.energy) / (2 * kStep), here.stress[k], 1e-4 * here.stress.norm());
      const Vec3 slope = (after.stress - before.stress) / (2 * kStep);
      EXPECT_LT((slope - here.tangent.col(k)).norm(), 0.02 * here.tangent.norm()) << e.transpose();
    }
  }
}

TEST(MembraneLaw, OfAKesSheetRisesAsTheLaboratoryMeasuredIt) {
  const Fabric fabric = fabric_from(KesSheet{.weight = 18,
                                             .thickness = 0.6,
                                             .extension_warp = 5,
                                             .extension_weft = 8,
                                             .linearity_warp = 0.6,
                                             .linearity_weft = 0.7,
                                             .shear = 0.8,
                                             .bend_warp = 0.1,
                                             .bend_weft = 0.08});
  const MembraneLaw law(Vec3(fabric.c11, fabric.c22, fabric.g).asDiagonal(), {},
                        make_stretch_kinks(fabric.stretch_warp, fabric.c11),
                        make_stretch_kinks(fabric.stretch_weft, fabric.c22));
  EXPECT_NEAR(tension(law, 0.05), 490.3325, 1e-6);  // 500 gf/cm at EMT
  EXPECT_LT(tension(law, 0.025), 0.5 * 490);        // and less than half of it halfway
}

}  // namespace
}  // namespace weft::engine
