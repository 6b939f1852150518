#pragma once
/// Private to integrators/: aerodynamic drag and lift (forces/air.h) in the potential of an implicit step.
///
///     Σ_i 1/(2 rate) (s_i − rate e_i)ᵀ G_i (s_i − rate e_i)
///
/// where e_i is the particle's displacement from the position with slip s_i, and `rate` is the derivative of
/// velocity with respect to it [1/s]. G_i is a third of those of the one-ring's triangles, at the start of
/// the step.

#include <vector>

#include "weft/core/padded_rows.h"
#include "weft/core/vec3_array.h"
#include "weft/integrators/integrator.h"

namespace weft::engine {

class AirTerms {
 public:
  /// `state` is the state at the start of the step.
  void begin(const ClothModel& model, const Environment& environment, const ClothState& state);

  /// Sets each particle's velocity at zero displacement, and its derivative with respect to displacement.
  void set_velocities(const Vec3Array& velocity, double rate);
  void set_still(double rate);

  bool is_active() const { return !matrix_.empty(); }

  double energy(int i, const Vec3& e) const {
    const Vec3 slip = slip_[i] - rate_ * e;
    return 0.5 / rate_ * slip.dot(matrix_[i] * slip);
  }
  Vec3 force(int i, const Vec3& e) const { return matrix_[i] * (slip_[i] - rate_ * e); }
  Mat3 hessian(int i) const { return rate_ * matrix_[i]; }

  /// The same for particles laid out by `rows`: the value [J]; adds to forces; q += H p, and p·Hp [J].
  double energy(const PaddedRows& rows, const Vec3Array& e) const;
  double linearise(const PaddedRows& rows, const Vec3Array& e, Vec3Array& force) const;
  double add_product(const PaddedRows& rows, const Vec3Array& p, Vec3Array& q) const;

 private:
  double rate_ = 1;
  std::vector<Mat3> matrix_;      // G of each particle; empty without air [N·s/m]
  std::vector<Vec3> air_, slip_;  // velocity of the air at each particle; s [m/s]
};

}  // namespace weft::engine
