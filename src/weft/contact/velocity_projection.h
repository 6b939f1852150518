#pragma once
/// Contact projection of velocities: what approaches is stopped, what slides is slowed by Coulomb's law.
///
///     P >= 0,  v_n >= 0,  |T| <= µ P,  T against the slide          (v relative, P and T impulses)
///
/// Projected Gauss–Seidel in the order of the constraints. Its rows are scheduled by levels: a row comes one
/// level after the last of the rows before it that share a vertex with it. Rows of one level are independent,
/// so that the processor overlaps them; the result is that of the order given.

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
  /// Constraints that pushed positions act; their impulses are set. `slowed` gets the part of each velocity's
  /// change that friction made. All (num_vertices) [m/s].
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

  std::vector<Row> rows_;            // by levels
  std::vector<int> active_, level_;  // (rows) in the order of the constraints
  std::vector<int> level_begin_;     // (levels) of rows_
  std::vector<int> next_level_;      // (num_vertices) of the next row with it; 0 between calls
};

}  // namespace weft::engine
