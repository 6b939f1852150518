#pragma once
/// A contact as position-level integrators see it, and the contact force that the solve found.

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "weft/core/vec.h"

namespace weft::engine {

/// Contact tolerance: a solve may leave a contact short of its gap by at most this share of the gap [1].
constexpr double kMaxShortfall = 0.3;

/// Limit of the factors on a contact's stiffness, together [1].
constexpr double kMostStiff = 64;

/// Half-space constraint on a cloth point, or on the difference of two, for one step.
///
///                 o Σ w_i x_i
///     ------------------------- n · Σ w_i x_i = offset        x relative to the origin of its own cloth
///     / / / / / / / / / / / / /
///
/// Stencils: a particle (1), a triangle's point (w0, w1, w2), a particle over a triangle (1, −w0, −w1, −w2),
/// two edges (1−s, s, −(1−t), −t). Points on colliders enter `offset` and `stick_point`. Particles are
/// numbered through all cloths, in their order.
///
/// Integrators apply the force stiffness · (offset − n · Σ w_i x_i) where that is positive, times w_i on each
/// particle, and friction of up to `friction` times that force against sliding away from the stick point
/// `stick_point`.
struct Contact {
  int num_particles = 1;  // 1 to 4
  std::array<int, 4> particle = {0, 0, 0, 0};
  std::array<double, 4> weight = {1, 0, 0, 0};  // [1]
  Vec3 normal = Vec3::UnitY();                  // unit length
  double offset = 0;                            // [m]
  double gap = 0;                               // minimum distance between the two [m]
  double depth_before = 0;                      // at the start of the step, where meaningful [m]
  double stiffness = 0;                         // [N/m]
  double stiffened = 1;                         // factor that the stiffness includes [1]
  double lasting_force = 0;                     // that it bore in both of the last two steps, about [N]
  double friction = 0;                          // Coulomb's coefficient [1]
  Vec3 stick_point = Vec3::Zero();              // stick point of Σ w_i x_i [m]

  // Results of the solve.
  bool has_pushed = false;    // at any time during the solve
  bool is_solved = false;     // all contacts of its group are within kMaxShortfall
  double push = 0;            // normal force at the end [N]
  Vec3 force = Vec3::Zero();  // on Σ w_i x_i, friction included; if requested [N]

  /// Cloth–cloth contact: Σ w_i = 0, else ±1.
  bool is_mutual() const {
    double sum = 0;
    for (int k = 0; k < num_particles; ++k) sum += weight[k];
    return std::abs(sum) < 0.5;
  }

  /// Penetration beyond the plane; negative on the free side, where the depth is 0 [m].
  double beyond(const Vec3& point) const { return offset - normal.dot(point); }
  double depth_at(const Vec3& point) const { return std::max(0.0, beyond(point)); }

  /// Tangential displacement from the stick point [m].
  Vec3 slide_at(const Vec3& point) const {
    const Vec3 moved = point - stick_point;
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
