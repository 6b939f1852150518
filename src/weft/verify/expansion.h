#pragma once
/// Private to verify/: exact sums and products of doubles (Shewchuk 1997, "Adaptive precision floating-point
/// arithmetic and fast robust geometric predicates", section 2).

namespace weft::engine::verify {

inline int sign(double x) { return (x > 0) - (x < 0); }

/// high + low is the exact value; high is the rounded one.
struct Pair {
  double high, low;
};

/// a + b (Knuth).
inline Pair two_sum(double a, double b) {
  const double sum = a + b;
  const double b_virtual = sum - a;
  const double a_virtual = sum - b_virtual;
  return {sum, (a - a_virtual) + (b - b_virtual)};
}

/// Two halves of 26 bits with exact products (Dekker).
inline Pair split(double a) {
  constexpr double kSplitter = 0x1p27 + 1;
  const double c = kSplitter * a;
  const double high = c - (c - a);
  return {high, a - high};
}

/// a · b (Dekker).
inline Pair two_product(double a, double b) {
  const double product = a * b;
  const auto [a_high, a_low] = split(a);
  const auto [b_high, b_low] = split(b);
  const double error = ((product - a_high * b_high) - a_low * b_high) - a_high * b_low;
  return {product, a_low * b_low - error};
}

/// An expansion is a sum of non-overlapping nonzero doubles, smallest first: its sign is that of the last.
/// Adds b to the one in terms[0 … size), which has room for one more (Grow-Expansion; zeros are dropped);
/// returns the new size.
inline int grow_expansion(double* terms, int size, double b) {
  int kept = 0;
  for (int i = 0; i < size; ++i) {
    const auto [high, low] = two_sum(b, terms[i]);
    if (low != 0) terms[kept++] = low;
    b = high;
  }
  if (b != 0) terms[kept++] = b;
  return kept;
}

}  // namespace weft::engine::verify
