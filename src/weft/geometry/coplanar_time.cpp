#include "weft/geometry/coplanar_time.h"

#include <cmath>
#include <utility>

namespace weft::engine {
namespace {

struct Cubic {
  double a, b, c, d;  // a + b t + c t² + d t³

  double at(double t) const { return a + t * (b + t * (c + t * d)); }
};

/// V(t), from the motions of the edges.
Cubic volume(const std::array<Vec3, 4>& start, const std::array<Vec3, 4>& end) {
  Vec3 p[3], v[3];
  for (int k = 0; k < 3; ++k) {
    p[k] = start[k + 1] - start[0];
    v[k] = end[k + 1] - end[0] - p[k];
  }
  const Vec3 pp = p[0].cross(p[1]), pv = p[0].cross(v[1]) + v[0].cross(p[1]), vv = v[0].cross(v[1]);
  return {pp.dot(p[2]), pp.dot(v[2]) + pv.dot(p[2]), pv.dot(v[2]) + vv.dot(p[2]), vv.dot(v[2])};
}

double bisect(const Cubic& f, double low, double high) {
  constexpr int kHalvings = 30;
  const bool is_negative = f.at(low) < 0;
  for (int i = 0; i < kHalvings; ++i) {
    const double middle = 0.5 * (low + high);
    ((f.at(middle) < 0) == is_negative ? low : high) = middle;
  }
  return high;
}

}  // namespace

std::optional<double> find_coplanar_time(const std::array<Vec3, 4>& start, const std::array<Vec3, 4>& end) {
  const Cubic f = volume(start, end);
  // Between these times it is monotonic: f' = b + 2 c t + 3 d t².
  std::array<double, 4> times = {0, 1, 1, 1};
  const double root_sq = f.c * f.c - 3 * f.b * f.d;
  if (root_sq > 0) {
    const double q = -(f.c + std::copysign(std::sqrt(root_sq), f.c));
    int count = 1;
    for (const double t : {f.d != 0 ? q / (3 * f.d) : 2.0, q != 0 ? f.b / q : 2.0}) {
      if (t > 0 && t < 1) times[count++] = t;
    }
    if (count == 3 && times[1] > times[2]) std::swap(times[1], times[2]);
  }
  for (int k = 0; k < 3; ++k) {
    const double before = f.at(times[k]), after = f.at(times[k + 1]);
    if ((before < 0 && after > 0) || (before > 0 && after < 0)) return bisect(f, times[k], times[k + 1]);
  }
  return std::nullopt;
}

}  // namespace weft::engine
