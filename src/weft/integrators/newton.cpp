/// The default integrator: BDF2, one Newton step, and conjugate gradients preconditioned by one multigrid
/// V-cycle on the paper's constant matrix. A step minimises the incremental potential
///
///     E(x) = ½ |x − y|²_D + springs or elements + collapse + dissipation,   D = (β/h)² M + wind,
///     y from two past states and gravity
///
/// (forces/potential.h, forces/collapse.h), starting from y: most of the motion is right even with a poor
/// solve.
///
/// Cloths in contact are solved together: E is the sum of all, contacts couple them, conjugate gradients have
/// one α and β, and each cloth has its own V-cycle.
///
/// The guard requests another Newton step if the error of the quadratic model, E − (E₀ − predicted decrease),
/// is more than a fifth of E; for stiff cloth also if the last Newton step lowered E by a third. If the
/// potential rises, a backtracking line search shortens the step.

#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>

#include "weft/integrators/contact_groups.h"
#include "weft/integrators/contact_terms.h"
#include "weft/integrators/floating_components.h"
#include "weft/integrators/newton_cloth.h"
#include "weft/integrators/solver_budget.h"

namespace weft::engine {
namespace {

constexpr double kMissedShare = 0.2;   // of the energy: a larger model error requests one more Newton step
constexpr double kFallingShare = 0.5;  // of the remaining energy: likewise for a larger last decrease
constexpr int kMinStepsInContact = 2;  // the first one has no contacts and contact forces
constexpr int kMaxStepsInContact = 6;
constexpr int kMinStepsToStall = 3;        // the first ones have friction from estimated forces
constexpr double kStalled = 0.8;           // of the unrest: a step that leaves more of it does not help …
constexpr double kStalledDecrease = 0.02;  // … if it also lowers the energy by less than this share
constexpr int kInertialIterationFactor =
    2;                                    // factor on iterations from x + h v, which must add all of gravity
constexpr double kNoise = 1e-9;           // of the decrease: below, float iterations change only rounding
constexpr int kMaxStepsBeyondLimit = 24;  // while a stretch exceeds the limit by more than allowed
constexpr double kLimitFalling = 1e-4;    // … and a step still lowers the energy by this share
constexpr int kMaxHalvings = 8;           // of a Newton step that raises the potential

/// Cloths joined by contacts, in a step.
class NewtonGroup {
 public:
  /// The cloths have begun the step. Also takes the numbers of their first particles, and their contacts.
  void begin(std::span<NewtonCloth* const> cloths, std::span<const int> first_particles,
             std::span<Contact> contacts, std::span<const int> which, const SystemStep& step,
             JobSystem& jobs) {
    cloths_.assign(cloths.begin(), cloths.end());
    step_ = step;
    jobs_ = &jobs;
    members_.clear();
    blocks_.clear();
    for (std::size_t c = 0; c < cloths_.size(); ++c) {
      members_.push_back(cloths_[c]->member(first_particles[c]));
      blocks_.push_back(&cloths_[c]->block());
    }
    contacts_.begin(contacts, which, members_, step.step, step.step * step.step * cloths_[0]->gravity());
    predict();
    free_members_.clear();
    for (const NewtonCloth* cloth : cloths_) free_members_.push_back(cloth->free_member());
    bodies_.begin(free_members_);
  }

  IntegratorReport solve(const NewtonSettings& settings) {
    choose_start();
    double stiffness_number = 0;
    noise_ = 0;
    for (const NewtonCloth* cloth : cloths_) {
      stiffness_number = std::max(stiffness_number, cloth->stiffness_number());
      noise_ += cloth->noise();
    }
    return minimise(settings, choose_budget(settings, stiffness_number));
  }

  void finish() {
    is_pushed_.assign(cloths_.size(), 0);
    contacts_.finish(positions(), is_pushed_);
    if (step_.computes_contact_forces) compute_contact_forces();
    for (std::size_t c = 0; c < cloths_.size(); ++c) cloths_[c]->finish(is_pushed_[c] != 0, *jobs_);
  }

 private:
  /// BDF2; implicit Euler while contact is active in this step or was in the last one, because BDF2 uses
  /// velocities from before an impact and would bounce part of them back. All cloths use the same scheme:
  /// they exchange momentum correctly only if their steps are the same.
  void predict() {
    bool is_euler =
        std::any_of(cloths_.begin(), cloths_.end(), [](const NewtonCloth* c) { return c->is_first_order(); });
    if (!contacts_.empty()) {
      for (NewtonCloth* cloth : cloths_) cloth->store_velocity_gain();
    }
    if (!is_euler && !contacts_.empty()) {
      positions_.clear();
      for (NewtonCloth* cloth : cloths_) positions_.push_back(cloth->place_freely(*jobs_));
      is_euler = contacts_.any_active(positions_);
    }
    for (NewtonCloth* cloth : cloths_) cloth->predict(is_euler, *jobs_);
  }

  /// The start is y. In contact, and with elements, it is x + h v if the potential is lower there, or that
  /// plus the mean acceleration of the last step. The prediction y lets cloth in resting contact fall, and
  /// all contact forces would have to be found again.
  void choose_start() {
    contacts_.guess(positions());
    started_inertial_ = false;
    const bool touches = !contacts_.empty();  // else there is one cloth only
    if (!touches && !cloths_[0]->has_elements()) return;
    double least = energy();
    const auto try_start = [&](bool accelerates) {
      for (NewtonCloth* cloth : cloths_) cloth->start_inertial(accelerates);
      const double energy = trial_energy();
      if (!(energy < least)) return;
      least = energy;
      started_inertial_ = true;
      accept_trial();
    };
    try_start(false);
    if (touches) try_start(true);
  }

  double energy() {
    double sum = contact_energy(positions());
    for (NewtonCloth* cloth : cloths_) sum += cloth->energy(*jobs_);
    return sum;
  }

  double trial_energy() {
    positions_.clear();
    for (const NewtonCloth* cloth : cloths_) positions_.push_back(cloth->trial_positions());
    double sum = contact_energy(positions_);
    for (NewtonCloth* cloth : cloths_) sum += cloth->trial_energy(*jobs_);
    return sum;
  }

  double contact_energy(std::span<const ContactTerms::Positions> x) {
    const WorkScope scope(contact_clock(), &WorkTimes::rows);
    return contacts_.energy(x);
  }

  void accept_trial() {
    for (NewtonCloth* cloth : cloths_) cloth->accept_trial();
  }

  std::span<const ContactTerms::Positions> positions() {
    positions_.clear();
    for (const NewtonCloth* cloth : cloths_) positions_.push_back(cloth->positions());
    return positions_;
  }

  /// Newton steps from the start.
  IntegratorReport minimise(const NewtonSettings& settings, const SolverBudget& budget) {
    IntegratorReport report{.linear_iterations = 0, .residual = 0, .guard_events = 0};
    int more = 1;  // factor on iterations, where the guard requests another Newton step
    std::optional<ContactTerms::Unrest> last;
    for (int asked = budget.newton_steps; report.iterations < asked; ++report.iterations) {
      const double before = linearise(report.iterations == 0);
      if (contacts_.is_active()) asked = std::max(asked, kMinStepsInContact);
      const CgReport linear = solve_linear(settings, budget, more);
      *report.linear_iterations += linear.iterations;
      take_larger(linear.residual, report.residual);
      double share = 1, after = try_step(share);
      for (int h = 0; !(after <= before + noise_) && h < kMaxHalvings; ++h) {
        ++*report.guard_events;
        share /= 2;
        after = try_step(share);
      }
      if (!std::isfinite(after)) break;
      accept_trial();
      const double predicted = share * (2 - share) * linear.decrease;
      const double size = std::abs(after);  // below 0 while gas expands
      const bool missed = std::abs(after - (before - predicted)) > kMissedShare * size + noise_;
      const bool is_beyond = is_beyond_limit() && before - after > kLimitFalling * size + noise_;
      const bool is_last = report.iterations + 1 == asked;
      if (!contacts_.empty()) {
        if (!is_last) continue;
        const ContactTerms::Unrest unrest = contacts_.find_unrest(positions());
        const bool is_settled = unrest.shortfall <= 1 && unrest.friction <= 1;
        const bool has_stalled = last && share == 1 && report.iterations + 1 >= kMinStepsToStall &&
                                 before - after < kStalledDecrease * size && is_stalled(*last, unrest);
        last = unrest;
        if (is_beyond ? asked < kMaxStepsBeyondLimit
                      : !is_settled && !has_stalled && asked < kMaxStepsInContact)
          ++asked;
        continue;
      }
      // The first step's decrease carries no information: most of it is forces that the prediction ignored.
      const bool is_falling =
          budget.newton_steps > 1 && report.iterations > 0 && before - after > kFallingShare * size + noise_;
      const int most = is_beyond ? kMaxStepsBeyondLimit : budget.max_newton_steps;
      if ((missed || is_falling || is_beyond) && asked < most && is_last) {
        ++asked;
        ++*report.guard_events;
        if (missed) more *= 2;
      }
    }
    return report;
  }

  /// Whether more steps would not help: the sum of friction is found, and single contacts only fluctuate with
  /// what unfinished linear solves leave.
  static bool is_stalled(const ContactTerms::Unrest& last, const ContactTerms::Unrest& now) {
    const bool holds = now.shortfall <= 1 || now.shortfall > kStalled * last.shortfall;
    const bool slides = now.friction <= 1 || now.friction > kStalled * last.friction;
    return holds && slides && now.total_friction <= 1;
  }

  bool is_beyond_limit() const {
    return std::any_of(cloths_.begin(), cloths_.end(),
                       [](const NewtonCloth* c) { return c->is_beyond_limit(); });
  }

  /// The potential with its forces and Hessian, and the preconditioners for it.
  double linearise(bool is_first) {
    double energy = 0;
    forces_.clear();
    for (NewtonCloth* cloth : cloths_) {
      energy += cloth->linearise(*jobs_);
      forces_.push_back(&cloth->force());
    }
    {
      const WorkScope scope(contact_clock(), &WorkTimes::rows);
      energy += contacts_.linearise(positions(), forces_);
    }
    preconditioners_.clear();
    for (NewtonCloth* cloth : cloths_) {
      cloth->begin_preconditioner(is_first, contacts_.is_active(), *jobs_);
      preconditioners_.push_back(cloth->preconditioners());
    }
    contacts_.add_to_preconditioners(preconditioners_);
    for (NewtonCloth* cloth : cloths_) {
      cloth->finish_preconditioner(*jobs_);
      cloth->hold_pins(cloth->force());
    }
    bodies_.release();
    contacts_.touch(bodies_);
    return energy;
  }

  CgReport solve_linear(const NewtonSettings& own, const SolverBudget& budget, int more) {
    CgSettings settings = contacts_.is_active() ? budget.in_contact : budget.free;
    if (started_inertial_ && contacts_.empty() && own.iterations == 0) {
      settings.iterations *= kInertialIterationFactor;
      settings.least *= kInertialIterationFactor;
      settings.enough /= kInertialIterationFactor;
    }
    settings.iterations *= more;
    settings.enough = std::max(settings.enough / more, kNoise);
    const auto multiply = [&] {
      double dot = 0;
      for (NewtonCloth* cloth : cloths_) dot += cloth->multiply(*jobs_);
      {
        const WorkScope scope(contact_clock(), &WorkTimes::product);
        dot += contacts_.add_product(blocks_);
      }
      for (NewtonCloth* cloth : cloths_) cloth->hold_pins(cloth->block().product);
      return dot;
    };
    const auto precondition = [&] {
      const WorkScope scope(step_.clock, &WorkTimes::v_cycle);
      double dot = 0;
      for (NewtonCloth* cloth : cloths_) dot += cloth->precondition(*jobs_);
      return dot;
    };
    return solve_conjugate_gradients(multiply, precondition, blocks_, settings, *jobs_);
  }

  /// The potential after the given share of the step [J]. Removes the spurious translation of floating
  /// components by an unfinished solve.
  double try_step(double share) {
    trials_.clear();
    for (NewtonCloth* cloth : cloths_) {
      cloth->try_step(share, *jobs_);
      trials_.push_back(&cloth->trial());
    }
    bodies_.remove_mean(trials_);
    return trial_energy();
  }

  void compute_contact_forces() {
    others_.clear();
    for (NewtonCloth* cloth : cloths_) others_.push_back(&cloth->find_forces(*jobs_));
    contacts_.compute_forces(positions(), others_);
  }

  WorkClock* contact_clock() const { return contacts_.empty() ? nullptr : step_.clock; }

  std::vector<NewtonCloth*> cloths_;
  SystemStep step_;
  JobSystem* jobs_ = nullptr;
  ContactTerms contacts_;
  FreeBodies bodies_;
  bool started_inertial_ = false;  // the step started from x + h v
  double noise_ = 0;               // rounding error of energies, from positions [J]

  // Work space (cloths).
  std::vector<ContactTerms::Member> members_;
  std::vector<ContactTerms::Positions> positions_;
  std::vector<ContactTerms::Preconditioners> preconditioners_;
  std::vector<FreeBodies::Member> free_members_;
  std::vector<CgBlock*> blocks_;
  std::vector<Vec3Array*> forces_, trials_;
  std::vector<const Vec3Array*> others_;
  std::vector<char> is_pushed_;
};

class NewtonIntegrator final : public Integrator {
 public:
  explicit NewtonIntegrator(const NewtonSettings& settings) : settings_(settings) {}

  bool resolves_contacts() const override { return true; }

  IntegratorReport advance(std::span<const Body> bodies, std::span<Contact> contacts, const SystemStep& step,
                           JobSystem& jobs) override {
    while (cloths_.size() < bodies.size()) cloths_.push_back(std::make_unique<NewtonCloth>());
    for (std::size_t b = 0; b < bodies.size(); ++b) cloths_[b]->begin(bodies[b], step);
    groups_.find(bodies, contacts);
    IntegratorReport report;
    for (int g = 0; g < groups_.size(); ++g) {
      members_.clear();
      first_particles_.clear();
      for (const int b : groups_.bodies(g)) {
        members_.push_back(cloths_[b].get());
        first_particles_.push_back(groups_.first_particle(b));
      }
      group_.begin(members_, first_particles_, contacts, groups_.contacts(g), step, jobs);
      report.include(group_.solve(settings_), groups_.bodies(g)[0]);
      group_.finish();
    }
    return report;
  }

 private:
  NewtonSettings settings_;
  std::vector<std::unique_ptr<NewtonCloth>> cloths_;
  ContactGroups groups_;
  NewtonGroup group_;
  std::vector<NewtonCloth*> members_;  // of a group
  std::vector<int> first_particles_;
};

}  // namespace

std::unique_ptr<Integrator> make_newton(const NewtonSettings& settings) {
  return std::make_unique<NewtonIntegrator>(settings);
}

}  // namespace weft::engine
