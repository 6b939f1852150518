#include "weft/core/angle.h"

#include <cmath>

namespace weft::engine {
namespace {

constexpr double kRadiansPerDegree = 0.017453292519943295;

// Taylor series; |x| <= pi/4 makes the first dropped term smaller than 1e-18.
double sin_series(double x) {
  const double x2 = x * x;
  double sum = 0;
  for (int n = 19; n >= 3; n -= 2) sum = (1 + sum) * (-x2 / ((n - 1) * n));
  return x * (1 + sum);
}

double cos_series(double x) {
  const double x2 = x * x;
  double sum = 0;
  for (int n = 20; n >= 2; n -= 2) sum = (1 + sum) * (-x2 / ((n - 1) * n));
  return 1 + sum;
}

}  // namespace

SinCos sin_cos_deg(double angle_deg) {
  const double reduced = std::fmod(angle_deg, 360.0);  // exact
  const double quarter = std::nearbyint(reduced / 90.0);
  const double x = (reduced - 90.0 * quarter) * kRadiansPerDegree;
  const double s = sin_series(x), c = cos_series(x);
  switch ((static_cast<int>(quarter) + 4) % 4) {
    case 0:
      return {s, c};
    case 1:
      return {c, -s};
    case 2:
      return {-s, -c};
    default:
      return {-c, s};
  }
}

}  // namespace weft::engine
