/// Implicit Euler with the true forces: the reference. Each step minimises the incremental potential
///
///     E(x) = 1/(2h²) |x − y|²_M + elastic terms (the list in forces/terms.h)
///            + h · (damping, wind and air dissipation at velocity (x − x₀)/h)
///            + Σ ½ k_c max(0, offset − n·Σ w x)² + µ N |slide| over the contacts,    y = x₀ + h v₀ + h² g,
///
/// by Newton's method with line search and sparse Cholesky, in double precision. `newton` in double precision
/// is the same from another start: BDF2 is implicit Euler over T = h/β from x₀ + m s with the velocity v + m
/// (v − v₋₁), s being the displacement of the last step (newton_kernels.h: β, m). Where the true Hessian is
/// not positive definite (compressed springs), the SPD projection of spring_jacobian_clamped replaces it:
/// with a line search it needs a third of the iterations that absolute values need (10 against 37 on a
/// buckling 64 x 64 sheet).

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <utility>

#include "weft/integrators/contact_groups.h"
#include "weft/integrators/contact_terms.h"
#include "weft/integrators/implicit_cloth.h"
#include "weft/solvers/block_cholesky.h"

namespace weft::engine {
namespace {

constexpr double kArmijo = 1e-4;              // minimum decrease over the predicted one
constexpr double kSmallestShare = 1e-8;       // smallest share of a Newton step in the line search
constexpr double kFinest = 1e-6;              // of the tolerance: smallest moves iterated for strain limits
constexpr double kStickSpeed = 1e-3;          // slower slides count as sticking [m/s]
constexpr double kReferenceTolerance = 1e-9;  // of `newton` in doubles [m/s]

/// Cloths joined by contacts, solved together in a step. Particles are numbered through all of them.
class ImplicitGroup {
 public:
  explicit ImplicitGroup(const ImplicitEulerSettings& settings) : settings_(settings) {}

  /// The cloths have begun the step; contacts use the group's numbers.
  IntegratorReport advance(std::span<ImplicitCloth* const> cloths, std::vector<Contact>& contacts,
                           Order order, bool computes_contact_forces) {
    cloths_.assign(cloths.begin(), cloths.end());
    contacts_ = &contacts;
    begin_step(order);
    const IntegratorReport report = minimise();
    if (computes_contact_forces) compute_contact_forces();
    finish_step();
    return report;
  }

 private:
  void begin_step(Order order) {
    first_.assign(1, 0);
    is_pinned_.clear();
    for (const ImplicitCloth* cloth : cloths_) {
      for (int i = 0; i < cloth->model().num_particles(); ++i) is_pinned_.push_back(cloth->is_pinned(i));
      first_.push_back(static_cast<int>(is_pinned_.size()));
    }
    fit_pattern();
    if (order == Order::second) begin_second_order();
    x_.clear();
    for (ImplicitCloth* cloth : cloths_) {
      cloth->place_pins();
      x_.insert(x_.end(), cloth->placed().begin(), cloth->placed().end());
    }
    step_ = cloths_[0]->effective_step();
    parts_.resize(cloths_.size());
  }

  /// BDF2, unless contact is active in this step or was in the last one (see `newton`).
  void begin_second_order() {
    if (std::any_of(cloths_.begin(), cloths_.end(), [](const auto* c) { return c->is_first_order(); }))
      return;
    x_.clear();
    for (const ImplicitCloth* cloth : cloths_)
      x_.insert(x_.end(), cloth->inertial().begin(), cloth->inertial().end());
    if (std::any_of(contacts_->begin(), contacts_->end(), [&](const Contact& c) { return c.depth(x_) > 0; }))
      return;
    for (ImplicitCloth* cloth : cloths_) cloth->begin_second_order();
  }

  void finish_step() {
    std::vector<char> is_pushed(cloths_.size(), 0);
    for (Contact& c : *contacts_) {
      c.push = c.stiffness * c.depth(x_);
      if (c.push == 0) continue;
      for (int k = 0; k < c.num_particles; ++k) is_pushed[cloth_of(c.particle[k])] = 1;
    }
    for (std::size_t c = 0; c < cloths_.size(); ++c)
      cloths_[c]->finish(part_of(x_, static_cast<int>(c)), is_pushed[c] != 0);
  }

  int cloth_of(int particle) const {
    return static_cast<int>(std::upper_bound(first_.begin(), first_.end(), particle) - first_.begin()) - 1;
  }

  /// A cloth's part of values.
  const std::vector<Vec3>& part_of(const std::vector<Vec3>& values, int cloth) {
    std::vector<Vec3>& part = parts_[cloth];
    part.assign(values.begin() + first_[cloth], values.begin() + first_[cloth + 1]);
    return part;
  }

  void compute_contact_forces() {
    std::vector<Contact*> contacts;
    std::vector<std::array<int, 4>> at;
    for (std::size_t n = 0; n < contacts_->size(); ++n) {
      Contact& c = (*contacts_)[n];
      c.force = contact_force(n);
      contacts.push_back(&c);
      at.push_back(c.particle);
    }
    compute_gradient();
    for (std::size_t i = 0; i < gradient_.size(); ++i) gradient_[i] = -gradient_[i];
    give_rest_to_contacts(at, gradient_, is_pinned_, contacts);
  }

  using Pair = std::pair<int, int>;

  /// Identity of the persistent part of the pattern.
  struct Layout {
    std::vector<std::shared_ptr<const ClothTopology>> topologies;
    std::vector<std::shared_ptr<const ClothElements>> elements;

    bool operator==(const Layout&) const = default;
  };

  /// Gives the matrix a block for every pair that terms or contacts couple, and no others: the elimination order, and
  /// with it rounding, must not depend on past contacts.
  void fit_pattern() {
    Layout layout;
    for (const ImplicitCloth* cloth : cloths_) {
      layout.topologies.push_back(cloth->model().topology);
      layout.elements.push_back(cloth->model().elements);
    }
    if (layout != layout_) {
      layout_ = std::move(layout);
      list_lasting_pairs();
    }
    wanted_pairs_.clear();
    for (const Contact& c : *contacts_) {
      for (int k = 1; k < c.num_particles; ++k) {
        for (int l = 0; l < k; ++l) {
          const Pair pair = std::minmax(c.particle[k], c.particle[l]);
          if (!std::binary_search(lasting_pairs_.begin(), lasting_pairs_.end(), pair))
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
    if (!is_analyzed_) analyze();
  }

  void list_lasting_pairs() {
    matrix_.diagonal.resize(first_.back());
    matrix_.pairs.clear();
    lasting_pairs_.clear();
    for (std::size_t c = 0; c < cloths_.size(); ++c) {
      for (const auto& [i, j] : cloths_[c]->find_pairs())
        lasting_pairs_.push_back({first_[c] + i, first_[c] + j});
    }
    for (const auto& [i, j] : lasting_pairs_) matrix_.pairs.push_back({i, j});
    contact_pairs_.clear();
    is_analyzed_ = false;
  }

  void analyze() {
    matrix_.pairs.resize(lasting_pairs_.size());
    for (const auto& [i, j] : contact_pairs_) matrix_.pairs.push_back({i, j});
    matrix_.off_diagonal.resize(matrix_.pairs.size());
    first_pair_.assign(first_.back() + 1, 0);
    pair_index_.clear();
    for (std::size_t p = 0; p < matrix_.pairs.size(); ++p) {
      const auto& [i, j] = matrix_.pairs[p];
      ++first_pair_[i + 1];
      pair_index_.push_back({{i, j}, static_cast<int>(p)});
    }
    std::partial_sum(first_pair_.begin(), first_pair_.end(), first_pair_.begin());
    std::sort(pair_index_.begin(), pair_index_.end());
    cholesky_.analyze(first_.back(), matrix_.pairs);
    is_analyzed_ = true;
  }

  /// Index of the block of particles i and j.
  int index_of_pair(int i, int j) const {
    const Pair pair = std::minmax(i, j);
    const auto begin = pair_index_.begin() + first_pair_[pair.first],
               end = pair_index_.begin() + first_pair_[pair.first + 1];
    return std::lower_bound(begin, end, std::pair(pair, 0))->second;
  }

  /// Newton's method from x_. Afterwards x_ is the minimum, or the best point found.
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

  double compute_energy(const std::vector<Vec3>& x) {
    double energy = 0;
    for (std::size_t c = 0; c < cloths_.size(); ++c)
      energy += sum_energies(cloths_[c]->terms(), part_of(x, static_cast<int>(c)));
    for (std::size_t n = 0; n < contacts_->size(); ++n) {
      const Contact& contact = (*contacts_)[n];
      const double depth = contact.depth(x);
      energy += 0.5 * contact.stiffness * depth * depth;
      energy += contact.friction * normal_force_[n] * friction_length(contact.slide(x).norm());
    }
    return energy;
  }

  /// |slide|, smoothed to a parabola below kStickSpeed: there friction grows with the slide [m].
  double friction_length(double slide) const {
    const double sticking = kStickSpeed * step_;
    return slide < sticking ? 0.5 * slide * slide / sticking : slide - 0.5 * sticking;
  }

  /// The normal forces of friction: those at x_, updated before every Newton iteration. Before the first one
  /// x_ is the inertial prediction; then the force that stops a lone particle is used.
  void update_normal_forces(bool first) {
    normal_force_.resize(contacts_->size());
    for (std::size_t n = 0; n < normal_force_.size(); ++n) {
      Contact& contact = (*contacts_)[n];
      if (first) contact.has_pushed = false;
      const double share = first ? inertia_share(contact) : 1.0;
      normal_force_[n] = share * contact.stiffness * contact.depth(x_);
      contact.has_pushed |= normal_force_[n] > 0;
    }
  }

  /// The share of the contact's force that remains for a lone stencil with its inertia: a/(a + k) for inertia
  /// a = 1/(h² Σ w²/m).
  double inertia_share(const Contact& c) const {
    double inverse = 0;
    for (int k = 0; k < c.num_particles; ++k) {
      const int i = c.particle[k], cloth = cloth_of(i);
      if (!is_pinned_[i])
        inverse += c.weight[k] * c.weight[k] / cloths_[cloth]->model().mass[i - first_[cloth]];
    }
    return 1 / (1 + c.stiffness * step_ * step_ * inverse);
  }

  /// Force on the contact's point at x_.
  Vec3 contact_force(std::size_t n) const {
    const Contact& contact = (*contacts_)[n];
    const Vec3 s = contact.slide(x_);
    const double friction = contact.friction * normal_force_[n] / std::max(s.norm(), kStickSpeed * step_);
    return contact.stiffness * contact.depth(x_) * contact.normal - friction * s;
  }

  void compute_gradient() {
    gradient_.resize(x_.size());
    for (std::size_t c = 0; c < cloths_.size(); ++c) {
      own_force_.assign(first_[c + 1] - first_[c], Vec3::Zero());
      add_forces(cloths_[c]->terms(), part_of(x_, static_cast<int>(c)), own_force_);
      for (std::size_t i = 0; i < own_force_.size(); ++i) gradient_[first_[c] + i] = -own_force_[i];
    }
    for (std::size_t n = 0; n < normal_force_.size(); ++n) {
      const Contact& contact = (*contacts_)[n];
      const Vec3 force = contact_force(n);
      for (int k = 0; k < contact.num_particles; ++k)
        gradient_[contact.particle[k]] -= contact.weight[k] * force;
    }
    for (std::size_t i = 0; i < x_.size(); ++i) {
      if (is_pinned_[i]) gradient_[i].setZero();
    }
  }

  /// Pinned rows and columns become those of the identity matrix.
  void assemble(HessianKind kind) {
    std::fill(matrix_.diagonal.begin(), matrix_.diagonal.end(), Mat3::Zero());
    std::fill(matrix_.off_diagonal.begin(), matrix_.off_diagonal.end(), Mat3::Zero());
    for (std::size_t c = 0; c < cloths_.size(); ++c) {
      const int first = first_[c];
      const std::vector<Vec3>& x = part_of(x_, static_cast<int>(c));
      for (const auto& term : cloths_[c]->terms()) {
        term->add_hessian(x, kind,
                          [&](int i, int j, const Mat3& block) { add_block(first + i, first + j, block); });
      }
    }
    for (std::size_t n = 0; n < normal_force_.size(); ++n)
      add_contact_blocks((*contacts_)[n], contact_hessian(n));
    for (std::size_t i = 0; i < x_.size(); ++i) {
      if (is_pinned_[i]) matrix_.diagonal[i].setIdentity();
    }
  }

  bool is_beyond_limit() {
    for (std::size_t c = 0; c < cloths_.size(); ++c) {
      const std::vector<Vec3>& x = part_of(x_, static_cast<int>(c));
      for (const auto& term : cloths_[c]->terms()) {
        if (term->is_beyond_limit(x)) return true;
      }
    }
    return false;
  }

  void add_block(int i, int j, const Mat3& block) {
    if (i == j) {
      matrix_.diagonal[i] += block;
    } else if (!is_pinned_[i] && !is_pinned_[j]) {
      const int p = index_of_pair(i, j);
      matrix_.off_diagonal[p] += matrix_.pairs[p][0] == i ? block : Mat3(block.transpose());
    }
  }

  void add_contact_blocks(const Contact& contact, const Mat3& hessian) {
    for (int k = 0; k < contact.num_particles; ++k) {
      for (int l = 0; l <= k; ++l)
        add_block(contact.particle[k], contact.particle[l], contact.weight[k] * contact.weight[l] * hessian);
    }
  }

  /// The contact's stiffness along the normal, and friction across it; friction of a moving slide has
  /// stiffness only sideways.
  Mat3 contact_hessian(std::size_t n) const {
    const Contact& contact = (*contacts_)[n];
    const Mat3 normal = contact.normal * contact.normal.transpose();
    const double stiffness = contact.depth(x_) > 0 ? contact.stiffness : 0.0;
    const Vec3 s = contact.slide(x_);
    const double length = s.norm(), sticking = kStickSpeed * step_;
    Mat3 across = Mat3::Identity() - normal;
    if (length > sticking) across -= s * s.transpose() / (length * length);
    return stiffness * normal + contact.friction * normal_force_[n] / std::max(length, sticking) * across;
  }

  /// Newton direction, with the true Hessian where requested and possible. Returns false if there is none
  /// (not finite).
  bool find_direction(bool try_true_hessian) {
    if (try_true_hessian) assemble(HessianKind::exact);
    if (!try_true_hessian || !cholesky_.factorize(matrix_)) {
      assemble(HessianKind::positive);
      if (!cholesky_.factorize(matrix_)) return false;
    }
    direction_.resize(x_.size());
    for (std::size_t i = 0; i < x_.size(); ++i) direction_[i] = -gradient_[i];
    solve(direction_);
    return true;
  }

  /// Solves with the factorised matrix and the terms' parts of rank one (Sherman and Morrison).
  void solve(std::vector<Vec3>& values) {
    updates_.clear();
    for (std::size_t c = 0; c < cloths_.size(); ++c) {
      const std::vector<Vec3>& x = part_of(x_, static_cast<int>(c));
      for (const auto& term : cloths_[c]->terms()) {
        if (const auto rank_one = term->rank_one(x)) add_update(*rank_one, first_[c]);
      }
    }
    solve_with_updates(values);
  }

  void add_update(const Term::RankOne& rank_one, int first) {
    Update update{rank_one.stiffness, std::vector<Vec3>(x_.size(), Vec3::Zero()), {}};
    std::copy(rank_one.gradient.begin(), rank_one.gradient.end(), update.gradient.begin() + first);
    for (std::size_t i = 0; i < x_.size(); ++i) {
      if (is_pinned_[i]) update.gradient[i].setZero();
    }
    update.solution = update.gradient;
    solve_with_updates(update.solution);
    updates_.push_back(std::move(update));
  }

  /// With those so far.
  void solve_with_updates(std::vector<Vec3>& values) {
    cholesky_.solve(values);
    for (const Update& part : updates_) {
      const double share = part.stiffness * dot(part.gradient, values) /
                           (1 + part.stiffness * dot(part.gradient, part.solution));
      for (std::size_t i = 0; i < values.size(); ++i) values[i] -= share * part.solution[i];
    }
  }

  static double dot(const std::vector<Vec3>& a, const std::vector<Vec3>& b) {
    double sum = 0;
    for (std::size_t i = 0; i < a.size(); ++i) sum += a[i].dot(b[i]);
    return sum;
  }

  /// Backtracking line search along direction_; returns the accepted share, 0 if the energy does not
  /// decrease.
  double search_line() {
    const double energy = compute_energy(x_);
    const double slope = dot(gradient_, direction_);
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

  /// stiffness · gradient gradientᵀ, and the solution of gradient without it.
  struct Update {
    double stiffness;
    std::vector<Vec3> gradient, solution;
  };

  ImplicitEulerSettings settings_;
  std::vector<Update> updates_;

  // The pattern.
  Layout layout_;
  bool is_analyzed_ = false;
  std::vector<Pair> lasting_pairs_, contact_pairs_, wanted_pairs_;  // sorted, lower particle first
  std::vector<int> first_pair_;                   // (particles + 1) into pair_index_, by the lower particle
  std::vector<std::pair<Pair, int>> pair_index_;  // into matrix_.pairs, sorted
  SymmetricBlockMatrix matrix_;
  BlockCholesky cholesky_;

  // The step being taken.
  std::vector<ImplicitCloth*> cloths_;
  std::vector<int> first_;  // (cloths + 1) particles
  std::vector<Contact>* contacts_ = nullptr;
  double step_ = 0;  // T [s]
  std::vector<char> is_pinned_;
  std::vector<double> normal_force_;  // of each contact [N]
  std::vector<Vec3> x_, trial_, gradient_, direction_, own_force_;
  std::vector<std::vector<Vec3>> parts_;  // (cloths)
};

class ImplicitEulerIntegrator final : public Integrator {
 public:
  ImplicitEulerIntegrator(const ImplicitEulerSettings& settings, Order order, Keeps keeps)
      : settings_(settings), order_(order), keeps_(keeps) {}

  bool resolves_contacts() const override { return true; }

  IntegratorReport advance(std::span<const Body> bodies, std::span<Contact> contacts, const SystemStep& step,
                           JobSystem&) override {
    cloths_.resize(std::max(cloths_.size(), bodies.size()));
    for (std::size_t b = 0; b < bodies.size(); ++b) cloths_[b].begin(bodies[b], step.step, order_, keeps_);
    groups_.find(bodies, contacts);
    IntegratorReport report;
    for (int g = 0; g < groups_.size(); ++g)
      report.include(advance_group(g, contacts, step), groups_.bodies(g)[0]);
    return report;
  }

 private:
  IntegratorReport advance_group(int g, std::span<Contact> contacts, const SystemStep& step) {
    std::vector<ImplicitCloth*> members;
    std::vector<int> shift(groups_.bodies(g).back() + 1);  // from numbers of all bodies to the group's
    int size = 0;
    for (const int b : groups_.bodies(g)) {
      members.push_back(&cloths_[b]);
      shift[b] = size - groups_.first_particle(b);
      size += cloths_[b].model().num_particles();
    }
    std::vector<Contact> own;
    for (const int n : groups_.contacts(g)) {
      Contact& c = own.emplace_back(contacts[n]);
      for (int k = 0; k < c.num_particles; ++k) c.particle[k] += shift[groups_.body_of(c.particle[k])];
    }
    ImplicitGroup& system = systems_.try_emplace(groups_.bodies(g)[0], settings_).first->second;
    const IntegratorReport report = system.advance(members, own, order_, step.computes_contact_forces);
    for (std::size_t n = 0; n < own.size(); ++n) {
      contacts[groups_.contacts(g)[n]].has_pushed = own[n].has_pushed;
      contacts[groups_.contacts(g)[n]].push = own[n].push;
      contacts[groups_.contacts(g)[n]].force = own[n].force;
    }
    return report;
  }

  ImplicitEulerSettings settings_;
  Order order_;
  Keeps keeps_;
  std::vector<ImplicitCloth> cloths_;
  ContactGroups groups_;
  std::map<int, ImplicitGroup> systems_;  // by first cloth: patterns are kept while groups stay
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

}  // namespace weft::engine
