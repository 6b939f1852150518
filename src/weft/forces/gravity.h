#pragma once
/// Gravity (the paper's Eq. 3).

#include "weft/core/vec.h"

namespace weft::engine {

/// m g [N]; its Jacobian is zero.
inline Vec3 gravity_force(double mass, const Vec3& gravity) { return mass * gravity; }

/// −m g·x, zero at the world's origin [J].
inline double gravity_energy(double mass, const Vec3& gravity, const Vec3& position) {
  return -mass * gravity.dot(position);
}

}  // namespace weft::engine
