#pragma once
/// One close pair, as an integrator that solves for positions sees it.

#include <array>
#include <cmath>

#include "weft/core/vec.h"

namespace weft {

/// A point of a cloth, or the gap between two, that a step must keep on one side of a plane.
///
///                 o Σ w_i x_i
///     ------------------------- n · Σ w_i x_i = offset        x relative to the cloth's origin
///     / / / / / / / / / / / / /
///
/// Stencils: a particle (1), a triangle's point (w0, w1, w2), a particle over a triangle of the same cloth
/// (1, −w0, −w1, −w2), two of its edges (1−s, s, −(1−t), −t). What lies on other cloths or on colliders is in
/// offset and grip.
///
/// Integrators push with the force stiffness · (offset − n · Σ w_i x_i) where that is positive, w_i of it on
/// each particle, and with up to `friction` times that force against sliding away from `grip`.
struct Contact {
  int num_particles = 1;  // 1 to 4
  std::array<int, 4> particle = {0, 0, 0, 0};
  std::array<double, 4> weight = {1, 0, 0, 0};  // [1]
  Vec3 normal = Vec3::UnitY();                  // unit length
  double offset = 0;                            // [m]
  double depth_before = 0;                      // at the start of the step, if it tells [m]
  double stiffness = 0;                         // [N/m]
  double friction = 0;                          // Coulomb's coefficient [1]
  Vec3 grip = Vec3::Zero();                     // where Σ w_i x_i would be if it stuck [m]

  /// Whether the cloth pushes itself alone: Σ w_i = 0, else ±1.
  bool is_within_cloth() const {
    double sum = 0;
    for (int k = 0; k < num_particles; ++k) sum += weight[k];
    return std::abs(sum) < 0.5;
  }

  /// Σ w_i x_i.
  template <class Positions>
  Vec3 point(const Positions& x) const {
    Vec3 sum = weight[0] * x[particle[0]];
    for (int k = 1; k < num_particles; ++k) sum += weight[k] * x[particle[k]];
    return sum;
  }

  /// How far the point is beyond the plane, 0 if it is not [m].
  template <class Positions>
  double depth(const Positions& x) const {
    const double beyond = offset - normal.dot(point(x));
    return beyond > 0 ? beyond : 0.0;
  }

  /// How far it has slid along the plane.
  template <class Positions>
  Vec3 slide(const Positions& x) const {
    const Vec3 moved = point(x) - grip;
    return moved - moved.dot(normal) * normal;
  }
};

}  // namespace weft
