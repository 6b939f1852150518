#pragma once
/// What a step must keep apart, and how positions and velocities are made to obey.

#include <array>
#include <vector>

#include "weft/core/vec.h"

namespace weft::engine {

/// n · Σ w_i x_i >= target, where x_i are vertices of cloths and mesh colliders. Weights of one feature are
/// positive, of the other negative (see geometry/distance.h); against a plain shape there is only the first.
struct Constraint {
  int num_vertices = 1;  // 1 to 4; of a plain shape's constraints 2 are the ends of an edge
  std::array<int, 4> vertex = {0, 0, 0, 0};
  std::array<double, 4> weight = {1, 0, 0, 0};  // [1]
  Vec3 normal = Vec3::UnitY();                  // unit length
  double target = 0;                            // [m]
  double friction = 0;                          // Coulomb's coefficient [1]
  Vec3 surface_velocity = Vec3::Zero();         // of a plain shape's surface there [m/s]
  int shape = -1;                               // the plain shape's number, -1: a pair of features
  bool is_fixed = false;                        // a plain shape's plane is not to be taken anew

  double inverse_mass = 0;               // Σ w_i²/m_i [1/kg]
  bool is_active = false;                // positions had to be pushed
  double push = 0;                       // that positions needed, >= 0 [kg m]
  double impulse = 0;                    // that velocities needed, >= 0 [N s]
  Vec3 friction_impulse = Vec3::Zero();  // [N s]

  Vec3 sum(const std::vector<Vec3>& values) const {
    Vec3 result = weight[0] * values[vertex[0]];
    for (int k = 1; k < num_vertices; ++k) result += weight[k] * values[vertex[k]];
    return result;
  }

  /// Σ w_i²/m_i over all its vertices [1/kg].
  double inverse_mass_of(const std::vector<double>& inverse_masses) const {
    double result = 0;
    for (int k = 0; k < num_vertices; ++k) result += weight[k] * weight[k] * inverse_masses[vertex[k]];
    return result;
  }

  /// Adds the impulse p, each vertex' share over its mass.
  void apply(const Vec3& p, const std::vector<double>& inverse_masses, std::vector<Vec3>& values) const {
    for (int k = 0; k < num_vertices; ++k) values[vertex[k]] += weight[k] * inverse_masses[vertex[k]] * p;
  }
};

/// Moves positions until all constraints hold: Gauss–Seidel, in order, at most `passes` times. Each
/// constraint's push is kept positive as a whole, so that later passes may take back what earlier ones gave.
/// From the third pass on those that have much room are left out; `near` is work space for the others'
/// numbers. Returns the largest correction of the first pass [m].
double project_positions(const std::vector<double>& inverse_masses, int passes,
                         std::vector<Constraint>& constraints, std::vector<Vec3>& positions,
                         std::vector<int>& near);

}  // namespace weft::engine
