#pragma once
/// Private to integrators/: bending with memory (forces/thread_bends.h) in the potential of `newton`.

#include <vector>

#include "weft/forces/thread_bends.h"
#include "weft/integrators/newton_term.h"

namespace weft::engine {

/// The rows of a step, each n·Σ w x. The Hessian takes a row's stiffness, not its tangent: sliding threads keep a part
/// that guides Newton steps (a majoriser: the energy decreases).
/// The preconditioner needs no change: like elastic bending, friction is small beside inertia and stretching.
class ThreadBendTerms final : public NewtonTerm {
 public:
  void begin(const Step& step) override;
  double energy(const Place& at, JobSystem& jobs) override;
  double linearise(const Place& at, JobSystem& jobs, Vec3Array& force) override;
  double add_product(const Vec3Array& p, JobSystem& jobs, Vec3Array& q) override;

 private:
  int num_rows() const { return step_.rows ? step_.rows->num_rows() : 0; }
  void transpose(int num_particles);
  double curvature(int row, const Vec3Array& x) const;
  double sum_parts() const;
  void scatter(JobSystem& jobs, double sign, Vec3Array& to) const;

  std::uint64_t model_id_ = 0;
  ThreadBendStep step_;      // refers to the model, which outlives the step
  std::vector<int> padded_;  // (num_particles) index in padded arrays
  // The entries of each particle, in ascending order of rows.
  std::vector<int> first_entry_;  // (num_particles + 1)
  std::vector<int> entry_row_;
  std::vector<double> entry_weight_;
  std::vector<double> stiffness_, moment_, part_;  // (num_rows)
};

}  // namespace weft::engine
