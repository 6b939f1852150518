/// Implicit Euler with the true forces: the yardstick. Each step minimises the incremental potential
///
///     E(x) = 1/(2h²) |x − y|²_M + Σ ½ k (l − l0)² + membranes and bending (element_terms.h)
///            + Σ A [ψ(σ1) + ψ(σ2)], the triangles' resistance to collapse (forces/collapse.h)
///            + h · (damping, wind and air dissipation at velocity (x − x₀)/h)
///            + Σ ½ k_c max(0, offset − n·Σ w x)² + µ N |slide| over the contacts,    y = x₀ + h v₀ + h² g,
///
/// by Newton's method with line search and sparse Cholesky, in double precision. `newton` in double precision
/// is the same from another start: BDF2 is implicit Euler over T = h/β from x₀ + m s with the velocity
/// v + m (v − v₋₁), s being the displacement of the step before (newton_kernels.h: β, m). Where the true
/// Hessian is not positive definite (compressed springs) that of spring_jacobian_clamped takes its place:
/// with a line search it needs a third of the iterations that absolute values need (10 against 37 on a
/// buckling 64 x 64 sheet).

#include <algorithm>
#include <cmath>
#include <utility>

#include "weft/forces/collapse.h"
#include "weft/forces/damping.h"
#include "weft/forces/spring.h"
#include "weft/integrators/air_terms.h"
#include "weft/integrators/common.h"
#include "weft/integrators/contact_terms.h"
#include "weft/integrators/element_terms.h"
#include "weft/integrators/newton_kernels.h"
#include "weft/solvers/block_cholesky.h"

namespace weft {
namespace {

constexpr double kArmijo = 1e-4;              // share of the predicted decrease that a step must bring
constexpr double kSmallestShare = 1e-8;       // of a Newton step that the line search tries
constexpr double kFinest = 1e-6;              // of the tolerance: no more is asked for strain limits
constexpr double kStickSpeed = 1e-3;          // slower slides count as sticking [m/s]
constexpr double kReferenceTolerance = 1e-9;  // of `newton` in doubles [m/s]

TriangleCorners corners_of(const MembraneElement& triangle, const std::vector<Vec3>& x) {
  const auto& [a, b, c] = triangle.vertices;
  return {x[a], x[b], x[c]};
}

enum class Order { first, second };
enum class Keeps { floats, doubles };

class ImplicitEulerIntegrator final : public Integrator {
 public:
  ImplicitEulerIntegrator(const ImplicitEulerSettings& settings, Order order, Keeps keeps)
      : settings_(settings), order_(order), keeps_(keeps) {}

  bool resolves_contacts() const override { return true; }
  std::span<const Vec3> contact_forces() const override { return contact_forces_; }
  std::span<const char> pushing_contacts() const override { return have_pushed_; }

  IntegratorReport advance(const ClothModel& model, const Environment& environment, double step, JobSystem&,
                           ClothState& state) override {
    begin_step(model, environment, step, state);
    const IntegratorReport report = minimise();
    if (environment.tells_contact_forces) tell_contact_forces();
    finish_step(step, state);
    return report;
  }

 private:
  void tell_contact_forces() {
    contact_forces_.clear();
    std::vector<const Contact*> contacts;
    for (const Contact& c : environment_->contacts) {
      contact_forces_.push_back(contact_force(contacts.size()));
      contacts.push_back(&c);
    }
    compute_gradient();
    for (std::size_t i = 0; i < gradient_.size(); ++i) {
      if (is_pinned_[i]) gradient_[i].setZero();
      gradient_[i] = -gradient_[i];
    }
    give_rest_to_contacts(contacts, gradient_, contact_forces_);
  }

  void begin_step(const ClothModel& model, const Environment& environment, double step,
                  const ClothState& state) {
    model_ = &model;
    environment_ = &environment;
    fit_pattern();
    collapse_law_ = make_collapse_law(model);
    is_pinned_.assign(model.num_particles(), 0);
    for (const int p : environment.pins.particle) is_pinned_[p] = 1;
    load(state);
    start_from(before_.x, before_.v, step);
    if (order_ == Order::second) begin_second_order(step, state.history);
    air_.begin(model, environment, state);
    air_.set_still(1 / step_);
    x_ = inertial_;
    for (std::size_t p = 0; p < environment.pins.particle.size(); ++p) {
      const int i = environment.pins.particle[p];
      x_[i] = environment.pins.position[p] - state.origin;
      if (step_ < step) start_[i] = x_[i] - step_ / step * (x_[i] - before_.x[i]);  // velocity: its whole way
    }
    damped_shape_ = step_ < step ? x_ : start_;
    if (model.elements) elements_.begin_step(*model.elements, step_, start_, damped_shape_);
  }

  /// The state at the start of the step, as precisely as it is kept.
  void load(const ClothState& state) {
    static const std::vector<Vec3> kNone;
    const auto copy = [&](const Vec3Array& values, const std::vector<Vec3>& precise, std::vector<Vec3>& to) {
      to.resize(values.size());
      for (std::size_t i = 0; i < to.size(); ++i)
        to[i] = most_precise(keeps_ == Keeps::doubles ? precise : kNone, values, i);
    };
    copy(state.x, state.precise.x, before_.x);
    copy(state.v, state.precise.v, before_.v);
    if (order_ == Order::first || state.history.step == 0) return;
    copy(state.history.displacement, state.precise.displacement, before_.displacement);
    copy(state.history.velocity, state.precise.velocity, before_.velocity);
  }

  /// A step of implicit Euler from there [s].
  void start_from(const std::vector<Vec3>& x, const std::vector<Vec3>& v, double time) {
    step_ = time;
    start_ = x;
    inertial_.resize(x.size());
    for (std::size_t i = 0; i < x.size(); ++i)
      inertial_[i] = x[i] + time * v[i] + time * time * environment_->gravity;
  }

  /// BDF2, unless contact takes part in this step or did in the one before (see `newton`).
  void begin_second_order(double step, const MotionHistory& history) {
    if (history.step == 0) invent_history(step);
    if (history.step > 0 && history.had_contact) return;
    if (touches(inertial_)) return;
    const StepScheme bdf2 = make_bdf2(step, history.step > 0 ? history.step : step);
    std::vector<Vec3> x = before_.x, v = before_.v;
    for (std::size_t i = 0; i < x.size(); ++i) {
      x[i] += bdf2.memory * before_.displacement[i];
      v[i] += bdf2.memory * (before_.v[i] - before_.velocity[i]);
    }
    start_from(x, v, step / bdf2.beta);
  }

  /// As `newton` has it: of cloth that falls freely as far as nothing carries it.
  void invent_history(double step) {
    gradient_.assign(before_.x.size(), Vec3::Zero());
    add_spring_gradient(before_.x);
    if (model_->elements) {
      elements_.begin_step(*model_->elements, step, before_.x, before_.x);
      elements_.add_gradient(before_.x, gradient_);
    }
    const Vec3& gravity = environment_->gravity;
    const auto elastic = [&](int i) -> Vec3 {
      return is_pinned_[i] ? Vec3(Vec3::Zero()) : Vec3(-gradient_[i]);
    };
    const Vec3 a = free_share(*model_, environment_->pins.particle, gravity, elastic) * gravity;
    before_.displacement.resize(before_.x.size());
    before_.velocity.resize(before_.x.size());
    for (std::size_t i = 0; i < before_.x.size(); ++i) {
      before_.displacement[i] = step * before_.v[i] - 0.5 * step * step * a;
      before_.velocity[i] = before_.v[i] - step * a;
    }
  }

  bool touches(const std::vector<Vec3>& x) const {
    const auto& contacts = environment_->contacts;
    return std::any_of(contacts.begin(), contacts.end(), [&](const Contact& c) { return c.depth(x) > 0; });
  }

  void finish_step(double step, ClothState& state) {
    const std::size_t n = x_.size();
    std::vector<Vec3>& v = trial_;  // at the end
    v.resize(n);
    for (std::size_t i = 0; i < n; ++i) v[i] = (x_[i] - start_[i]) / step_;
    for (const int p : environment_->pins.particle) v[p] = (x_[p] - before_.x[p]) / step;
    const auto store = [&](const std::vector<Vec3>& from, Vec3Array& to, std::vector<Vec3>& precise) {
      to.resize(n);
      for (std::size_t i = 0; i < n; ++i) to.set(i, from[i]);
      if (keeps_ == Keeps::doubles) precise = from;
    };
    store(x_, state.x, state.precise.x);
    store(v, state.v, state.precise.v);
    if (order_ == Order::first) return;
    before_.displacement.resize(n);
    for (std::size_t i = 0; i < n; ++i) before_.displacement[i] = x_[i] - before_.x[i];
    store(before_.displacement, state.history.displacement, state.precise.displacement);
    store(before_.v, state.history.velocity, state.precise.velocity);
    state.history.step = step;
    state.history.had_contact = touches(x_);
  }

  using Pair = std::pair<int, int>;

  /// Makes the matrix hold a block for every spring and for every two particles of a contact, and for no
  /// others: the order of elimination, and with it rounding, must not depend on contacts of the past.
  void fit_pattern() {
    const std::vector<Spring>& springs = model_->topology->springs;
    if (analyzed_ != model_->topology || analyzed_elements_ != model_->elements) {
      analyzed_ = model_->topology;
      analyzed_elements_ = model_->elements;
      matrix_.diagonal.resize(model_->num_particles());
      matrix_.pairs.clear();
      for (const Spring& s : springs) matrix_.pairs.push_back({s.i, s.j});
      spring_pairs_.clear();
      for (const Spring& s : springs) spring_pairs_.push_back(std::minmax(s.i, s.j));
      std::sort(spring_pairs_.begin(), spring_pairs_.end());
      add_element_pairs();
      find_triangles();
      num_lasting_pairs_ = matrix_.pairs.size();
      contact_pairs_.clear();
      is_analyzed_ = false;
    }
    wanted_pairs_.clear();
    for (const Contact& c : environment_->contacts) {
      for (int k = 1; k < c.num_particles; ++k) {
        for (int l = 0; l < k; ++l) {
          const Pair pair = std::minmax(c.particle[k], c.particle[l]);
          if (!std::binary_search(spring_pairs_.begin(), spring_pairs_.end(), pair))
            wanted_pairs_.push_back(pair);
        }
      }
    }
    std::sort(wanted_pairs_.begin(), wanted_pairs_.end());
    wanted_pairs_.erase(std::unique(wanted_pairs_.begin(), wanted_pairs_.end()), wanted_pairs_.end());
    if (wanted_pairs_ != contact_pairs_) {
      contact_pairs_ = wanted_pairs_;
      is_analyzed_ = false;
    }
    if (is_analyzed_) return;
    matrix_.pairs.resize(num_lasting_pairs_);
    for (const auto& [i, j] : contact_pairs_) matrix_.pairs.push_back({i, j});
    matrix_.off_diagonal.resize(matrix_.pairs.size());
    pair_index_.clear();
    for (std::size_t p = 0; p < matrix_.pairs.size(); ++p) {
      pair_index_.push_back({std::minmax(matrix_.pairs[p][0], matrix_.pairs[p][1]), static_cast<int>(p)});
    }
    std::sort(pair_index_.begin(), pair_index_.end());
    cholesky_.analyze(model_->num_particles(), matrix_.pairs);
    is_analyzed_ = true;
  }

  /// Pairs that elements join and springs do not.
  void add_element_pairs() {
    if (!model_->elements) return;
    const auto num_springs = static_cast<std::ptrdiff_t>(spring_pairs_.size());
    for (const Pair& pair : ElementTerms::find_pairs(*model_->elements)) {
      if (std::binary_search(spring_pairs_.begin(), spring_pairs_.begin() + num_springs, pair)) continue;
      spring_pairs_.push_back(pair);
      matrix_.pairs.push_back({pair.first, pair.second});
    }
    std::sort(spring_pairs_.begin(), spring_pairs_.end());
  }

  /// Every edge of a triangle is a spring of the topology: the pattern has its block.
  void find_triangles() {
    const TriangleMesh& mesh = model_->topology->mesh;
    triangles_.clear();
    for (int t = 0; t < mesh.num_triangles(); ++t)
      triangles_.push_back({mesh.triangles[t], make_rest_triangle(mesh, t)});
  }

  /// Where the block of particles i and j is.
  int index_of_pair(int i, int j) const {
    const Pair pair = std::minmax(i, j);
    return std::lower_bound(pair_index_.begin(), pair_index_.end(), std::pair(pair, 0))->second;
  }

  /// Newton's method from x_. Afterwards x_ is the minimum, or the best that was found.
  IntegratorReport minimise() {
    bool use_true_hessian = false;
    for (int iteration = 1; iteration <= settings_.iterations; ++iteration) {
      update_normal_forces(iteration == 1);
      compute_gradient();
      if (!find_direction(use_true_hessian)) return {.converged = false, .iterations = iteration};
      const double share = search_line();
      const double moved = share * largest(direction_);
      const double tolerance = settings_.tolerance * step_;
      const bool is_held = !is_beyond_limit();
      if (share == 0 || moved < kFinest * tolerance || (moved < tolerance && is_held))
        return {.converged = moved < tolerance, .iterations = iteration};
      use_true_hessian = share == 1;
    }
    return {.converged = false, .iterations = settings_.iterations};
  }

  double compute_energy(const std::vector<Vec3>& x) const {
    const Wind& wind = environment_->wind;
    double energy = model_->elements ? elements_.energy(x) : 0.0;
    for (std::size_t i = 0; i < x.size(); ++i) {
      if (is_pinned_[i]) continue;
      if (air_.is_active()) energy += air_.energy(static_cast<int>(i), x[i] - start_[i]);
      const Vec3 slip = (x[i] - start_[i]) / step_ - wind.velocity;
      energy += 0.5 * model_->mass[i] / (step_ * step_) * (x[i] - inertial_[i]).squaredNorm() +
                0.5 * step_ * wind.drag * model_->topology->area[i] * slip.squaredNorm();
    }
    for (int k = 0; k < num_springs(); ++k) {
      const Spring& s = spring(k);
      energy += spring_energy(model_->stiffness(k), s.rest_length, x[s.j] - x[s.i]);
      if (is_limited(s)) energy += s.rest_length * limit_of(s, x).energy;
      if (is_damped()) {
        energy += 0.5 * step_ * relative_velocity(s, x).dot(damping_force(k, relative_velocity(s, x)));
      }
    }
    for (std::size_t c = 0; c < environment_->contacts.size(); ++c) {
      const Contact& contact = environment_->contacts[c];
      const double depth = contact.depth(x);
      energy += 0.5 * contact.stiffness * depth * depth;
      energy += contact.friction * normal_force_[c] * friction_length(contact.slide(x).norm());
    }
    for (const MembraneElement& t : triangles_)
      energy += collapse_energy(t.rest, collapse_law_, corners_of(t, x));
    return energy;
  }

  /// |slide|, rounded off to a parabola where the slide is slower than kStickSpeed: there friction grows with
  /// it [m].
  double friction_length(double slide) const {
    const double sticking = kStickSpeed * step_;
    return slide < sticking ? 0.5 * slide * slide / sticking : slide - 0.5 * sticking;
  }

  /// The normal forces that friction goes by: those at x_, taken anew before every Newton iteration. Before
  /// the first one x_ is still where inertia alone would take it; then the force that stops a lone particle.
  void update_normal_forces(bool first) {
    normal_force_.resize(environment_->contacts.size());
    if (first) have_pushed_.assign(normal_force_.size(), 0);
    for (std::size_t c = 0; c < normal_force_.size(); ++c) {
      const Contact& contact = environment_->contacts[c];
      const double share = first ? inertia_share(contact) : 1.0;
      normal_force_[c] = share * contact.stiffness * contact.depth(x_);
      if (normal_force_[c] > 0) have_pushed_[c] = 1;
    }
  }

  /// How much of the contact's stiffness a lone stencil's inertia leaves of its force: a/(a + k) for inertia
  /// a = 1/(h² Σ w²/m).
  double inertia_share(const Contact& c) const {
    double inverse = 0;
    for (int k = 0; k < c.num_particles; ++k) {
      if (!is_pinned_[c.particle[k]]) inverse += c.weight[k] * c.weight[k] / model_->mass[c.particle[k]];
    }
    return 1 / (1 + c.stiffness * step_ * step_ * inverse);
  }

  bool is_damped() const { return model_->material.damping > 0 || model_->material.damping_time > 0; }

  int num_springs() const { return static_cast<int>(model_->topology->springs.size()); }
  const Spring& spring(int k) const { return model_->topology->springs[k]; }

  Vec3 relative_velocity(const Spring& s, const std::vector<Vec3>& x) const {
    return ((x[s.j] - start_[s.j]) - (x[s.i] - start_[s.i])) / step_;
  }

  /// Projected damping acts along the spring as it was at the start of the step, or for second order as it is
  /// predicted: the potential stays quadratic.
  Vec3 damping_force(int k, const Vec3& w) const {
    const double b = model_->damping(k);
    if (model_->material.damping_kind == DampingKind::plain) return plain_damping_force(b, w);
    const Spring& s = spring(k);
    return projected_damping_force(b, damped_shape_[s.j] - damped_shape_[s.i], w);
  }

  Mat3 damping_jacobian(int k) const {
    const double b = model_->damping(k);
    if (model_->material.damping_kind == DampingKind::plain) return plain_damping_jacobian(b);
    const Spring& s = spring(k);
    return projected_damping_jacobian(b, damped_shape_[s.j] - damped_shape_[s.i]);
  }

  /// On the contact's point at x_.
  Vec3 contact_force(std::size_t c) const {
    const Contact& contact = environment_->contacts[c];
    const Vec3 s = contact.slide(x_);
    const double friction = contact.friction * normal_force_[c] / std::max(s.norm(), kStickSpeed * step_);
    return contact.stiffness * contact.depth(x_) * contact.normal - friction * s;
  }

  bool is_limited(const Spring& s) const {
    return model_->elements && model_->elements->spring_limit.stiffness > 0 && s.kind != SpringKind::bend;
  }

  LimitResponse limit_of(const Spring& s, const std::vector<Vec3>& x) const {
    return limit_response(model_->elements->spring_limit, (x[s.j] - x[s.i]).norm() / s.rest_length - 1);
  }

  void add_spring_gradient(const std::vector<Vec3>& x) {
    for (int k = 0; k < num_springs(); ++k) {
      const Spring& s = spring(k);
      Vec3 force = spring_force(model_->stiffness(k), s.rest_length, x[s.j] - x[s.i]);
      if (is_limited(s)) force += limit_of(s, x).tension * (x[s.j] - x[s.i]).normalized();
      gradient_[s.i] -= force;
      gradient_[s.j] += force;
    }
  }

  void compute_gradient() {
    const Wind& wind = environment_->wind;
    gradient_.resize(x_.size());
    for (std::size_t i = 0; i < x_.size(); ++i) {
      const Vec3 velocity = (x_[i] - start_[i]) / step_;
      gradient_[i] = model_->mass[i] / (step_ * step_) * (x_[i] - inertial_[i]) -
                     wind_force(wind, model_->topology->area[i], velocity);
      if (air_.is_active()) gradient_[i] -= air_.force(static_cast<int>(i), x_[i] - start_[i]);
    }
    add_spring_gradient(x_);
    for (int k = 0; k < (is_damped() ? num_springs() : 0); ++k) {
      const Spring& s = spring(k);
      const Vec3 force = damping_force(k, relative_velocity(s, x_));
      gradient_[s.i] -= force;
      gradient_[s.j] += force;
    }
    for (std::size_t c = 0; c < normal_force_.size(); ++c) {
      const Contact& contact = environment_->contacts[c];
      const Vec3 force = contact_force(c);
      for (int k = 0; k < contact.num_particles; ++k)
        gradient_[contact.particle[k]] -= contact.weight[k] * force;
    }
    if (model_->elements) elements_.add_gradient(x_, gradient_);
    for (const MembraneElement& t : triangles_) {
      const TriangleCorners force = collapse_force(t.rest, collapse_law_, corners_of(t, x_));
      for (int c = 0; c < 3; ++c) gradient_[t.vertices[c]] -= force[c];
    }
    for (const int i : environment_->pins.particle) gradient_[i].setZero();
  }

  /// Pinned rows and columns become those of the identity.
  void assemble(bool true_hessian) {
    const Wind& wind = environment_->wind;
    for (std::size_t i = 0; i < x_.size(); ++i) {
      const double inertia = model_->mass[i] / (step_ * step_);
      matrix_.diagonal[i] =
          inertia * Mat3::Identity() - wind_jacobian(wind, model_->topology->area[i]) / step_;
      if (air_.is_active()) matrix_.diagonal[i] += air_.hessian(static_cast<int>(i));
    }
    for (int p = 0; p < num_springs(); ++p) {
      const Spring& s = spring(p);
      const double k = model_->stiffness(p);
      const Vec3 d = x_[s.j] - x_[s.i];
      Mat3 block =
          true_hessian ? spring_jacobian(k, s.rest_length, d) : spring_jacobian_clamped(k, s.rest_length, d);
      if (is_damped()) block += damping_jacobian(p) / step_;
      if (is_limited(s)) block += limit_jacobian(s);
      matrix_.diagonal[s.i] += block;
      matrix_.diagonal[s.j] += block;
      const bool pinned = is_pinned_[s.i] || is_pinned_[s.j];
      matrix_.off_diagonal[p] = pinned ? Mat3::Zero() : Mat3(-block);
    }
    std::fill(matrix_.off_diagonal.begin() + num_springs(), matrix_.off_diagonal.end(), Mat3::Zero());
    if (model_->elements) add_element_blocks(true_hessian ? StressFilter::exact : StressFilter::absolute);
    add_collapse_blocks(true_hessian ? CollapseFilter::exact : CollapseFilter::positive);
    for (std::size_t c = 0; c < normal_force_.size(); ++c) {
      add_contact_blocks(environment_->contacts[c], contact_hessian(c));
    }
    for (const int i : environment_->pins.particle) matrix_.diagonal[i].setIdentity();
  }

  /// Tension only pulls: positive semidefinite as it is.
  Mat3 limit_jacobian(const Spring& s) const {
    const Vec3 d = x_[s.j] - x_[s.i];
    const LimitResponse r = limit_of(s, x_);
    if (r.tension == 0) return Mat3::Zero();
    const Mat3 along = d * d.transpose() / d.squaredNorm();
    return r.stiffness / s.rest_length * along + r.tension / d.norm() * (Mat3::Identity() - along);
  }

  bool is_beyond_limit() const {
    if (!model_->elements) return false;
    const double most = 1 + model_->elements->spring_limit.allowed();
    const auto is_beyond = [&](const Spring& s) {
      return is_limited(s) && (x_[s.j] - x_[s.i]).norm() > most * s.rest_length;
    };
    const std::vector<Spring>& springs = model_->topology->springs;
    return elements_.is_beyond_limit(x_) || std::any_of(springs.begin(), springs.end(), is_beyond);
  }

  void add_block(int i, int j, const Mat3& block) {
    if (i == j) {
      matrix_.diagonal[i] += block;
    } else if (!is_pinned_[i] && !is_pinned_[j]) {
      const int p = index_of_pair(i, j);
      matrix_.off_diagonal[p] += matrix_.pairs[p][0] == i ? block : Mat3(block.transpose());
    }
  }

  void add_element_blocks(StressFilter filter) {
    elements_.add_hessian(x_, filter, [this](int i, int j, const Mat3& block) { add_block(i, j, block); });
  }

  void add_collapse_blocks(CollapseFilter filter) {
    for (const MembraneElement& t : triangles_) {
      const CollapseHessian hessian = collapse_hessian(t.rest, collapse_law_, corners_of(t, x_), filter);
      if (hessian.num_modes == 0) continue;
      for (int a = 0; a < 3; ++a) {
        for (int b = 0; b <= a; ++b) add_block(t.vertices[a], t.vertices[b], collapse_block(hessian, a, b));
      }
    }
  }

  void add_contact_blocks(const Contact& contact, const Mat3& hessian) {
    for (int k = 0; k < contact.num_particles; ++k) {
      const int i = contact.particle[k];
      matrix_.diagonal[i] += contact.weight[k] * contact.weight[k] * hessian;
      for (int l = 0; l < k; ++l) {
        const int j = contact.particle[l];
        if (is_pinned_[i] || is_pinned_[j]) continue;
        matrix_.off_diagonal[index_of_pair(i, j)] += contact.weight[k] * contact.weight[l] * hessian;
      }
    }
  }

  /// The contact's push along the normal, and friction across it; a slide that is under way resists only
  /// sideways.
  Mat3 contact_hessian(std::size_t c) const {
    const Contact& contact = environment_->contacts[c];
    const Mat3 normal = contact.normal * contact.normal.transpose();
    const double stiffness = contact.depth(x_) > 0 ? contact.stiffness : 0.0;
    const Vec3 s = contact.slide(x_);
    const double length = s.norm(), sticking = kStickSpeed * step_;
    Mat3 across = Mat3::Identity() - normal;
    if (length > sticking) across -= s * s.transpose() / (length * length);
    return stiffness * normal + contact.friction * normal_force_[c] / std::max(length, sticking) * across;
  }

  /// Newton's direction, with the true Hessian where wanted and possible. False if there is none (not
  /// finite).
  bool find_direction(bool try_true_hessian) {
    if (try_true_hessian) assemble(true);
    if (!try_true_hessian || !cholesky_.factorize(matrix_)) {
      assemble(false);
      if (!cholesky_.factorize(matrix_)) return false;
    }
    direction_.resize(x_.size());
    for (std::size_t i = 0; i < x_.size(); ++i) direction_[i] = -gradient_[i];
    cholesky_.solve(direction_);
    return true;
  }

  /// Goes along direction_ as far as the energy falls enough; returns the share gone, 0 if it does not fall.
  double search_line() {
    const double energy = compute_energy(x_);
    double slope = 0;
    for (std::size_t i = 0; i < x_.size(); ++i) slope += gradient_[i].dot(direction_[i]);
    const double rounding = 1e-13 * std::abs(energy);
    for (double share = 1; share > kSmallestShare; share /= 2) {
      trial_ = x_;
      for (std::size_t i = 0; i < x_.size(); ++i) trial_[i] += share * direction_[i];
      if (compute_energy(trial_) <= energy + kArmijo * share * slope + rounding) {
        x_.swap(trial_);
        return share;
      }
    }
    return 0;
  }

  static double largest(const std::vector<Vec3>& values) {
    double result = 0;
    for (const Vec3& v : values) result = std::max(result, v.norm());
    return result;
  }

  ImplicitEulerSettings settings_;
  Order order_;
  Keeps keeps_;
  std::shared_ptr<const ClothTopology> analyzed_;
  std::shared_ptr<const ClothElements> analyzed_elements_;
  bool is_analyzed_ = false;
  std::vector<Pair> spring_pairs_, contact_pairs_, wanted_pairs_;  // sorted, lower particle first
  std::size_t num_lasting_pairs_ = 0;  // of springs and elements, before those of contacts
  ElementTerms elements_;
  std::vector<MembraneElement> triangles_;  // all
  StrainLimit collapse_law_;
  AirTerms air_;
  std::vector<std::pair<Pair, int>> pair_index_;  // of matrix_.pairs, sorted
  SymmetricBlockMatrix matrix_;
  BlockCholesky cholesky_;

  // The step being taken.
  const ClothModel* model_ = nullptr;
  const Environment* environment_ = nullptr;
  double step_ = 0;      // T [s]
  PreciseState before_;  // at the start of the step
  std::vector<char> is_pinned_;
  std::vector<double> normal_force_;  // of each contact [N]
  std::vector<char> have_pushed_;     // of the contacts, since the step began
  std::vector<Vec3> contact_forces_;  // of each contact, at the end of the step [N]
  std::vector<Vec3> start_, inertial_, damped_shape_, x_, trial_, gradient_, direction_;
};

}  // namespace

std::unique_ptr<Integrator> make_implicit_euler(const ImplicitEulerSettings& settings) {
  return std::make_unique<ImplicitEulerIntegrator>(settings, Order::first, Keeps::floats);
}

std::unique_ptr<Integrator> make_implicit_euler_in_double(const ImplicitEulerSettings& settings) {
  return std::make_unique<ImplicitEulerIntegrator>(settings, Order::first, Keeps::doubles);
}

std::unique_ptr<Integrator> make_newton_in_double() {
  return std::make_unique<ImplicitEulerIntegrator>(ImplicitEulerSettings{.tolerance = kReferenceTolerance},
                                                   Order::second, Keeps::doubles);
}

}  // namespace weft
