#pragma once
/// Contact projection of velocities: stops approaching pairs, and slows sliding ones by Coulomb friction.
///
///     P >= 0,  v_n >= 0,  |T| <= µ P,  T against the sliding direction     (v relative, P and T impulses)
///
/// Projected Gauss–Seidel in the order of the constraints, with level scheduling: a row comes one level after
/// the last earlier row that shares a vertex with it. Rows of one level are independent, so the processor
/// overlaps them; the result is the same as in the given order. A constraint that is alone is solved exactly, in
/// one visit.

#include <array>
#include <vector>

#include "weft/contact/constraint.h"

namespace weft::engine {

/// A vector in a register of four; the last component is 0.
struct alignas(32) Quad {
  double at[4] = {0, 0, 0, 0};

  Vec3 to_vec3() const { return {at[0], at[1], at[2]}; }
};

inline Quad to_quad(const Vec3& v) { return {{v.x(), v.y(), v.z(), 0}}; }

class VelocityProjection {
 public:
  /// Processes the constraints that are active after the position projection, and sets their impulses.
  /// `slowed` receives the part of each velocity change that friction made. All (num_vertices) [m/s].
  void project(const std::vector<double>& inverse_masses, std::vector<Constraint>& constraints,
               std::vector<Quad>& velocities, std::vector<Quad>& slowed);

  /// An active constraint.
  struct Row {
    Quad normal, surface_velocity, friction_impulse;
    std::array<double, 4> weight, response;  // w_i [1], w_i/m_i [1/kg]
    std::array<int, 4> vertex;
    int num_vertices, constraint;
    double inverse_mass, friction, impulse;
  };

 private:
  void schedule(const std::vector<double>& inverse_masses, const std::vector<Constraint>& constraints);

  std::vector<Row> rows_;            // sorted by level
  std::vector<int> active_, level_;  // (rows) in the order of the constraints
  std::vector<int> level_begin_;     // (levels) into rows_
  std::vector<int> next_level_;      // (num_vertices) level of the next row with it; 0 between calls
};

}  // namespace weft::engine
