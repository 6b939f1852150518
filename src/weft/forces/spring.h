#pragma once
/// The elastic force of a spring (the paper's Eq. 1).
///
///      i o----------/\/\/\----------o j        d = x_j − x_i,  l = |d|,  d̂ = d/l
///        --->  f_i          f_j <---           f_j = −f_i
///
/// All functions take d [m], so that they do not depend on the cloth's position.

#include <algorithm>

#include "weft/core/vec.h"

namespace weft::engine {

/// ½ k (l − l0)² [J].
inline double spring_energy(double k, double rest_length, const Vec3& d) {
  const double extension = d.norm() - rest_length;
  return 0.5 * k * extension * extension;
}

/// Force on i: k (l − l0) d̂ [N]; zero for coincident ends, where the direction is undefined.
inline Vec3 spring_force(double k, double rest_length, const Vec3& d) {
  const double length = d.norm();
  if (length == 0) return Vec3::Zero();
  return (k * (length - rest_length) / length) * d;
}

/// ∂f_i/∂x_j = −∂f_i/∂x_i = k [d̂d̂ᵀ + (1 − l0/l)(I − d̂d̂ᵀ)] [N/m]. Indefinite for a compressed spring; k I
/// for coincident ends.
inline Mat3 spring_jacobian(double k, double rest_length, const Vec3& d) {
  const double length = d.norm();
  if (length == 0) return k * Mat3::Identity();
  const Vec3 u = d / length;
  const double transverse = k * (1 - rest_length / length);
  return (k - transverse) * u * u.transpose() + transverse * Mat3::Identity();
}

/// SPD projection: the same with the transverse stiffness clamped at zero. Compressed springs then have no
/// lateral stiffness, so that a line search must guard the step.
inline Mat3 spring_jacobian_clamped(double k, double rest_length, const Vec3& d) {
  const double length = d.norm();
  if (length == 0) return k * Mat3::Identity();
  const Vec3 u = d / length;
  const double transverse = k * std::max(0.0, 1 - rest_length / length);
  return (k - transverse) * u * u.transpose() + transverse * Mat3::Identity();
}

}  // namespace weft::engine
