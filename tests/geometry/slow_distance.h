#pragma once
/// Slow reference distances, in more digits than a double has, and test inputs.

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "tests/support.h"
#include "weft/core/vec.h"

namespace weft::engine::test {

#if defined(__SIZEOF_FLOAT128__)
__extension__ using Quad = __float128;  // 34 digits, slow
#else
using Quad = long double;
#endif

/// The squared distance between the convex hulls of a and b (two or three corners each, or one): the least
/// over all pairs of faces of the distance between the planes through them, where that is attained inside
/// both faces. The minimum over both hulls is inside some pair of faces. If it is attained at several
/// positions, it is also inside a pair with only one solution; so pairs with singular normal equations are
/// skipped.
template <class Real>
Real slow_distance_sq(const std::vector<Vec3>& a, const std::vector<Vec3>& b) {
  using Vector = std::array<Real, 3>;
  const auto difference = [](const Vec3& x, const Vec3& y) {
    return Vector{Real(x[0]) - Real(y[0]), Real(x[1]) - Real(y[1]), Real(x[2]) - Real(y[2])};
  };
  const auto dot = [](const Vector& x, const Vector& y) { return x[0] * y[0] + x[1] * y[1] + x[2] * y[2]; };
  Real best = Real(std::numeric_limits<double>::max());

  for (unsigned subset_a = 1; subset_a < 1u << a.size(); ++subset_a) {
    for (unsigned subset_b = 1; subset_b < 1u << b.size(); ++subset_b) {
      // Points a_0 + Σ y_j column_j − b_0, the first columns from a, the others from b.
      std::array<Vector, 4> column;
      int num = 0;
      const auto add_columns = [&](const std::vector<Vec3>& x, unsigned subset, int sign) {
        int first = -1;
        for (int i = 0; i < static_cast<int>(x.size()); ++i) {
          if (!(subset >> i & 1u)) continue;
          if (first < 0) {
            first = i;
          } else {
            column[num++] = sign > 0 ? difference(x[i], x[first]) : difference(x[first], x[i]);
          }
        }
        return first;
      };
      const int a0 = add_columns(a, subset_a, 1);
      const int num_a = num;
      const int b0 = add_columns(b, subset_b, -1);
      Vector rest = difference(a[a0], b[b0]);

      // Cholesky of the normal equations (columnᵀ column) y = −columnᵀ rest.
      std::array<std::array<Real, 5>, 4> m{};
      for (int i = 0; i < num; ++i) {
        for (int j = 0; j < num; ++j) m[i][j] = dot(column[i], column[j]);
        m[i][num] = -dot(column[i], rest);
      }
      bool regular = true;
      for (int i = 0; i < num && regular; ++i) {
        regular = m[i][i] > 0;
        for (int k = i + 1; k < num && regular; ++k) {
          const Real factor = m[k][i] / m[i][i];
          for (int j = i; j <= num; ++j) m[k][j] -= factor * m[i][j];
        }
      }
      if (!regular) continue;
      std::array<Real, 4> y{};
      for (int i = num - 1; i >= 0; --i) {
        Real sum = m[i][num];
        for (int j = i + 1; j < num; ++j) sum -= m[i][j] * y[j];
        y[i] = sum / m[i][i];
      }
      Real sum_a = 0, sum_b = 0;
      bool inside = true;
      for (int i = 0; i < num; ++i) {
        inside = inside && y[i] >= 0;
        (i < num_a ? sum_a : sum_b) += y[i];
        for (int k = 0; k < 3; ++k) rest[k] += y[i] * column[i][k];
      }
      if (!inside || sum_a > 1 || sum_b > 1) continue;
      const Real d = dot(rest, rest);
      if (d < best) best = d;
    }
  }
  return best;
}

/// The largest distance between any two of the points.
inline double spread(const std::vector<Vec3>& points) {
  double largest = 0;
  for (const Vec3& x : points) {
    for (const Vec3& y : points) largest = std::max(largest, (x - y).norm());
  }
  return largest;
}

inline int pick(Random& random, int count) { return static_cast<int>(random.uniform(0, count)); }

/// 10^x, x uniform.
inline double random_size(Random& random, double low, double high) {
  return std::pow(10.0, random.uniform(low, high));
}

inline Vec3 random_unit(Random& random) {
  for (;;) {
    const Vec3 v = random_vector(random, 1);
    if (v.norm() > 0.1 && v.norm() < 1) return v.normalized();
  }
}

inline Mat3 random_rotation(Random& random) {
  const Vec3 x = random_unit(random);
  const Vec3 y = x.cross(random_unit(random)).normalized();
  Mat3 rotation;
  rotation << x, y, x.cross(y);
  return rotation;
}

/// Degenerate point sets: on a coarse lattice (so that edges are parallel, or of zero length), on one line,
/// almost coincident, with the fourth side almost parallel to the first, perturbed by 1e-17 to 1; all at
/// sizes from 1e-9 to 1e6, and sometimes far from the origin.
inline std::vector<Vec3> unlucky_points(Random& random, int count) {
  std::vector<Vec3> x(count);
  const int kind = pick(random, 5);
  for (Vec3& p : x) {
    p = random_vector(random, 1);
    if (kind == 0) p = Vec3(pick(random, 3) - 1, pick(random, 3) - 1, pick(random, 3) - 1);
  }
  if (kind == 1) {  // on a line
    for (Vec3& p : x) p = x[0] + random.uniform(-1, 1) * (x[1] - x[0]);
  }
  if (kind == 2) {  // parallel: the last side along another
    x[count - 1] = x[count - 2] + random.uniform(-2, 2) * (x[1] - x[0]);
  }
  if (kind == 3) {  // two coincident points
    x[pick(random, count)] = x[pick(random, count)];
  }
  if (kind == 4) {  // in a plane
    for (Vec3& p : x) p.y() = 0;
  }
  if (pick(random, 3) > 0) {
    const double shake = random_size(random, -17, 0);
    for (Vec3& p : x) {
      if (pick(random, 2) == 0) p += random_vector(random, shake);
    }
  }
  if (pick(random, 4) == 0) x[pick(random, count)] *= random_size(random, -6, 6);
  const double size = pick(random, 2) == 0 ? random_size(random, -9, 6) : 1;
  const Mat3 rotation = pick(random, 2) == 0 ? random_rotation(random) : Mat3(Mat3::Identity());
  const Vec3 origin =
      pick(random, 4) == 0 ? random_vector(random, size * random_size(random, 0, 6)) : Vec3(Vec3::Zero());
  for (Vec3& p : x) p = origin + size * (rotation * p);
  return x;
}

inline std::vector<Vec3> random_points(Random& random, int count) {
  std::vector<Vec3> x(count);
  for (Vec3& p : x) p = random_vector(random, 1);
  return x;
}

}  // namespace weft::engine::test
