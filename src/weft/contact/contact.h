#pragma once
/// One close pair, as an integrator that solves for positions sees it, and the force it found there.

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "weft/core/vec.h"

namespace weft::engine {

/// The share of its gap that a solve may leave a contact short of [1].
constexpr double kMaxLack = 0.3;

/// A point of cloth, or the gap between two, that a step must keep on one side of a plane.
///
///                 o Σ w_i x_i
///     ------------------------- n · Σ w_i x_i = offset        x relative to the origin of its own cloth
///     / / / / / / / / / / / / /
///
/// Stencils: a particle (1), a triangle's point (w0, w1, w2), a particle over a triangle (1, −w0, −w1, −w2),
/// two edges (1−s, s, −(1−t), −t). What lies on colliders is in offset and grip. Particles are numbered
/// through all cloths, in their order.
///
/// Integrators push with the force stiffness · (offset − n · Σ w_i x_i) where that is positive, w_i of it on
/// each particle, and with up to `friction` times that force against sliding away from `grip`.
struct Contact {
  int num_particles = 1;  // 1 to 4
  std::array<int, 4> particle = {0, 0, 0, 0};
  std::array<double, 4> weight = {1, 0, 0, 0};  // [1]
  Vec3 normal = Vec3::UnitY();                  // unit length
  double offset = 0;                            // [m]
  double gap = 0;                               // that is to be kept between the two [m]
  double depth_before = 0;                      // at the start of the step, if it tells [m]
  double stiffness = 0;                         // [N/m]
  double friction = 0;                          // Coulomb's coefficient [1]
  Vec3 grip = Vec3::Zero();                     // where Σ w_i x_i would be if it stuck [m]

  // What the solve found.
  bool has_pushed = false;    // at any time in it
  bool is_solved = false;     // no contact of its group lacks more than kMaxLack
  Vec3 force = Vec3::Zero();  // on Σ w_i x_i, friction included; if it was asked for [N]

  /// Whether cloth pushes cloth: Σ w_i = 0, else ±1.
  bool is_mutual() const {
    double sum = 0;
    for (int k = 0; k < num_particles; ++k) sum += weight[k];
    return std::abs(sum) < 0.5;
  }

  /// How far a point is beyond the plane; negative, or as a depth 0, if it is not [m].
  double beyond(const Vec3& point) const { return offset - normal.dot(point); }
  double depth_at(const Vec3& point) const { return std::max(0.0, beyond(point)); }

  /// How far it has slid along the plane.
  Vec3 slide_at(const Vec3& point) const {
    const Vec3 moved = point - grip;
    return moved - moved.dot(normal) * normal;
  }

  /// Σ w_i x_i.
  Vec3 point(const std::vector<Vec3>& x) const {
    Vec3 sum = weight[0] * x[particle[0]];
    for (int k = 1; k < num_particles; ++k) sum += weight[k] * x[particle[k]];
    return sum;
  }
  double depth(const std::vector<Vec3>& x) const { return depth_at(point(x)); }
  Vec3 slide(const std::vector<Vec3>& x) const { return slide_at(point(x)); }
};

}  // namespace weft::engine
