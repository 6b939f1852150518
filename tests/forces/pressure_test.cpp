/// Gas in closed cloth: volumes, and forces and stiffness against finite differences of the energy.

#include "weft/forces/pressure.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "tests/support.h"
#include "weft/core/random.h"
#include "weft/core/shapes.h"

namespace weft::engine {
namespace {

/// A ball with dents.
TriangleMesh dented_ball() {
  TriangleMesh ball = make_sphere_mesh({3, -2, 1}, 0.5, 12);
  Random random(3);
  for (Vec3& p : ball.positions) {
    for (double& c : p) c += random.uniform(-0.03, 0.03);
  }
  return ball;
}

double volume_of(const TriangleMesh& mesh) {
  return compute_signed_volume(mesh.triangles, [&](int v) { return mesh.positions[v]; });
}

TEST(Pressure, VolumesAreThoseOfSolids) {
  const TriangleMesh box = make_box_mesh({5, 6, 7}, {0.5, 1, 1.5}, Mat3::Identity());
  EXPECT_NEAR(volume_of(box), 6, 1e-12);
  EXPECT_NEAR(volume_of(make_sphere_mesh({0, 0, 0}, 1, 200)), 4 * M_PI / 3, 1e-3);
}

TEST(Pressure, GradientIsThatOfTheVolume) {
  TriangleMesh ball = dented_ball();
  std::vector<Vec3> gradient(ball.positions.size(), Vec3::Zero());
  add_volume_gradient(
      ball.triangles, [&](int v) { return ball.positions[v]; },
      [&](int v, const Vec3& part) { gradient[v] += part; });
  Vec3 sum = Vec3::Zero();
  for (std::size_t v = 0; v < gradient.size(); ++v) {
    sum += gradient[v];
    for (int c = 0; c < 3; ++c) {
      constexpr double kStep = 1e-4;  // the volume is linear in each coordinate
      ball.positions[v][c] += kStep;
      const double more = volume_of(ball);
      ball.positions[v][c] -= 2 * kStep;
      const double less = volume_of(ball);
      ball.positions[v][c] += kStep;
      EXPECT_NEAR(gradient[v][c], (more - less) / (2 * kStep), 1e-10);
    }
  }
  EXPECT_LT(sum.norm(), 1e-14) << "gas does not push cloth away as a whole";
}

TEST(Pressure, ExcessAndStiffnessAreDerivativesOfTheEnergy) {
  for (const Gas& gas :
       {Gas{.pressure = 300}, Gas{.pressure = -20}, seal_gas(2000, 0.5), seal_gas(-50000, 0.2)}) {
    for (const double v : {0.01, 0.2, 0.5, 3.0}) {
      const double h = 1e-4 * v;
      const double slope = (gas_energy(gas, v + h) - gas_energy(gas, v - h)) / (2 * h);
      EXPECT_NEAR(gas_excess(gas, v), -slope, 1e-6 * (1 + std::abs(slope)));
      const double curvature = -(gas_excess(gas, v + h) - gas_excess(gas, v - h)) / (2 * h);
      EXPECT_NEAR(gas_stiffness(gas, v), curvature, 1e-6 * (1 + std::abs(curvature)));
      EXPECT_GE(gas_stiffness(gas, v), 0);
    }
  }
}

TEST(Pressure, SealedGasKeepsPressureTimesVolume) {
  const Gas gas = seal_gas(1500, 0.02);
  EXPECT_NEAR(gas_excess(gas, 0.02), 1500, 1e-8);
  for (const double v : {0.005, 0.02, 0.04})
    EXPECT_NEAR((gas_excess(gas, v) + kAirPressure) * v, (1500 + kAirPressure) * 0.02, 1e-9);
  EXPECT_EQ(gas_energy(gas, 0), std::numeric_limits<double>::infinity());
  EXPECT_EQ(gas_energy(gas, -1), std::numeric_limits<double>::infinity());
}

}  // namespace
}  // namespace weft::engine
