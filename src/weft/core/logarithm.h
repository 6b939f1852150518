#pragma once
/// Logarithm and power with the same bits on every machine (C libraries differ in the last bit).

namespace weft::engine {

/// ln(1 + x), to about 5e-16 of its value; −∞ for x ≤ −1.
double log_of_one_plus(double x);

/// x to a power, for x > 0, to about 1e-15 (1 + |exponent ln x|) of its value.
double power(double x, double exponent);

}  // namespace weft::engine
