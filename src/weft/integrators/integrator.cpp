#include "weft/integrators/integrator.h"

#include <algorithm>

#include "weft/error.h"

namespace weft {

const std::vector<std::string_view>& integrator_names() {
  static const std::vector<std::string_view> names = {"explicit",       "paper",  "paper_fixed", "desbrun",
                                                      "implicit_euler", "newton", "xpbd"};
  return names;
}

}  // namespace weft

namespace weft::engine {
namespace {

bool solves_implicitly(std::string_view integrator) {
  return integrator == "newton" || integrator == "implicit_euler";
}

}  // namespace

void add_count(const std::optional<int>& count, std::optional<int>& sum) {
  if (count) sum = sum.value_or(0) + *count;
}

void take_larger(const std::optional<double>& value, std::optional<double>& largest) {
  if (value) largest = std::max(largest.value_or(0), *value);
}

void IntegratorReport::include(const IntegratorReport& other, int cloth) {
  if (converged && !other.converged) unconverged = cloth;
  converged &= other.converged;
  iterations += other.iterations;
  add_count(other.linear_iterations, linear_iterations);
  take_larger(other.residual, residual);
  add_count(other.guard_events, guard_events);
}

bool supports_elements(std::string_view integrator) {
  return integrator == "implicit_euler" || integrator == "newton" || integrator == "xpbd";
}

bool supports_bending_memory(std::string_view integrator) { return solves_implicitly(integrator); }

bool supports_pressure(std::string_view integrator) { return solves_implicitly(integrator); }

bool supports_seams(std::string_view integrator) { return solves_implicitly(integrator); }

bool supports_aerodynamics(std::string_view integrator) { return solves_implicitly(integrator); }

bool supports_step_division(std::string_view integrator) { return solves_implicitly(integrator); }

bool supports_double_precision(std::string_view integrator) { return solves_implicitly(integrator); }

std::unique_ptr<Integrator> make_integrator(const IntegratorSettings& settings) {
  const std::string& name = settings.integrator;
  if (settings.is_double) {
    if (name == "implicit_euler") return make_implicit_euler_in_double(settings.implicit_euler);
    if (name == "newton") return make_newton_in_double();
    throw InputError("integrator \"" + name +
                     "\" does not support double precision; newton and implicit_euler do");
  }
  if (name == "explicit") return make_explicit(settings.explicit_euler);
  if (name == "paper") return make_paper(settings.paper);
  if (name == "paper_fixed") return make_paper_fixed();
  if (name == "desbrun") return make_desbrun();
  if (name == "implicit_euler") return make_implicit_euler(settings.implicit_euler);
  if (name == "newton") return make_newton(settings.newton);
  if (name == "xpbd") return make_xpbd(settings.xpbd);
  std::string known;
  for (const std::string_view n : integrator_names()) known += (known.empty() ? "" : ", ") + std::string(n);
  throw InputError("unknown integrator \"" + name + "\"; available: " + known);
}

double compute_stiffness_number(const ClothModel& model, double step) {
  return step * step * model.max_stiffness_rate;
}

double gravity_factor(double a) { return (1 + 2 * a) / ((1 + a) * (1 + a)); }

}  // namespace weft::engine
