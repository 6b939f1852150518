#include "weft/integrators/newton_cloth.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "weft/integrators/solver_budget.h"

namespace weft::engine {
namespace {

constexpr double kMuchStiffer = 8;  // a preconditioner within this factor is good enough

}  // namespace

void NewtonCloth::begin(const Body& body, const SystemStep& step) {
  model_ = body.model;
  environment_ = body.environment;
  state_ = body.state;
  step_ = step.step;
  clock_ = step.clock;
  fit(*model_, environment_->pins);
  if (state_->history.step == 0) synthesize_history();
  advance_memory(*model_, step_, *state_);
}

void NewtonCloth::fit(const ClothModel& model, const PinTargets& pins) {
  if (model.topology != topology_) {
    topology_ = model.topology;
    rows_ = padded_rows_of(*topology_);
    for (Vec3Array* field : {&trial_, &force_, &solution_, &correction_}) *field = Vec3Array(rows_.size());
    key_ = {};
  }
  block_.b = &force_;
  block_.x = &solution_;
  if (model.id == key_.model_id && pins.particle == pinned_) return;
  pinned_ = pins.particle;
  floating_components_.find(model, pinned_);
  stiffness_rate_ = compute_stiffness_rate(model);
  key_ = {};
}

/// Initial history: cloth that has been moving with its present velocity, and in free fall as far as pins do
/// not hold it: x₋₁ = x − h v + ½ h² a, v₋₁ = v − h a. It halves the error of a plain first step.
void NewtonCloth::synthesize_history() {
  MotionHistory& history = state_->history;
  if (history.displacement.size() != state_->x.size()) {
    history.displacement.resize(state_->x.size());
    history.velocity.resize(state_->x.size());
  }
  const Vec3 a = free_share(*model_, *state_, to_doubles(state_->x), pinned_, gravity()) * gravity();
  for (std::size_t i = 0; i < state_->x.size(); ++i) {
    const Vec3 v = state_->v.get(i);
    const Vec3 all = a + environment_->external(i);
    history.displacement.set(i, step_ * v - 0.5 * step_ * step_ * all);
    history.velocity.set(i, v - step_ * all);
  }
  history.step = step_;
  history.had_contact = false;
}

ContactTerms::Positions NewtonCloth::place_freely(JobSystem& jobs) {
  StepScheme euler{.step = step_};
  add_outside(euler);
  scratch_ = *state_;
  weft::engine::predict(euler, rows_, jobs, scratch_, trial_);
  add_external(euler, scratch_, trial_);
  clear(solution_);
  return {&trial_, &solution_};
}

void NewtonCloth::add_outside(StepScheme& scheme) const {
  const double time = scheme.step / scheme.beta;
  const double wind = time * environment_->wind.drag / model_->material.density;
  scheme.drag_factor = 1 / (1 + wind);
  scheme.velocity_gain = scheme.drag_factor * (time * gravity() + wind * environment_->wind.velocity);
}

/// External forces besides gravity: they enter a prediction like gravity.
void NewtonCloth::add_external(const StepScheme& scheme, ClothState& state, Vec3Array& y) const {
  const std::vector<Vec3>& acceleration = environment_->acceleration;
  const double time = scheme.step / scheme.beta;
  for (std::size_t i = 0; i < acceleration.size(); ++i) {
    const Vec3 gain = scheme.drag_factor * time * acceleration[i];
    const int row = rows_.index(static_cast<int>(i));
    state.v.set(i, state.v.get(i) + gain);
    state.history.displacement.set(i, state.history.displacement.get(i) + time * gain);
    y.set(row, y.get(row) + time * gain);
  }
}

void NewtonCloth::predict(bool is_euler, JobSystem& jobs) {
  scheme_ = is_euler ? StepScheme{.step = step_} : make_bdf2(step_, state_->history.step);
  add_outside(scheme_);
  prepare_matrices(jobs);
  for (NewtonTerm* term : terms_) term->begin({*model_, *environment_, *state_, rows_});
  noise_ = energy_noise();
  potential_.remember(state_->x, state_->history.displacement, scheme_.memory, jobs);
  const PinTargets& pins = environment_->pins;
  pin_motion_.prepare(pins, step_, *state_);
  weft::engine::predict(scheme_, rows_, jobs, *state_, potential_.target);
  add_external(scheme_, *state_, potential_.target);
  for (std::size_t p = 0; p < pinned_.size(); ++p) {
    potential_.target.set(rows_.index(pinned_[p]), pins.position[p] - state_->origin);
    state_->v.set(pinned_[p], pin_motion_.velocity()[p]);
    state_->history.displacement.set(pinned_[p], step_ * pin_motion_.velocity()[p]);
  }
  if (potential_.is_damped()) copy_velocity_offset();
  clear(correction_);
  air_.set_velocities(state_->v, scheme_.beta / step_);
}

void NewtonCloth::prepare_matrices(JobSystem& jobs) {
  const Key key{model_->id, step_, scheme_.beta, environment_->wind.drag};
  const double rate = scheme_.beta / step_;
  potential_.fit(*model_, rate);
  if (key == key_) return;
  const bool same_springs = key.model_id == key_.model_id && key.step == key_.step && key.drag == key_.drag;
  key_ = key;
  set_weights(1 / step_);
  least_weight_ = potential_.weight;
  has_stiffer_couplings_ = false;
  if (!same_springs) {
    preconditioner_.set_springs(*model_, rows_, step_, potential_.weight, pinned_);
    has_stiff_springs_ = false;
  }
  set_weights(rate);
  preconditioner_.set_diagonal(potential_.weight, jobs);
  is_in_contact_ = false;
}

/// D for β/h = `rate` [N/m].
void NewtonCloth::set_weights(double rate) {
  const double per_mass = rate * (rate + environment_->wind.drag / model_->material.density);
  for (int i = 0; i < model_->num_particles(); ++i)
    potential_.weight[rows_.index(i)] = static_cast<float>(per_mass * model_->mass[i]);
}

void NewtonCloth::store_velocity_gain() {
  Vec3 sum = Vec3::Zero();
  double mass = 0;
  for (std::size_t i = 0; i < state_->x.size(); ++i) {
    sum += model_->mass[i] * (state_->v.get(i) - state_->history.velocity.get(i));
    mass += model_->mass[i];
  }
  const Vec3 gain = sum / mass;
  const double size = gain.norm(), most = step_ * gravity().norm();
  mean_velocity_gain_ = size > most ? Vec3(most / size * gain) : gain;
}

void NewtonCloth::start_inertial(bool accelerates) {
  clear(trial_);
  const Vec3 gain = accelerates ? mean_velocity_gain_ : Vec3::Zero();
  for (std::size_t i = 0; i < state_->x.size(); ++i) {
    const Vec3 inertial = step_ * (state_->history.velocity.get(i) + gain);
    trial_.set(rows_.index(static_cast<int>(i)), inertial - state_->history.displacement.get(i));
  }
  hold_pins(trial_);
}

double NewtonCloth::energy_at(const Vec3Array& e, JobSystem& jobs) {
  double energy = potential_.energy(e, jobs);
  for (NewtonTerm* term : terms_) energy += term->energy({potential_.positions(), e}, jobs);
  return energy;
}

/// Rounding error of the energy of springs at rest: their ends are accurate to half a unit in the last place
/// of the cloth's size.
double NewtonCloth::energy_noise() const {
  constexpr double kHalfUnit = 6e-8;
  const double size = kHalfUnit * (state_->x.get(0).norm() + 1);
  double stiffness = 0;
  for (const double k : model_->stiffness_sum) stiffness += k;
  return stiffness * size * size;
}

/// Velocity offset: the velocities at y, in the potential's layout.
void NewtonCloth::copy_velocity_offset() {
  const double time = step_ / scheme_.beta;
  for (std::size_t i = 0; i < state_->v.size(); ++i)
    potential_.velocity_offset.set(rows_.index(static_cast<int>(i)), time * state_->v.get(i));
}

double NewtonCloth::linearise(JobSystem& jobs) {
  double energy = potential_.linearise(correction_, jobs, force_);
  for (NewtonTerm* term : terms_)
    energy += term->linearise({potential_.positions(), correction_}, jobs, force_);
  return energy;
}

/// Stiffens the preconditioner where strain limits or stretch curves stiffen the cloth. Always at the first
/// linearisation of a step: the result must not depend on the preconditioner of the last step.
void NewtonCloth::update_stiffer_couplings(bool is_first, JobSystem& jobs) {
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

/// Whether some coupling and that of the preconditioner differ by a factor of more than kMuchStiffer.
bool NewtonCloth::has_changed_much() const {
  for (std::size_t k = 0; k < stiffer_couplings_.size(); ++k) {
    const double own = model_->elements->couplings.empty() ? model_->stiffness(static_cast<int>(k))
                                                           : model_->elements->couplings[k].stiffness;
    const double is = own + stiffer_couplings_[k], was = own + built_stiffer_[k];
    if (is > kMuchStiffer * was || was > kMuchStiffer * is) return true;
  }
  return false;
}

void NewtonCloth::begin_preconditioner(bool is_first, bool is_active, JobSystem& jobs) {
  update_stiffer_couplings(is_first, jobs);
  contact_preconditioner_.clear();
  if (is_active || is_in_contact_) diagonal_ = stiff_diagonal_ = potential_.weight;
}

void NewtonCloth::finish_preconditioner(JobSystem& jobs) {
  update_diagonals(jobs);
  if (!pressure_.has_hessian()) return;
  hold_pins(pressure_.gradient());
  pressure_.begin_preconditioner(
      [&](const Vec3Array& r, Vec3Array& z) { precondition_without_gas(r, jobs, z); });
}

void NewtonCloth::update_diagonals(JobSystem& jobs) {
  const bool was_in_contact = is_in_contact_;
  is_in_contact_ = !contact_preconditioner_.empty();
  if (!is_in_contact_ && !was_in_contact) return;
  const WorkScope scope(clock_, &WorkTimes::set_up);
  preconditioner_.set_diagonal(diagonal_, jobs);
  if (!is_in_contact_) return;
  if (!has_stiff_springs_)
    stiff_preconditioner_.set_springs(*model_, rows_, key_.step, least_weight_, pinned_,
                                      has_stiffer_couplings_ ? built_stiffer_ : std::vector<double>());
  has_stiff_springs_ = true;
  stiff_preconditioner_.set_diagonal(stiff_diagonal_, jobs);
}

double NewtonCloth::multiply(JobSystem& jobs) {
  const Vec3Array& p = block_.direction;
  Vec3Array& q = block_.product;
  double dot = potential_.multiply(p, jobs, q);
  for (NewtonTerm* term : terms_) dot += term->add_product(p, jobs, q);
  return dot;
}

double NewtonCloth::precondition(JobSystem& jobs) {
  const double dot = precondition_without_gas(block_.residual, jobs, block_.preconditioned);
  return pressure_.precondition(dot, block_.preconditioned);
}

double NewtonCloth::precondition_without_gas(const Vec3Array& r, JobSystem& jobs, Vec3Array& z) {
  const auto free = [&](const Vec3Array& of, JobSystem& its_jobs, Vec3Array& result) {
    return preconditioner_.apply(of, its_jobs, result);
  };
  const auto stiff = [&](const Vec3Array& of, JobSystem& its_jobs, Vec3Array& result) {
    return stiff_preconditioner_.apply(of, its_jobs, result);
  };
  return contact_preconditioner_.apply(stiff, free, r, jobs, z);
}

void NewtonCloth::try_step(double share, JobSystem& jobs) {
  add_scaled(correction_, share, solution_, jobs, trial_);
}

void NewtonCloth::finish(bool is_pushed, JobSystem& jobs) {
  correct(scheme_, rows_, correction_, jobs, *state_);
  pin_motion_.finish(environment_->pins, *state_);
  state_->history.step = step_;
  state_->history.had_contact = is_pushed;
}

const Vec3Array& NewtonCloth::find_forces(JobSystem& jobs) {
  linearise(jobs);
  hold_pins(force_);
  return force_;
}

void NewtonCloth::clear(Vec3Array& field) {
  for (float* component : {field.x(), field.y(), field.z()}) std::fill_n(component, field.size(), 0.0f);
}

}  // namespace weft::engine
