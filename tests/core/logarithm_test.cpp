#include "weft/core/logarithm.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace weft::engine {
namespace {

TEST(Logarithm, AgreesWithLongDoubles) {
  for (double size = 1e-12; size < 1e6; size *= 1.00137) {
    for (const double x : {size, -size}) {
      if (x <= -1) continue;
      const auto exact = static_cast<double>(std::log1p(static_cast<long double>(x)));
      ASSERT_NEAR(log_of_one_plus(x), exact, 6e-16 * std::abs(exact)) << x;
    }
  }
  EXPECT_EQ(log_of_one_plus(0), 0);
  EXPECT_EQ(log_of_one_plus(-1), -std::numeric_limits<double>::infinity());
}

TEST(Power, AgreesWithLongDoubles) {
  for (double x = 1e-3; x < 1e3; x *= 1.0137) {
    for (const double exponent : {-3.0, -0.37, 0.25, 1 / 3.0, 0.5, 1.0, 1.7, 3.0}) {
      const long double exact = std::pow(static_cast<long double>(x), static_cast<long double>(exponent));
      ASSERT_NEAR(power(x, exponent) / static_cast<double>(exact), 1,
                  1e-15 * (1 + std::abs(exponent * std::log(x))))
          << x << " to " << exponent;
    }
  }
}

}  // namespace
}  // namespace weft::engine
