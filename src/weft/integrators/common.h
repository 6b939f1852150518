#pragma once
/// Private to integrators/: shared parts.

#include <algorithm>
#include <functional>
#include <memory>
#include <vector>

#include "weft/forces/increments.h"
#include "weft/integrators/integrator.h"

namespace weft::engine {

/// An integrator for a single cloth without contacts.
class ClothIntegrator {
 public:
  virtual ~ClothIntegrator() = default;

  /// See Integrator.
  virtual int num_substeps(const ClothModel&, const Environment&, double /*step*/) const { return 1; }
  virtual IntegratorReport advance(const ClothModel& model, const Environment& environment, double step,
                                   JobSystem& jobs, ClothState& state) = 0;
};

/// Advances each cloth by a separate integrator.
std::unique_ptr<Integrator> make_one_by_one(std::function<std::unique_ptr<ClothIntegrator>()> make);

/// Masses and the weights w_i = 1/(m_i + h² Σ_j k_ij) in the layout of the kernels; h = 0 gives 1/m_i. Cached
/// while model and step are unchanged.
class Weights {
 public:
  void fit(const ClothModel& model, double step);

  const std::vector<float>& mass() const { return mass_; }
  const std::vector<float>& weight() const { return weight_; }

 private:
  std::uint64_t model_id_ = 0;
  double step_ = -1;
  std::vector<float> mass_, weight_;
};

/// The velocities that take pinned particles to their targets: (target − x)/h. Computed before the step, set
/// after it.
class PinMotion {
 public:
  void prepare(const PinTargets& pins, double step, const ClothState& state);
  void finish(const PinTargets& pins, ClothState& state) const;

  /// Velocity of each pin at the end of the step (pins) [m/s].
  const std::vector<Vec3>& velocity() const { return velocity_; }

 private:
  std::vector<Vec3> velocity_;
};

/// The share of a cloth's weight that its elastic forces at `x` (num_particles) do not carry, from 0 (it hangs at
/// rest) to 1.
double free_share(const ClothModel& model, const ClothState& state, const std::vector<Vec3>& x,
                  const std::vector<int>& pinned, const Vec3& gravity);

/// Settings of the fast kernels, from model and environment: no gravity, damping as in the material.
IncrementSettings make_increment_settings(const ClothModel& model, const Environment& environment,
                                          double step);

}  // namespace weft::engine
