#pragma once
/// Private to integrators/: aerodynamic drag and lift (forces/air.h) in the potential of `newton`.
///
///     Σ_i 1/(2 rate) (s_i − rate e_i)ᵀ G_i (s_i − rate e_i)
///
/// where e_i is the correction of the prediction, s_i the slip there, and `rate` the derivative of velocity with
/// respect to position [1/s]. G_i is that of the start of the step.

#include <vector>

#include "weft/forces/environment_terms.h"
#include "weft/integrators/newton_term.h"

namespace weft::engine {

class AirTerms final : public NewtonTerm {
 public:
  void begin(const Step& step) override;

  /// Sets the velocity of each particle in the prediction, before any evaluation.
  void set_velocities(const Vec3Array& velocity, double rate);

  bool is_active() const { return !air_.matrix.empty(); }

  double energy(const Place& at, JobSystem& jobs) override;
  double linearise(const Place& at, JobSystem& jobs, Vec3Array& force) override;
  double add_product(const Vec3Array& p, JobSystem& jobs, Vec3Array& q) override;

 private:
  double energy(int i, const Vec3& e) const {
    const Vec3 slip = slip_[i] - rate_ * e;
    return 0.5 / rate_ * slip.dot(air_.matrix[i] * slip);
  }

  PaddedRows rows_;
  double rate_ = 1;
  ParticleAir air_;
  std::vector<Vec3> slip_;  // s [m/s]
};

}  // namespace weft::engine
