#include "weft/forces/air.h"

#include <cmath>

#include "weft/core/random.h"

namespace weft::engine {
namespace {

constexpr double kRootMeanSquare =
    0.35447;  // rms of the noise below with lattice values from −1 to 1, by integration

/// Value at a lattice point, each component from −1 to 1.
Vec3 lattice_value(const Gusts& gusts, const std::int64_t (&point)[4]) {
  std::uint64_t key = gusts.seed;
  for (const std::int64_t p : point) key = Random(key ^ static_cast<std::uint64_t>(p)).next();
  Random random(key);
  const double x = random.uniform(-1, 1), y = random.uniform(-1, 1), z = random.uniform(-1, 1);
  return {x, y, z};
}

/// 0 at 0 and 1 at 1, with first and second derivatives of zero at both.
double smooth_step(double s) { return s * s * s * (10 + s * (6 * s - 15)); }

}  // namespace

Mat3 air_matrix(const Air& air, const Vec3& area_vector, const Vec3& slip) {
  const double speed = slip.norm(), area = area_vector.norm();
  if (speed == 0 || area == 0) return Mat3::Zero();
  const Vec3 n = area_vector / area;
  const double c = std::abs(slip.dot(n)) / speed;
  const double all_round = air.drag * c - air.lift * c * c;
  return 0.5 * air.density * area * speed * (all_round * Mat3::Identity() + air.lift * n * n.transpose());
}

Vec3 gust_velocity(const Gusts& gusts, const Vec3& place, double time) {
  if (gusts.strength == 0) return Vec3::Zero();
  const double at[4] = {place.x() / gusts.length, place.y() / gusts.length, place.z() / gusts.length,
                        time / gusts.time};
  std::int64_t low[4];
  double share[4];
  for (int k = 0; k < 4; ++k) {
    low[k] = static_cast<std::int64_t>(std::floor(at[k]));
    share[k] = smooth_step(at[k] - std::floor(at[k]));
  }
  Vec3 sum = Vec3::Zero();
  for (int corner = 0; corner < 16; ++corner) {
    std::int64_t point[4];
    double weight = 1;
    for (int k = 0; k < 4; ++k) {
      const int up = (corner >> k) & 1;
      point[k] = low[k] + up;
      weight *= up == 1 ? share[k] : 1 - share[k];
    }
    sum += weight * lattice_value(gusts, point);
  }
  return gusts.strength / kRootMeanSquare * sum;
}

}  // namespace weft::engine
