#include "weft/core/angle.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace weft::engine {
namespace {

constexpr double kRadiansPerDegree = 0.017453292519943295;
constexpr double kDegreesPerRadian = 57.29577951308232;

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

/// Of quarter · 90° + x.
SinCos turned(double x, int quarter) {
  const double s = sin_series(x), c = cos_series(x);
  switch ((quarter % 4 + 4) % 4) {
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

/// The half-angle formula tan(a/2) = tan(a) / (1 + √(1 + tan² a)) reduces the angle to a sixteenth. Its
/// tangent below 0.1 makes the first dropped term of the Taylor series smaller than 1e-20.
double find_acute_angle(double y, double x) {
  const double size = std::max(x, y);
  if (size == 0) return 0;
  x /= size;
  y /= size;
  double tangent = y / (std::sqrt(x * x + y * y) + x);
  for (int halving = 0; halving < 3; ++halving) tangent /= 1 + std::sqrt(1 + tangent * tangent);
  const double t2 = tangent * tangent;
  double sum = 0;
  for (int n = 19; n >= 3; n -= 2) sum = -t2 * (1.0 / n + sum);
  return 16 * (tangent * (1 + sum));
}

}  // namespace

SinCos sin_cos_deg(double angle_deg) {
  const double reduced = std::fmod(angle_deg, 360.0);  // exact
  const double quarter = std::nearbyint(reduced / 90.0);
  const double x = (reduced - 90.0 * quarter) * kRadiansPerDegree;
  return turned(x, static_cast<int>(quarter));
}

SinCos sin_cos(double angle) {
  // π/2 in three parts; the first two have 33 bits, so that their multiples are exact.
  constexpr double kFirst = 1.57079632673412561417e+00, kSecond = 6.07710050630396597660e-11,
                   kThird = 2.02226624879595063154e-21;
  const double quarter = std::nearbyint(angle * (1 / (kFirst + kSecond)));
  const double x = ((angle - quarter * kFirst) - quarter * kSecond) - quarter * kThird;
  return turned(x, static_cast<int>(quarter));
}

double find_angle(double y, double x) {
  const double acute = find_acute_angle(std::abs(y), std::abs(x));
  const double angle = x < 0 ? std::numbers::pi - acute : acute;
  return y < 0 ? -angle : angle;
}

double find_angle_deg(double y, double x) { return kDegreesPerRadian * find_acute_angle(y, x); }

}  // namespace weft::engine
