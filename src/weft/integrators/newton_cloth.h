#pragma once
/// Private to integrators/: a cloth in the system that `newton` solves.

#include <array>
#include <memory>
#include <vector>

#include "weft/forces/potential.h"
#include "weft/integrators/air_terms.h"
#include "weft/integrators/collapse_terms.h"
#include "weft/integrators/common.h"
#include "weft/integrators/contact_terms.h"
#include "weft/integrators/floating_components.h"
#include "weft/integrators/newton_kernels.h"
#include "weft/integrators/pressure_terms.h"
#include "weft/integrators/scalar_preconditioner.h"
#include "weft/integrators/terms_as_written.h"
#include "weft/integrators/thread_bend_terms.h"
#include "weft/solvers/conjugate_gradients.h"

namespace weft::engine {

/// Its potential without contacts, the preconditioner, and the step from prediction to state. Call the
/// functions in this order.
class NewtonCloth {
 public:
  NewtonCloth() = default;
  NewtonCloth(const NewtonCloth&) = delete;
  NewtonCloth& operator=(const NewtonCloth&) = delete;

  /// Prepares the cloth for a step, and initialises its history if it has none.
  void begin(const Body& body, const SystemStep& step);

  /// Whether contact was active in the last step.
  bool is_first_order() const { return state_->history.is_held || state_->history.had_contact; }

  /// Ballistic prediction: implicit Euler without springs. The state is unchanged.
  ContactTerms::Positions place_freely(JobSystem& jobs);

  /// Stores the mean acceleration of the last step, for start_inertial(). Call it before predict().
  void store_velocity_gain();

  /// Predicts by BDF2 or implicit Euler. The correction e is zero.
  void predict(bool is_euler, JobSystem& jobs);

  bool has_elements() const { return model_->elements != nullptr; }

  /// Sets the trial to an inertial start: x + h v, or the same with the cloth's mean acceleration in the last
  /// step. Green strain's energy is quartic: of the stretch that gravity causes beside a pin in a step, a
  /// single Newton step removes only two thirds, and cloth at rest would hang lower the longer the step is.
  void start_inertial(bool accelerates);

  /// The potential at e, or at the trial [J].
  double energy(JobSystem& jobs) { return energy_at(correction_, jobs); }
  double trial_energy(JobSystem& jobs) { return energy_at(trial_, jobs); }

  /// The potential at e [J], with its force and Hessian.
  double linearise(JobSystem& jobs);

  /// Updates the preconditioner. Between the two calls contacts add their part to preconditioners().
  /// `is_active`: whether any contact pushes. `is_first`: the first linearisation of the step.
  void begin_preconditioner(bool is_first, bool is_active, JobSystem& jobs);
  ContactTerms::Preconditioners preconditioners() {
    return {&stiff_diagonal_, &diagonal_, &contact_preconditioner_};
  }
  void finish_preconditioner(JobSystem& jobs);

  /// In the block: product = A direction and their dot; preconditioned = P⁻¹ residual, likewise.
  CgBlock& block() { return block_; }
  double multiply(JobSystem& jobs);
  double precondition(JobSystem& jobs);

  /// Sets the trial: e plus a share of the solution.
  void try_step(double share, JobSystem& jobs);
  void accept_trial() { std::swap(correction_, trial_); }

  /// Sets the entries of pins to zero, in forces and products.
  void hold_pins(Vec3Array& field) const {
    for (const int p : pinned_) field.set(rows_.index(p), Vec3::Zero());
  }

  /// Stores the corrected motion; `is_pushed`: contact takes part in it.
  void finish(bool is_pushed, JobSystem& jobs);

  /// All forces at e except contact forces, including inertial ones [N].
  const Vec3Array& find_forces(JobSystem& jobs);

  Vec3Array& force() { return force_; }
  Vec3Array& trial() { return trial_; }
  ContactTerms::Positions positions() const { return {&potential_.target, &correction_}; }
  ContactTerms::Positions trial_positions() const { return {&potential_.target, &trial_}; }
  ContactTerms::Member member(int first_particle) const {
    return {model_, &environment_->pins, &rows_, first_particle};
  }
  FreeBodies::Member free_member() const {
    return {&floating_components_, &rows_, &potential_.weight, air_.is_active()};
  }
  double stiffness_number() const { return step_ * step_ * stiffness_rate_; }  // see choose_budget() [1]
  double noise() const { return noise_; }  // rounding error of energies [J]
  bool is_beyond_limit() const {
    return potential_.is_beyond_limit() || as_written_.is_beyond_limit(potential_.positions());
  }
  const Vec3& gravity() const { return environment_->gravity; }

 private:
  /// The values that the matrices depend on.
  struct Key {
    std::uint64_t model_id = 0;
    double step = 0, beta = 0, drag = 0;
    bool operator==(const Key&) const = default;
  };

  void fit(const ClothModel& model, const PinTargets& pins);
  void synthesize_history();
  void add_outside(StepScheme& scheme) const;
  void add_external(const StepScheme& scheme, ClothState& state, Vec3Array& y) const;
  void prepare_matrices(JobSystem& jobs);
  void set_weights(double rate);
  double energy_noise() const;
  void copy_velocity_offset();
  double energy_at(const Vec3Array& e, JobSystem& jobs);
  void update_diagonals(JobSystem& jobs);
  double precondition_without_gas(const Vec3Array& r, JobSystem& jobs, Vec3Array& z);
  void update_stiffer_couplings(bool is_first, JobSystem& jobs);
  bool has_changed_much() const;
  static void clear(Vec3Array& field);

  std::shared_ptr<const ClothTopology> topology_;
  PaddedRows rows_;
  std::vector<int> pinned_;
  FloatingComponents floating_components_;
  double stiffness_rate_ = 0;
  Key key_;
  IncrementalPotential potential_;
  ScalarPreconditioner preconditioner_, stiff_preconditioner_;  // with friction only, with full contacts
  bool has_stiff_springs_ = false;                              // stiff_preconditioner_ is up to date
  ContactPreconditioner contact_preconditioner_;                // combines the two
  bool is_in_contact_ = false;                                  // the preconditioners include contacts
  AirTerms air_;
  CollapseTerms collapse_;
  PressureTerms pressure_;
  ThreadBendTerms thread_bends_;
  TermsAsWritten as_written_;
  const std::array<NewtonTerm*, 5> terms_{&air_, &collapse_, &pressure_, &thread_bends_, &as_written_};
  std::vector<float> diagonal_, stiff_diagonal_;  // of the preconditioners [N/m]
  std::vector<float> least_weight_;               // D for the largest memory [N/m]
  std::vector<double> stiffer_couplings_,
      built_stiffer_;                   // present values, and those in the preconditioner
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
  Vec3 mean_velocity_gain_ = Vec3::Zero();  // of velocity in the last step, at most gravity's [m/s]
  Vec3Array force_, solution_, trial_;
  Vec3Array correction_;  // e = x − y [m]
  CgBlock block_;         // of force_ and solution_
  ClothState scratch_;    // ballistic prediction
};

}  // namespace weft::engine
