#pragma once
/// Contact constraints of a step, and the projection of positions onto them.

#include <array>
#include <cmath>
#include <vector>

#include "weft/core/vec.h"

namespace weft::engine {

/// n · Σ w_i x_i >= target, where x_i are vertices of cloths and mesh colliders. Weights of one feature are
/// positive, of the other negative (see geometry/distance.h); a primitive shape adds no negative weights.
struct Constraint {
  int num_vertices = 1;  // 1 to 4; against a primitive shape 1 or 3
  std::array<int, 4> vertex = {0, 0, 0, 0};
  std::array<double, 4> weight = {1, 0, 0, 0};  // [1]
  Vec3 normal = Vec3::UnitY();                  // unit length
  double target = 0;                            // [m]
  double friction = 0;                          // Coulomb's coefficient [1]
  Vec3 surface_velocity = Vec3::Zero();         // of a primitive shape's surface there [m/s]
  int shape = -1;                               // primitive shape index, -1: a pair of features
  bool is_fixed = false;                        // the plane of a primitive shape is not updated
  bool is_between = false;  // another collider faces the cloth there: the particle is not lifted off this one
  bool is_caught = false;   // of a caught particle (caught_particles.h); `shape`: a collider
  bool is_alone = false;    // its one vertex has no other constraint (mark_alone)

  double inverse_mass = 0;               // Σ w_i²/m_i [1/kg]
  bool is_active = false;                // the position projection pushed it
  double push = 0;                       // accumulated by the position projection, >= 0 [kg m]
  double impulse = 0;                    // accumulated by the velocity projection, >= 0 [N s]
  Vec3 friction_impulse = Vec3::Zero();  // [N s]

  Vec3 sum(const std::vector<Vec3>& values) const {
    Vec3 result = weight[0] * values[vertex[0]];
    for (int k = 1; k < num_vertices; ++k) result += weight[k] * values[vertex[k]];
    return result;
  }

  /// Σ w_i²/m_i over all its vertices [1/kg]. 0 where free vertices have almost no weight, beside a pin: to move the
  /// contact they would have to move a hundred times as far.
  double inverse_mass_of(const std::vector<double>& inverse_masses) const {
    constexpr double kLeastWeight = 1e-2;
    double result = 0;
    bool moves = false;
    for (int k = 0; k < num_vertices; ++k) {
      result += weight[k] * weight[k] * inverse_masses[vertex[k]];
      moves |= inverse_masses[vertex[k]] > 0 && std::abs(weight[k]) > kLeastWeight;
    }
    return moves ? result : 0;
  }

  /// Applies the impulse p: each vertex receives its weighted share over its mass.
  void apply(const Vec3& p, const std::vector<double>& inverse_masses, std::vector<Vec3>& values) const {
    for (int k = 0; k < num_vertices; ++k) values[vertex[k]] += weight[k] * inverse_masses[vertex[k]] * p;
  }
};

/// Sets Constraint::is_alone; `count` is work space.
void mark_alone(std::vector<Constraint>& constraints, std::size_t num_vertices, std::vector<int>& count);

/// Contact projection of positions: Gauss–Seidel over the constraints in order, at most `passes` times. The
/// accumulated push of each constraint stays >= 0, so later passes may reduce earlier pushes. From the third
/// pass on, constraints with much room are skipped; `near` is work space for the numbers of the others. The
/// first pass is exact for constraints that are alone.
/// Returns the largest correction of the first pass [m].
double project_positions(const std::vector<double>& inverse_masses, int passes,
                         std::vector<Constraint>& constraints, std::vector<Vec3>& positions,
                         std::vector<int>& near);

}  // namespace weft::engine
