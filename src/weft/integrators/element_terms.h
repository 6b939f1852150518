#pragma once
/// Private to integrators/: the elements' terms in the incremental potential of implicit Euler.
///
///     Σ ½ A eᵀ C e + Σ ½ k |c|² (or Σ ½ k θ²) + τ/(2h) Σ (A δeᵀ C δe + k δc²)
///
/// e is the strain of a patch (forces/membrane_patch.h), whose difference has corresponding terms. Damping acts on the change since the start of the step: δe = B₀ (x − x₀), B₀ the strain's derivative
/// there, and δc = ĉ₀·Σ w (x − x₀), the change of the curvature's length: both are zero for a rigid rotation.
/// Hinges are damped like stencils, by the change of their angle.

#include <array>
#include <functional>
#include <vector>

#include "weft/forces/hinge.h"
#include "weft/forces/membrane_patch.h"
#include "weft/model/cloth_elements.h"

namespace weft::engine {

class ElementTerms {
 public:
  using AddBlock = std::function<void(int i, int j, const Mat3& block)>;  // i == j: to the diagonal

  /// The damping terms are linearised at `shape`; a first-order integrator may pass `start`.
  void begin_step(const ClothElements& elements, double step, const std::vector<Vec3>& start,
                  const std::vector<Vec3>& shape);

  double energy(const std::vector<Vec3>& x) const;

  /// Whether a principal stretch exceeds a strain limit by more than the solver's tolerance.
  bool is_beyond_limit(const std::vector<Vec3>& x) const;
  void add_gradient(const std::vector<Vec3>& x, std::vector<Vec3>& gradient) const;

  /// The Hessian's blocks, every pair i, j once or more often, in one order only. `filter` selects the stress
  /// term; hinges contribute the Gauss–Newton part only.
  void add_hessian(const std::vector<Vec3>& x, StressFilter filter, const AddBlock& add) const;

  /// All particle pairs that add_hessian may use, i < j, sorted.
  static std::vector<std::pair<int, int>> find_pairs(const ClothElements& elements);

 private:
  /// Vertices with weights; their weighted sum along a direction is damped: ½ stiffness (direction·Σ w δx)².
  struct DampedRow {
    int begin = 0, end = 0;  // range of vertex_ and weight_
    double stiffness = 0;
  };

  void damp_membranes(double share, const std::vector<Vec3>& shape);
  void damp_bending(double share, const std::vector<Vec3>& shape);

  const ClothElements* elements_ = nullptr;
  std::vector<Vec3> start_;
  std::vector<DampedRow> damped_;
  std::vector<int> vertex_;
  std::vector<Vec3> weight_;  // weight times direction
};

}  // namespace weft::engine
