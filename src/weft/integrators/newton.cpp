/// The default integrator: BDF2, one Newton step, and conjugate gradients preconditioned by one multigrid
/// V-cycle on the paper's constant matrix. A step minimises the incremental potential
///
///     E(x) = ½ |x − y|²_D + springs or elements + collapse + dissipation,   D = (β/h)² M + wind,
///     y from two past states and gravity
///
/// (forces/potential.h, forces/collapse.h), starting from y: the bulk of the motion is right whatever the
/// solve does.
///
/// The guard: what the quadratic model missed, E − (E₀ − predicted decrease), asks for another Newton step if
/// it is more than a fifth of E; so does, in stiff cloth, a last Newton step that has still lowered E by a
/// third; a potential that rises makes the step shorter.

#include <algorithm>
#include <cmath>
#include <utility>

#include "weft/forces/potential.h"
#include "weft/integrators/air_terms.h"
#include "weft/integrators/collapse_terms.h"
#include "weft/integrators/common.h"
#include "weft/integrators/contact_terms.h"
#include "weft/integrators/effort.h"
#include "weft/integrators/free_pieces.h"
#include "weft/integrators/newton_kernels.h"
#include "weft/integrators/scalar_preconditioner.h"
#include "weft/solvers/conjugate_gradients.h"

namespace weft {
namespace {

constexpr double kMissedShare = 0.2;   // of the energy: if the model missed more, one more Newton step
constexpr double kFallingShare = 0.5;  // of the energy that is left: likewise if the last step took off more
constexpr int kNewtonStepsInContact = 3;   // the first one knows neither what touches nor how hard
constexpr int kTimesCoasting = 2;          // as many iterations from x + h v: all of gravity is left to them
constexpr double kNoise = 1e-9;            // of the decrease: below, iterations in floats only stir rounding
constexpr int kMostStepsBeyondLimit = 24;  // as long as a stretch is further beyond it than allowed
constexpr double kLimitFalling = 1e-4;     // … while it still takes so much off the energy
constexpr double kMuchStiffer = 8;         // a preconditioner that is off by less will do
constexpr int kMaxHalvings = 8;            // of a Newton step after which the potential is higher than before

class NewtonIntegrator final : public Integrator {
 public:
  explicit NewtonIntegrator(const NewtonSettings& settings) : settings_(settings) {}

  bool resolves_contacts() const override { return true; }
  std::span<const Vec3> contact_forces() const override { return contact_forces_; }
  std::span<const char> pushing_contacts() const override { return contacts_.have_pushed(); }

  IntegratorReport advance(const ClothModel& model, const Environment& environment, double step,
                           JobSystem& jobs, ClothState& state) override {
    fit(model, environment.pins);
    clock_ = environment.clock;
    contacts_.begin(environment.contacts, model, environment.pins, step, step * step * environment.gravity);
    if (state.history.step == 0) invent_history(model, environment.gravity, step, jobs, state);
    const StepScheme scheme = choose_scheme(model, environment, step, jobs, state);
    model_ = &model;
    prepare_matrices(model, environment.wind, scheme, jobs);
    air_.begin(model, environment, state);
    collapse_.begin(model, rows_);
    begin_step(model, environment.pins, scheme, jobs, state);
    air_.set_velocities(state.v, scheme.beta / scheme.step);
    coasts_ = false;
    if (model.elements) choose_start(scheme, jobs, state);
    const IntegratorReport report = minimise(choose_effort(settings_, step * step * reach_rate_), jobs);
    finish_step(environment.pins, scheme, jobs, state);
    if (environment.tells_contact_forces) tell_contact_forces(jobs);
    return report;
  }

 private:
  /// What the matrices depend on.
  struct Key {
    std::uint64_t model_id = 0;
    double step = 0, beta = 0, drag = 0;
    bool operator==(const Key&) const = default;
  };

  void fit(const ClothModel& model, const PinTargets& pins) {
    if (model.topology != topology_) {
      topology_ = model.topology;
      rows_ = padded_rows_of(*topology_);
      for (Vec3Array* field : {&trial_, &force_, &direction_, &correction_}) *field = Vec3Array(rows_.size());
      key_ = {};
    }
    if (model.id == key_.model_id && pins.particle == pinned_) return;
    pinned_ = pins.particle;
    free_pieces_.find(model, pinned_);
    reach_rate_ = compute_reach_rate(model);
    key_ = {};
  }

  /// The past of cloth that has been moving with its present velocity, and falling freely as far as pins do
  /// not hold it: x₋₁ = x − h v + ½ h² a, v₋₁ = v − h a. It halves the error of a plain first step.
  void invent_history(const ClothModel& model, const Vec3& gravity, double step, JobSystem& jobs,
                      ClothState& state) {
    MotionHistory& history = state.history;
    if (history.displacement.size() != state.x.size()) {
      history.displacement.resize(state.x.size());
      history.velocity.resize(state.x.size());
    }
    const Vec3 a = free_share(model, gravity, jobs, state) * gravity;
    for (std::size_t i = 0; i < state.x.size(); ++i) {
      const Vec3 v = state.v.get(i);
      history.displacement.set(i, step * v - 0.5 * step * step * a);
      history.velocity.set(i, v - step * a);
    }
    history.step = step;
    history.had_contact = false;
  }

  /// How much of its weight a cloth's springs leave uncarried, from 0 (it hangs at rest) to 1.
  double free_share(const ClothModel& model, const Vec3& gravity, JobSystem& jobs, const ClothState& state) {
    if (pinned_.empty()) return 1;
    potential_.fit(model, 0);
    for (int i = 0; i < model.num_particles(); ++i) potential_.target.set(rows_.index(i), state.x.get(i));
    clear(correction_);
    potential_.linearise(correction_, jobs, force_);
    set_at_pins(Vec3::Zero(), force_);
    return weft::free_share(model, pinned_, gravity, [&](int i) { return force_.get(rows_.index(i)); });
  }

  /// BDF2; implicit Euler while contact takes part in this step or did in the one before, for BDF2 remembers
  /// velocities from before an impact and would bounce a part of them back.
  StepScheme choose_scheme(const ClothModel& model, const Environment& environment, double step,
                           JobSystem& jobs, ClothState& state) {
    StepScheme euler{.step = step};
    add_outside(model, environment, euler);
    if (state.history.had_contact || meets_contact(euler, jobs, state)) return euler;
    StepScheme bdf2 = make_bdf2(step, state.history.step);
    add_outside(model, environment, bdf2);
    return bdf2;
  }

  static void add_outside(const ClothModel& model, const Environment& environment, StepScheme& scheme) {
    const double time = scheme.step / scheme.beta;
    const double wind = time * environment.wind.drag / model.material.density;
    scheme.keep = 1 / (1 + wind);
    scheme.gain = scheme.keep * (time * environment.gravity + wind * environment.wind.velocity);
  }

  /// Whether implicit Euler without springs would run into a contact.
  bool meets_contact(const StepScheme& euler, JobSystem& jobs, const ClothState& state) {
    if (contacts_.empty()) return false;
    scratch_ = state;
    predict(euler, rows_, jobs, scratch_, trial_);
    clear(direction_);
    return contacts_.any_active({rows_, trial_, direction_});
  }

  void prepare_matrices(const ClothModel& model, const Wind& wind, const StepScheme& scheme,
                        JobSystem& jobs) {
    const Key key{model.id, scheme.step, scheme.beta, wind.drag};
    const double rate = scheme.beta / scheme.step;
    potential_.fit(model, rate);
    if (key == key_) return;
    const bool same_springs = key.model_id == key_.model_id && key.step == key_.step && key.drag == key_.drag;
    key_ = key;
    set_weights(model, wind, 1 / scheme.step);
    least_weight_ = potential_.weight;
    has_stiffer_couplings_ = false;
    if (!same_springs) {
      preconditioner_.set_springs(model, rows_, scheme.step, potential_.weight, pinned_);
      has_stiff_springs_ = false;
    }
    set_weights(model, wind, rate);
    preconditioner_.set_diagonal(potential_.weight, jobs);
    is_in_contact_ = false;
  }

  /// D for β/h = `rate` [N/m].
  void set_weights(const ClothModel& model, const Wind& wind, double rate) {
    const double per_mass = rate * (rate + wind.drag / model.material.density);
    for (int i = 0; i < model.num_particles(); ++i)
      potential_.weight[rows_.index(i)] = static_cast<float>(per_mass * model.mass[i]);
  }

  /// The prediction y, which the solve corrects.
  void begin_step(const ClothModel& model, const PinTargets& pins, const StepScheme& scheme, JobSystem& jobs,
                  ClothState& state) {
    noise_ = energy_noise(model, state);
    potential_.remember(state.x, state.history.displacement, scheme.memory, jobs);
    pin_motion_.prepare(pins, scheme.step, state);
    predict(scheme, rows_, jobs, state, potential_.target);
    for (std::size_t p = 0; p < pinned_.size(); ++p) {
      potential_.target.set(rows_.index(pinned_[p]), pins.position[p] - state.origin);
      state.v.set(pinned_[p], pin_motion_.velocity()[p]);
      state.history.displacement.set(pinned_[p], scheme.step * pin_motion_.velocity()[p]);
    }
    if (potential_.is_damped()) copy_lag(scheme, state);
    clear(correction_);
  }

  /// Elements start from where velocities alone lead, x + h v, if their potential is lower there than at y.
  /// Green strain's energy is quartic: of what gravity stretches in a step beside a pin, one Newton step
  /// takes back two thirds alone, and cloth at rest would hang lower the longer the step is.
  void choose_start(const StepScheme& scheme, JobSystem& jobs, const ClothState& state) {
    clear(trial_);
    for (std::size_t i = 0; i < state.x.size(); ++i) {
      const Vec3 coasting = scheme.step * state.history.velocity.get(i);
      trial_.set(rows_.index(static_cast<int>(i)), coasting - state.history.displacement.get(i));
    }
    set_at_pins(Vec3::Zero(), trial_);
    coasts_ = energy_at(trial_, jobs) < energy_at(correction_, jobs);
    if (coasts_) std::swap(correction_, trial_);
  }

  double contact_energy(const Vec3Array& offset) const {
    const WorkScope scope(contact_clock(), &WorkTimes::rows);
    return contacts_.energy(positions(offset));
  }

  double energy_at(const Vec3Array& offset, JobSystem& jobs) {
    const double energy = potential_.energy(offset, jobs);
    return energy + contact_energy(offset) + air_.energy(rows_, offset) +
           collapse_.energy(potential_.positions());
  }

  /// What rounding makes of the energy of springs at rest: their ends are known to half a unit in the last
  /// place of the cloth's size.
  double energy_noise(const ClothModel& model, const ClothState& state) const {
    constexpr double kHalfUnit = 6e-8;
    const double size = kHalfUnit * (state.x.get(0).norm() + 1);
    double stiffness = 0;
    for (const double k : model.stiffness_sum) stiffness += k;
    return stiffness * size * size;
  }

  /// The velocities that go with y, as the potential wants them.
  void copy_lag(const StepScheme& scheme, const ClothState& state) {
    const double time = scheme.step / scheme.beta;
    for (std::size_t i = 0; i < state.v.size(); ++i)
      potential_.lag.set(rows_.index(static_cast<int>(i)), time * state.v.get(i));
  }

  /// Newton steps from the start.
  IntegratorReport minimise(const Effort& effort, JobSystem& jobs) {
    IntegratorReport report{.linear_iterations = 0, .guard_events = 0};
    int more = 1;  // times as many iterations, where the guard asks for another Newton step
    for (int asked = effort.newton_steps; report.iterations < asked; ++report.iterations) {
      const double before = linearise(report.iterations == 0, jobs);
      if (is_in_contact_) asked = std::max(asked, kNewtonStepsInContact);
      const CgReport linear = solve(effort, more, jobs);
      *report.linear_iterations += linear.iterations;
      double share = 1, after = try_step(share, jobs);
      for (int h = 0; !(after <= before + noise_) && h < kMaxHalvings; ++h) {
        ++*report.guard_events;
        share /= 2;
        after = try_step(share, jobs);
      }
      if (!std::isfinite(after)) break;
      std::swap(correction_, trial_);
      const double predicted = share * (2 - share) * linear.decrease;
      const bool missed = std::abs(after - (before - predicted)) > kMissedShare * after + noise_;
      // The first step's decrease tells nothing: most of it is what the prediction had ignored.
      const bool is_falling = effort.newton_steps > 1 && report.iterations > 0 && !is_in_contact_ &&
                              before - after > kFallingShare * after + noise_;
      const bool is_beyond = potential_.is_beyond_limit() && before - after > kLimitFalling * after + noise_;
      const int most = is_beyond ? kMostStepsBeyondLimit : effort.most_newton_steps;
      if ((missed || is_falling || is_beyond) && asked < most && report.iterations + 1 == asked) {
        ++asked;
        ++*report.guard_events;
        if (missed) more *= 2;
      }
    }
    return report;
  }

  /// The potential with its force and Hessian, and the preconditioner that goes with it.
  double linearise(bool is_first, JobSystem& jobs) {
    double energy = potential_.linearise(correction_, jobs, force_);
    energy += linearise_contacts();
    energy += air_.linearise(rows_, correction_, force_);
    energy += collapse_.linearise(potential_.positions(), jobs, force_);
    update_stiffer_couplings(is_first, jobs);
    update_for_contacts(jobs);
    set_at_pins(Vec3::Zero(), force_);
    return energy;
  }

  double linearise_contacts() {
    const WorkScope scope(contact_clock(), &WorkTimes::rows);
    return contacts_.linearise(positions(correction_), force_);
  }

  /// Where strain limit or stretch curves make cloth stiffer, so they make the preconditioner. At the first
  /// linearisation of a step always: what it was made for in the step before must not show in the result.
  void update_stiffer_couplings(bool is_first, JobSystem& jobs) {
    if (!potential_.stiffens()) return;
    const bool any = potential_.compute_stiffening(stiffer_couplings_);
    if (!any && !has_stiffer_couplings_) return;
    if (has_stiffer_couplings_ && any && !is_first && !has_changed_much()) return;
    built_stiffer_ = stiffer_couplings_;
    preconditioner_.set_springs(*model_, rows_, key_.step, least_weight_, pinned_, stiffer_couplings_);
    preconditioner_.set_diagonal(potential_.weight, jobs);
    has_stiffer_couplings_ = any;
    has_stiff_springs_ = false;
  }

  /// Whether some coupling is several times as stiff as the preconditioner's, or the other way round.
  bool has_changed_much() const {
    for (std::size_t k = 0; k < stiffer_couplings_.size(); ++k) {
      const double own = model_->elements->couplings.empty() ? model_->stiffness(static_cast<int>(k))
                                                             : model_->elements->couplings[k].stiffness;
      const double is = own + stiffer_couplings_[k], was = own + built_stiffer_[k];
      if (is > kMuchStiffer * was || was > kMuchStiffer * is) return true;
    }
    return false;
  }

  /// What the preconditioners know of contacts.
  void update_for_contacts(JobSystem& jobs) {
    const bool was_in_contact = is_in_contact_;
    is_in_contact_ = false;
    free_pieces_.release();
    filter_.clear();
    contacts_.for_active([&](const Contact& contact) {
      is_in_contact_ = true;
      if (contact.is_within_cloth()) return;
      for (int k = 0; k < contact.num_particles; ++k) free_pieces_.hold(contact.particle[k]);
    });
    if (!is_in_contact_ && !was_in_contact) return;
    const WorkScope scope(clock_, &WorkTimes::set_up);
    diagonal_ = stiff_diagonal_ = potential_.weight;
    contacts_.add_to_preconditioners(rows_, stiff_diagonal_, diagonal_, filter_);
    preconditioner_.set_diagonal(diagonal_, jobs);
    if (!is_in_contact_) return;
    if (!has_stiff_springs_)
      stiff_preconditioner_.set_springs(*model_, rows_, key_.step, least_weight_, pinned_,
                                        has_stiffer_couplings_ ? built_stiffer_ : std::vector<double>());
    has_stiff_springs_ = true;
    stiff_preconditioner_.set_diagonal(stiff_diagonal_, jobs);
  }

  double add_contact_product(const Vec3Array& p, Vec3Array& q) const {
    const WorkScope scope(contact_clock(), &WorkTimes::product);
    return contacts_.add_product(p, q);
  }

  CgReport solve(const Effort& effort, int more, JobSystem& jobs) {
    CgSettings settings = is_in_contact_ ? effort.in_contact : effort.free;
    if (coasts_ && settings_.iterations == 0) {
      settings.iterations *= kTimesCoasting;
      settings.least *= kTimesCoasting;
      settings.enough /= kTimesCoasting;
    }
    settings.iterations *= more;
    settings.enough = std::max(settings.enough / more, kNoise);
    const auto multiply = [&](const Vec3Array& p, Vec3Array& q) {
      double dot = potential_.multiply(p, jobs, q);
      dot += add_contact_product(p, q);
      dot += air_.add_product(rows_, p, q);
      dot += collapse_.add_product(p, q);
      set_at_pins(Vec3::Zero(), q);
      return dot;
    };
    const auto free = [&](const Vec3Array& r, JobSystem& its_jobs, Vec3Array& z) {
      return preconditioner_.apply(r, its_jobs, z);
    };
    const auto stiff = [&](const Vec3Array& r, JobSystem& its_jobs, Vec3Array& z) {
      return stiff_preconditioner_.apply(r, its_jobs, z);
    };
    const auto precondition = [&](const Vec3Array& r, Vec3Array& z) {
      const WorkScope scope(clock_, &WorkTimes::v_cycle);
      return filter_.apply(stiff, free, r, jobs, z);
    };
    return gradients_.solve(multiply, precondition, force_, settings, jobs, direction_);
  }

  /// The potential after the given share of the step [J]. Springs do not move the middle of a free piece of
  /// cloth: what an unfinished solve has moved it by is taken back.
  double try_step(double share, JobSystem& jobs) {
    add_scaled(correction_, share, direction_, jobs, trial_);
    if (!air_.is_active()) free_pieces_.remove_mean(rows_, potential_.weight, trial_);
    return energy_at(trial_, jobs);
  }

  WorkClock* contact_clock() const { return contacts_.empty() ? nullptr : clock_; }

  OffsetPositions positions(const Vec3Array& offset) const { return {rows_, potential_.target, offset}; }

  void finish_step(const PinTargets& pins, const StepScheme& scheme, JobSystem& jobs, ClothState& state) {
    correct(scheme, rows_, correction_, jobs, state);
    pin_motion_.finish(pins, state);
    state.history.step = scheme.step;
    state.history.had_contact = contacts_.any_active(positions(correction_));
  }

  void tell_contact_forces(JobSystem& jobs) {
    potential_.linearise(correction_, jobs, force_);
    collapse_.linearise(potential_.positions(), jobs, force_);
    set_at_pins(Vec3::Zero(), force_);
    contacts_.compute_forces(positions(correction_), force_, contact_forces_);
  }

  static void clear(Vec3Array& field) {
    for (float* component : {field.x(), field.y(), field.z()}) std::fill_n(component, field.size(), 0.0f);
  }

  void set_at_pins(const Vec3& value, Vec3Array& field) const {
    for (const int p : pinned_) field.set(rows_.index(p), value);
  }

  NewtonSettings settings_;
  WorkClock* clock_ = nullptr;  // of the step
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
  ConjugateGradients gradients_;
  ContactTerms contacts_;
  std::vector<Vec3> contact_forces_;
  AirTerms air_;
  CollapseTerms collapse_;
  bool coasts_ = false;  // the step started from x + h v
  bool is_in_contact_ = false;
  std::vector<float> diagonal_, stiff_diagonal_;  // of the preconditioners [N/m]
  const ClothModel* model_ = nullptr;             // of the step being taken
  std::vector<float> least_weight_;               // D for the longest memory [N/m]
  std::vector<double> stiffer_couplings_,
      built_stiffer_;                   // as they should be, as the preconditioner has them
  bool has_stiffer_couplings_ = false;  // in the preconditioner
  PinMotion pin_motion_;
  double noise_ = 0;  // of energies, from the rounding of positions [J]
  Vec3Array force_, direction_, trial_;
  Vec3Array correction_;  // x − y [m]
  ClothState scratch_;    // where the cloth would go without springs
};

}  // namespace

std::unique_ptr<Integrator> make_newton(const NewtonSettings& settings) {
  return std::make_unique<NewtonIntegrator>(settings);
}

}  // namespace weft
