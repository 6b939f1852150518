#include "weft/core/logarithm.h"

#include <cmath>
#include <limits>
#include <numbers>

namespace weft::engine {
namespace {

constexpr double kLn2 = 0.69314718055994530942;

/// 2 artanh(ratio), |ratio| < 0.18: the first dropped term of the series is below 1e-18.
double twice_artanh(double ratio) {
  const double square = ratio * ratio;
  double sum = 0;
  for (int n = 23; n >= 3; n -= 2) sum = square * (1.0 / n + sum);
  return 2 * (ratio + ratio * sum);
}

/// ln x = ln m + e ln 2 with m between √½ and √2, ln m = 2 artanh((m − 1)/(m + 1)).
double logarithm(double x) {
  int exponent = 0;
  double mantissa = std::frexp(x, &exponent);  // in [0.5, 1)
  if (mantissa < std::numbers::sqrt2 / 2) {
    mantissa *= 2;
    --exponent;
  }
  return exponent * kLn2 + twice_artanh((mantissa - 1) / (mantissa + 1));
}

/// eˣ = 2ᵏ eʳ with |r| ≤ ln 2 / 2: the first dropped term of its Taylor series is below 1e-18.
double exponential(double x) {
  const double doublings = std::nearbyint(x / kLn2), rest = x - doublings * kLn2;
  double sum = 1;
  for (int n = 14; n >= 1; --n) sum = 1 + sum * rest / n;
  return std::ldexp(sum, static_cast<int>(doublings));
}

}  // namespace

double log_of_one_plus(double x) {
  if (!(x > -1)) return -std::numeric_limits<double>::infinity();
  // Near 0 the sum 1 + x would lose digits.
  const bool is_near = x > 1 / std::numbers::sqrt2 - 1 && x < std::numbers::sqrt2 - 1;
  return is_near ? twice_artanh(x / (2 + x)) : logarithm(1 + x);
}

double power(double x, double exponent) { return exponential(exponent * logarithm(x)); }

}  // namespace weft::engine
