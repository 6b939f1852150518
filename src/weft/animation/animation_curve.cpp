#include "weft/animation/animation_curve.h"

#include <algorithm>

#include "weft/core/angle.h"

namespace weft::engine {
namespace {

/// A key, and the position between it and the next one.
struct Interval {
  std::size_t key = 0;
  double share = 0;   // of the way to the next key; 0: at this key, or outside all keys [1]
  double length = 0;  // [s]
};

Interval find_interval(const std::vector<double>& times, double time) {
  const auto next = std::upper_bound(times.begin(), times.end(), time);
  if (next == times.begin()) return {};
  const auto key = static_cast<std::size_t>(next - times.begin()) - 1;
  if (next == times.end()) return {.key = key};
  const double length = *next - times[key];
  return {.key = key, .share = (time - times[key]) / length, .length = length};
}

/// Spherical linear interpolation from a to b, or to −b if that is nearer. Its angle is computed by
/// find_angle_deg, because C libraries differ in the last bits of acos and sin.
Eigen::Quaterniond slerp(const Eigen::Vector4d& a, Eigen::Vector4d b, double share) {
  double cosine = a.dot(b);
  if (cosine < 0) {
    b = -b;
    cosine = -cosine;
  }
  const Eigen::Vector4d across = b - cosine * a;
  const double sine = across.norm();
  if (!(sine > 0)) return Eigen::Quaterniond(a);
  const SinCos turned = sin_cos_deg(share * find_angle_deg(sine, cosine));
  return Eigen::Quaterniond(turned.cos * a + turned.sin / sine * across);
}

}  // namespace

void evaluate(const AnimationCurve& curve, double time, std::span<double> value) {
  const auto [key, t, length] = find_interval(curve.times, time);
  const std::size_t width = value.size();
  const bool is_spline = curve.interpolation == Interpolation::cubic_spline;
  const double* const a = curve.values.data() + (is_spline ? 3 * key + 1 : key) * width;
  const double t2 = t * t, t3 = t2 * t;
  for (std::size_t k = 0; k < width; ++k) {
    if (t == 0 || curve.interpolation == Interpolation::step) {
      value[k] = a[k];
    } else if (is_spline) {
      const double outgoing = a[width + k], incoming = a[2 * width + k], b = a[3 * width + k];
      value[k] = (2 * t3 - 3 * t2 + 1) * a[k] + length * (t3 - 2 * t2 + t) * outgoing +
                 (3 * t2 - 2 * t3) * b + length * (t3 - t2) * incoming;
    } else {
      value[k] = (1 - t) * a[k] + t * a[width + k];
    }
  }
}

Eigen::Quaterniond evaluate_rotation(const AnimationCurve& curve, double time) {
  const auto [key, share, length] = find_interval(curve.times, time);
  if (curve.interpolation == Interpolation::linear && share > 0) {
    const Eigen::Map<const Eigen::Vector4d> a(&curve.values[4 * key]), b(&curve.values[4 * key + 4]);
    return slerp(a.normalized(), b.normalized(), share);
  }
  Eigen::Vector4d value;
  evaluate(curve, time, {value.data(), 4});
  return Eigen::Quaterniond(value.normalized());
}

}  // namespace weft::engine
