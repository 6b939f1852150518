#pragma once
/// Damping of a spring i–j by the relative velocity w = v_j − v_i of its ends; b is the coefficient [N·s/m].

#include "weft/core/vec.h"

namespace weft::engine {

/// Force on i: b (v_j − v_i) [N] (the paper's Eq. 2 with the sign corrected: as printed it amplifies motion).
/// Conserves linear momentum, but also brakes a rigid rotation.
inline Vec3 plain_damping_force(double b, const Vec3& w) { return b * w; }

/// ∂f_i/∂v_j = −∂f_i/∂v_i [N·s/m].
inline Mat3 plain_damping_jacobian(double b) { return b * Mat3::Identity(); }

/// Force on i: b (w·d̂) d̂ [N], d = x_j − x_i: damps only changes of the spring's length, not rigid rotation.
/// Zero for coincident ends.
inline Vec3 projected_damping_force(double b, const Vec3& d, const Vec3& w) {
  const double length_sq = d.squaredNorm();
  if (length_sq == 0) return Vec3::Zero();
  return (b * w.dot(d) / length_sq) * d;
}

/// ∂f_i/∂v_j = −∂f_i/∂v_i = b d̂d̂ᵀ [N·s/m]; zero for coincident ends.
inline Mat3 projected_damping_jacobian(double b, const Vec3& d) {
  const double length_sq = d.squaredNorm();
  if (length_sq == 0) return Mat3::Zero();
  return (b / length_sq) * d * d.transpose();
}

}  // namespace weft::engine
