#pragma once
/// Time integration: the common interface, and its implementations.
///
///   explicit        semi-implicit Euler, v' = v + h F/m, x' = x + h v', in stable substeps
///   paper           Eq. 16 of the paper as printed: two Jacobi sweeps instead of a linear solve
///   paper_fixed     the same with gravity outside the filter, h·H·v kept, and pinned neighbours prescribed
///   desbrun         Eq. 12 with h·H·v: implicit Euler with a constant approximate Jacobian, solved exactly
///   implicit_euler  implicit Euler with the true Jacobian, Newton's method to a tolerance: slow and right
///   newton          BDF2, one Newton step, multigrid-preconditioned conjugate gradients: fast and right
///   xpbd            many small substeps, each one Gauss–Seidel pass over springs and elements, as in most engines

#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "weft/contact/contact.h"
#include "weft/core/job_system.h"
#include "weft/core/work_times.h"
#include "weft/forces/wind.h"
#include "weft/model/cloth_model.h"
#include "weft/model/cloth_state.h"
#include "weft/solver.h"

namespace weft::engine {

/// Particles with prescribed motion, and their positions at the end of the step.
struct PinTargets {
  std::vector<int> particle;   // ascending
  std::vector<Vec3> position;  // in the world [m]
};

/// External influences on a cloth during a step.
struct Environment {
  Vec3 gravity = {0, -9.81, 0};  // [m/s²]
  double time = 0;               // at the end of the step [s]
  Wind wind;
  PinTargets pins;
  std::vector<Vec3> acceleration;  // by external forces (num_particles); empty: none [m/s²]

  Vec3 external(std::size_t particle) const {
    return acceleration.empty() ? Vec3(Vec3::Zero()) : acceleration[particle];
  }
};

/// One cloth during a step.
struct Body {
  const ClothModel* model = nullptr;
  const Environment* environment = nullptr;
  ClothState* state = nullptr;
};

struct SystemStep {
  double step = 0;                       // [s]
  bool computes_contact_forces = false;  // computes Contact::force
  WorkClock* clock = nullptr;            // of the whole step; null: not measured
};

/// Adds a count to a sum; both may be empty.
void add_count(const std::optional<int>& count, std::optional<int>& sum);

/// Takes the larger of two values; both may be empty.
void take_larger(const std::optional<double>& value, std::optional<double>& largest);

/// Result of one call of advance().
struct IntegratorReport {
  bool converged = true;                 // false: the result is finite, but misses the tolerance
  int unconverged = -1;                  // the first cloth that did not converge
  int iterations = 0;                    // of the nonlinear solver, summed [1]
  std::optional<int> linear_iterations;  // of the linear solver inside it, summed [1]
  std::optional<double> residual;        // of the linear solver, CgReport::residual, the largest [1]
  std::optional<int> guard_events;       // number of guard interventions: see newton [1]

  /// Adds the report of other cloths, of which `cloth` is the first.
  void include(const IntegratorReport& other, int cloth);
};

/// Advances all cloths of a world together. The result depends on the arguments only; state that an
/// integrator keeps between calls only saves time.
class Integrator {
 public:
  virtual ~Integrator() = default;

  /// Number of equal substeps that a cloth's step requires, each with separate contact response [1].
  virtual int num_substeps(const ClothModel&, const Environment&, double /*step*/) const { return 1; }

  /// Whether advance() resolves contacts; if not, pass none.
  virtual bool resolves_contacts() const { return false; }

  /// Advances the cloths from t to t + step. Pinned particles end at their targets, with velocity
  /// (x' − x)/step. All arguments may differ from the last call. The motion of a cloth that no contact joins
  /// to other cloth is bit-identical to that of the cloth on its own.
  virtual IntegratorReport advance(std::span<const Body> bodies, std::span<Contact> contacts,
                                   const SystemStep& step, JobSystem& jobs) = 0;

  /// Advances one cloth without contact.
  IntegratorReport advance(const ClothModel& model, const Environment& environment, double step,
                           JobSystem& jobs, ClothState& state) {
    const Body body{&model, &environment, &state};
    return advance({&body, 1}, {}, {.step = step}, jobs);
  }
};

/// What only some integrators support.
struct Support {
  bool elements = false;        // membranes and bending elements (ClothModel::elements)
  bool seams = false;           // ClothTopology::seams
  bool pressure = false;        // gas inside closed cloth (ClothModel::gas)
  bool bending_memory = false;  // ClothElements::thread_bends
  bool aerodynamics = false;    // drag and lift (Wind::air); all support the paper's wind
  bool step_division = false;   // steps divided where they are too long for an impact (World::set_division)
};

struct IntegratorRow {
  std::string_view name;
  std::unique_ptr<Integrator> (*make)(const IntegratorSettings& settings);
  std::unique_ptr<Integrator> (*make_in_double)(const IntegratorSettings& settings);  // null: in floats only
  Support supports;
  bool divides_steps;         // by default
  const char* shorter_steps;  // advice where steps are too long
};

/// Every integrator, in the order of integrator_names().
std::span<const IntegratorRow> integrator_rows();

/// Throws InputError for an unknown name.
const IntegratorRow& find_integrator(std::string_view name);

/// The integrators for which `is_meant(row)`, for messages: `a, b or c`, the default first, each between two quotes.
template <class IsMeant>
std::string list_integrators(const IsMeant& is_meant, const std::string& quote = "") {
  std::vector<std::string> names;
  for (const IntegratorRow& row : integrator_rows()) {
    if (!is_meant(row)) continue;
    const bool is_default = row.name == IntegratorSettings().integrator;
    names.insert(is_default ? names.begin() : names.end(), quote + std::string(row.name) + quote);
  }
  std::string list;
  for (std::size_t k = 0; k < names.size(); ++k)
    list += (k == 0 ? "" : k + 1 < names.size() ? ", " : " or ") + names[k];
  return list;
}

/// Those that support it.
inline std::string list_supporting(bool Support::*what, const std::string& quote = "") {
  return list_integrators([=](const IntegratorRow& row) { return row.supports.*what; }, quote);
}

/// Those that have double precision.
inline std::string list_in_double(const std::string& quote = "") {
  return list_integrators([](const IntegratorRow& row) { return row.make_in_double != nullptr; }, quote);
}

/// Throws InputError for an unknown name, and for double precision where it is not supported.
std::unique_ptr<Integrator> make_integrator(const IntegratorSettings& settings);

// The implementations, one file each.
std::unique_ptr<Integrator> make_explicit(const ExplicitSettings& settings);
std::unique_ptr<Integrator> make_paper(const PaperSettings& settings);
std::unique_ptr<Integrator> make_paper_fixed();
std::unique_ptr<Integrator> make_desbrun();
std::unique_ptr<Integrator> make_implicit_euler(const ImplicitEulerSettings& settings);
std::unique_ptr<Integrator> make_implicit_euler_in_double(const ImplicitEulerSettings& settings);
std::unique_ptr<Integrator> make_newton_in_double();
std::unique_ptr<Integrator> make_newton(const NewtonSettings& settings);
std::unique_ptr<Integrator> make_xpbd(const XpbdSettings& settings);

/// The largest step at which `explicit` is guaranteed to be stable near rest [s]; infinite without springs
/// and damping.
double explicit_step_limit(const ClothModel& model, const Wind& wind);

/// The paper's stiffness number a = h² Σ_j k_ij / m_i, its largest value over the cloth [1].
double compute_stiffness_number(const ClothModel& model, double step);

/// The share of gravity that passes Eq. 16 where neighbours share a: (1 + 2a)/(1 + a)² [1].
double gravity_factor(double stiffness_number);

}  // namespace weft::engine
