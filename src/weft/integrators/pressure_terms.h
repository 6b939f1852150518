#pragma once
/// Private to integrators/: gas inside closed cloth (forces/pressure.h) in the potential of `newton`.

#include <memory>

#include "weft/forces/pressure.h"
#include "weft/integrators/newton_term.h"

namespace weft::engine {

/// E(V) − E at the start of the step, with its force, and the part E″ ∂V ∂Vᵀ of its Hessian.
class PressureTerms final : public NewtonTerm {
 public:
  void begin(const Step& step) override;
  double energy(const Place& at, JobSystem& jobs) override;
  double linearise(const Place& at, JobSystem& jobs, Vec3Array& force) override;
  double add_product(const Vec3Array& p, JobSystem& jobs, Vec3Array& q) override;

  bool has_hessian() const { return stiffness_ != 0; }

  /// ∂V of the last linearise(), if there is gas [m²].
  Vec3Array& gradient() { return gradient_; }

  /// Before precondition(): solve(r, z) computes z = P⁻¹ r, with the preconditioner P of all else.
  template <class Solve>
  void begin_preconditioner(const Solve& solve) {
    if (solved_.size() != gradient_.size()) solved_ = Vec3Array(gradient_.size());
    solve(gradient_, solved_);
    share_ = stiffness_ / (1 + stiffness_ * dot(gradient_, solved_));
  }

  /// Includes the Hessian in a preconditioner: makes of z = P⁻¹ r that of P with it (Sherman and Morrison), and
  /// of r·z the new one, which it returns.
  double precondition(double r_dot_z, Vec3Array& z) const;

 private:
  double volume(const Vec3Array& x) const;
  double dot(const Vec3Array& a, const Vec3Array& b) const;
  void add(double factor, const Vec3Array& values, Vec3Array& to) const;

  Gas gas_;
  std::shared_ptr<const ClothTopology> topology_;
  PaddedRows rows_;
  double start_ = 0;      // E at the start of the step [J]
  double stiffness_ = 0;  // E″ [Pa/m³]
  Vec3Array gradient_, solved_;
  double share_ = 0;  // E″ / (1 + E″ ∂V·P⁻¹∂V) [Pa/m³]
};

}  // namespace weft::engine
