#include "weft/solvers/dense_inverse.h"

#include <algorithm>

namespace weft::engine {

/// Gauss–Jordan elimination along the diagonal: stable for such matrices without pivoting.
void invert_in_place(std::vector<double>& a, int n) {
  constexpr double kRounding = 1e-15;  // of the largest diagonal element: less counts as zero
  double largest = 0;
  for (int i = 0; i < n; ++i) largest = std::max(largest, a[i * n + i]);
  for (int p = 0; p < n; ++p) {
    const double pivot = a[p * n + p];
    if (!(pivot > kRounding * largest)) {
      for (int i = 0; i < n; ++i) a[p * n + i] = a[i * n + p] = 0;
      continue;
    }
    a[p * n + p] = 1;
    for (int j = 0; j < n; ++j) a[p * n + j] /= pivot;
    for (int i = 0; i < n; ++i) {
      if (i == p) continue;
      const double factor = a[i * n + p];
      a[i * n + p] = 0;
      for (int j = 0; j < n; ++j) a[i * n + j] -= factor * a[p * n + j];
    }
  }
}

}  // namespace weft::engine
