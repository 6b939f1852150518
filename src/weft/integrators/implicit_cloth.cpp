#include "weft/integrators/implicit_cloth.h"

#include <algorithm>

#include "weft/forces/environment_terms.h"
#include "weft/integrators/common.h"
#include "weft/integrators/newton_kernels.h"

namespace weft::engine {

void ImplicitCloth::begin(const Body& body, double step, Order order, Keeps keeps) {
  order_ = order;
  keeps_ = keeps;
  model_ = body.model;
  environment_ = body.environment;
  state_ = body.state;
  whole_step_ = step;
  terms_.clear();
  is_pinned_.assign(model_->num_particles(), 0);
  for (const int p : pinned()) is_pinned_[p] = 1;
  advance_memory(*model_, step, *state_);
  load();
  start_from(before_.x, before_.v, step);
  if (order_ == Order::second && state_->history.step == 0) synthesize_history();
}

/// The state at the start of the step, in the stored precision.
void ImplicitCloth::load() {
  static const std::vector<Vec3> kNone;
  const auto copy = [&](const Vec3Array& values, const std::vector<Vec3>& precise, std::vector<Vec3>& to) {
    to.resize(values.size());
    for (std::size_t i = 0; i < to.size(); ++i)
      to[i] = most_precise(keeps_ == Keeps::doubles ? precise : kNone, values, i);
  };
  copy(state_->x, state_->precise.x, before_.x);
  copy(state_->v, state_->precise.v, before_.v);
  if (order_ == Order::first || state_->history.step == 0) return;
  copy(state_->history.displacement, state_->precise.displacement, before_.displacement);
  copy(state_->history.velocity, state_->precise.velocity, before_.velocity);
}

/// Starts a step of implicit Euler from x and v [s].
void ImplicitCloth::start_from(const std::vector<Vec3>& x, const std::vector<Vec3>& v, double time) {
  step_ = time;
  start_ = x;
  inertial_.resize(x.size());
  for (std::size_t i = 0; i < x.size(); ++i)
    inertial_[i] = x[i] + time * v[i] + time * time * (environment_->gravity + environment_->external(i));
}

/// Initial history, as in `newton`: of cloth in free fall as far as nothing carries it.
void ImplicitCloth::synthesize_history() {
  const double step = whole_step_;
  const Vec3 a =
      free_share(*model_, *state_, before_.x, pinned(), environment_->gravity) * environment_->gravity;
  before_.displacement.resize(before_.x.size());
  before_.velocity.resize(before_.x.size());
  for (std::size_t i = 0; i < before_.x.size(); ++i) {
    const Vec3 all = a + environment_->external(i);
    before_.displacement[i] = step * before_.v[i] - 0.5 * step * step * all;
    before_.velocity[i] = before_.v[i] - step * all;
  }
}

void ImplicitCloth::begin_second_order() {
  const double step_before = state_->history.step > 0 ? state_->history.step : whole_step_;
  const StepScheme bdf2 = make_bdf2(whole_step_, step_before);
  std::vector<Vec3> x = before_.x, v = before_.v;
  for (std::size_t i = 0; i < x.size(); ++i) {
    x[i] += bdf2.memory * before_.displacement[i];
    v[i] += bdf2.memory * (before_.v[i] - before_.velocity[i]);
  }
  start_from(x, v, whole_step_ / bdf2.beta);
}

void ImplicitCloth::place_pins() {
  placed_ = inertial_;
  const PinTargets& pins = environment_->pins;
  for (std::size_t p = 0; p < pins.particle.size(); ++p) {
    const int i = pins.particle[p];
    placed_[i] = pins.position[p] - state_->origin;
    if (step_ < whole_step_)  // velocity: over the whole step
      start_[i] = placed_[i] - step_ / whole_step_ * (placed_[i] - before_.x[i]);
  }
  make_terms();
}

void ImplicitCloth::make_terms() {
  const Motion motion{start_, step_ < whole_step_ ? placed_ : start_, step_};
  terms_.clear();
  terms_.push_back(make_inertia_term(*model_, pinned(), inertial_, step_));
  const auto append = [&](Terms more) {
    for (auto& term : more) terms_.push_back(std::move(term));
  };
  append(make_air_terms(*model_, *state_, environment_->wind, environment_->time, motion));
  append(make_elastic_terms(*model_, *state_));
  append(make_damping_terms(*model_, motion));
}

/// Triangle edges are springs of the topology: terms that only some models have, such as collapse, add no other pairs.
std::vector<std::pair<int, int>> ImplicitCloth::find_pairs() const {
  std::vector<std::pair<int, int>> pairs;
  for (const auto& term : make_elastic_terms(*model_, *state_))
    term->list_pairs([&](int i, int j) { pairs.push_back(std::minmax(i, j)); });
  std::sort(pairs.begin(), pairs.end());
  pairs.erase(std::unique(pairs.begin(), pairs.end()), pairs.end());
  return pairs;
}

void ImplicitCloth::finish(const std::vector<Vec3>& x, bool is_pushed) {
  const std::size_t n = x.size();
  std::vector<Vec3>& v = velocity_;
  v.resize(n);
  for (std::size_t i = 0; i < n; ++i) v[i] = (x[i] - start_[i]) / step_;
  for (const int p : pinned()) v[p] = (x[p] - before_.x[p]) / whole_step_;
  const auto store = [&](const std::vector<Vec3>& from, Vec3Array& to, std::vector<Vec3>& precise) {
    to.resize(n);
    for (std::size_t i = 0; i < n; ++i) to.set(i, from[i]);
    if (keeps_ == Keeps::doubles) precise = from;
  };
  store(x, state_->x, state_->precise.x);
  store(v, state_->v, state_->precise.v);
  if (order_ == Order::first) return;
  before_.displacement.resize(n);
  for (std::size_t i = 0; i < n; ++i) before_.displacement[i] = x[i] - before_.x[i];
  store(before_.displacement, state_->history.displacement, state_->precise.displacement);
  store(before_.v, state_->history.velocity, state_->precise.velocity);
  state_->history.step = whole_step_;
  state_->history.had_contact = is_pushed;
}

}  // namespace weft::engine
