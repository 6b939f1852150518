#pragma once
/// Private to integrators/: a cloth in the system that `newton` solves.

#include <memory>
#include <vector>

#include "weft/forces/potential.h"
#include "weft/integrators/air_terms.h"
#include "weft/integrators/collapse_terms.h"
#include "weft/integrators/common.h"
#include "weft/integrators/contact_terms.h"
#include "weft/integrators/free_pieces.h"
#include "weft/integrators/newton_kernels.h"
#include "weft/integrators/scalar_preconditioner.h"
#include "weft/solvers/conjugate_gradients.h"

namespace weft::engine {

/// Its potential but for contacts, the preconditioner that goes with it, and the step from prediction to
/// state. The functions are to be called in this order.
class NewtonCloth {
 public:
  /// Takes the cloth, and gives it a past if it has none.
  void begin(const Body& body, const SystemStep& step, JobSystem& jobs);

  /// Whether contact took part in the step before.
  bool is_first_order() const { return state_->history.is_held || state_->history.had_contact; }

  /// Where implicit Euler without springs would take it; its state stays as it is.
  ContactTerms::Positions place_freely(JobSystem& jobs);

  /// Remembers the mean acceleration of the step before, for coast(). To be called before predict().
  void remember_gain();

  /// Predicts by BDF2 or implicit Euler. The correction e is zero.
  void predict(bool is_euler, JobSystem& jobs);

  bool has_elements() const { return model_->elements != nullptr; }

  /// Puts a start into the trial: where velocities alone lead, x + h v, or they and the cloth's mean
  /// acceleration in the step before. Green strain's energy is quartic: of what gravity stretches in a step
  /// beside a pin, one Newton step takes back two thirds alone, and cloth at rest would hang lower the longer
  /// the step is.
  void coast(bool accelerates);

  /// At e, or at the trial [J].
  double energy(JobSystem& jobs) { return energy_at(correction_, jobs); }
  double trial_energy(JobSystem& jobs) { return energy_at(trial_, jobs); }

  /// The potential at e [J], with its force and Hessian.
  double linearise(JobSystem& jobs);

  /// Makes the preconditioner go with it. Between the two contacts add what they need to preconditioners();
  /// `is_active`: whether any pushes anything. `is_first`: linearisation of the step.
  void begin_preconditioner(bool is_first, bool is_active, JobSystem& jobs);
  ContactTerms::Preconditioners preconditioners() { return {&stiff_diagonal_, &diagonal_, &filter_}; }
  void finish_preconditioner(JobSystem& jobs);

  /// In the block: product = A direction and their dot; preconditioned = P⁻¹ residual, likewise.
  CgBlock& block() { return block_; }
  double multiply(JobSystem& jobs);
  double precondition(JobSystem& jobs);

  /// The trial: e and a share of the solution.
  void try_step(double share, JobSystem& jobs);
  void accept_trial() { std::swap(correction_, trial_); }

  /// Brings pins' forces and products to zero.
  void hold_pins(Vec3Array& field) const {
    for (const int p : pinned_) field.set(rows_.index(p), Vec3::Zero());
  }

  /// Stores the corrected motion; `is_pushed`: contact takes part in it.
  void finish(bool is_pushed, JobSystem& jobs);

  /// All forces at e but those of contacts, inertia's too [N].
  const Vec3Array& find_forces(JobSystem& jobs);

  Vec3Array& force() { return force_; }
  Vec3Array& trial() { return trial_; }
  ContactTerms::Positions positions() const { return {&potential_.target, &correction_}; }
  ContactTerms::Positions trial_positions() const { return {&potential_.target, &trial_}; }
  ContactTerms::Member member(int first_particle) const {
    return {model_, &environment_->pins, &rows_, first_particle};
  }
  FreeBodies::Member free_member() const {
    return {&free_pieces_, &rows_, &potential_.weight, air_.is_active()};
  }
  double reach() const { return step_ * step_ * reach_rate_; }  // see choose_effort() [1]
  double noise() const { return noise_; }                       // of energies, from rounding [J]
  bool is_beyond_limit() const { return potential_.is_beyond_limit(); }
  const Vec3& gravity() const { return environment_->gravity; }

 private:
  /// What the matrices depend on.
  struct Key {
    std::uint64_t model_id = 0;
    double step = 0, beta = 0, drag = 0;
    bool operator==(const Key&) const = default;
  };

  void fit(const ClothModel& model, const PinTargets& pins);
  void invent_history(JobSystem& jobs);
  double free_share(JobSystem& jobs);
  void add_outside(StepScheme& scheme) const;
  void add_external(const StepScheme& scheme, ClothState& state, Vec3Array& y) const;
  void prepare_matrices(JobSystem& jobs);
  void set_weights(double rate);
  double energy_noise() const;
  void copy_lag();
  double energy_at(const Vec3Array& offset, JobSystem& jobs);
  void update_stiffer_couplings(bool is_first, JobSystem& jobs);
  bool has_changed_much() const;
  static void clear(Vec3Array& field);

  std::shared_ptr<const ClothTopology> topology_;
  PaddedRows rows_;
  std::vector<int> pinned_;
  FreePieces free_pieces_;
  double reach_rate_ = 0;
  Key key_;
  IncrementalPotential potential_;
  ScalarPreconditioner preconditioner_, stiff_preconditioner_;  // with contacts' friction, with all of them
  bool has_stiff_springs_ = false;                              // the latter, as they are now
  ContactFilter filter_;                                        // between them
  bool is_in_contact_ = false;                                  // the preconditioners know of contacts
  AirTerms air_;
  CollapseTerms collapse_;
  std::vector<float> diagonal_, stiff_diagonal_;  // of the preconditioners [N/m]
  std::vector<float> least_weight_;               // D for the longest memory [N/m]
  std::vector<double> stiffer_couplings_,
      built_stiffer_;                   // as they should be, as the preconditioner has them
  bool has_stiffer_couplings_ = false;  // in the preconditioner

  // The step.
  const ClothModel* model_ = nullptr;
  const Environment* environment_ = nullptr;
  ClothState* state_ = nullptr;
  double step_ = 0;  // [s]
  StepScheme scheme_;
  WorkClock* clock_ = nullptr;
  PinMotion pin_motion_;
  double noise_ = 0;
  Vec3 mean_gain_ = Vec3::Zero();  // of velocity in the step before, no more than gravity's [m/s]
  Vec3Array force_, solution_, trial_;
  Vec3Array correction_;  // e = x − y [m]
  CgBlock block_;         // of force_ and solution_
  ClothState scratch_;    // where the cloth would go without springs
};

}  // namespace weft::engine
