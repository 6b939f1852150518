#include "weft/integrators/integrator.h"

#include <algorithm>

#include "weft/error.h"

namespace weft {

const std::vector<std::string_view>& integrator_names() {
  static const std::vector<std::string_view> names = [] {
    std::vector<std::string_view> list;
    for (const engine::IntegratorRow& row : engine::integrator_rows()) list.push_back(row.name);
    return list;
  }();
  return names;
}

}  // namespace weft

namespace weft::engine {
namespace {

constexpr const char* kPaperAdvice =
    "raise solver.steps_per_frame or lower the damping, which this integrator treats explicitly";

constexpr Support kSpringsOnly;
constexpr Support kEverything{.elements = true,
                              .seams = true,
                              .pressure = true,
                              .bending_memory = true,
                              .aerodynamics = true,
                              .step_division = true};

using Settings = const IntegratorSettings&;

constexpr IntegratorRow kIntegrators[] = {
    {"explicit", [](Settings s) { return make_explicit(s.explicit_euler); }, nullptr, kSpringsOnly, false,
     "raise solver.explicit.substeps (0 chooses them), or soften the springs"},
    {"paper", [](Settings s) { return make_paper(s.paper); }, nullptr, kSpringsOnly, false, kPaperAdvice},
    {"paper_fixed", [](Settings) { return make_paper_fixed(); }, nullptr, kSpringsOnly, false, kPaperAdvice},
    {"desbrun", [](Settings) { return make_desbrun(); }, nullptr, kSpringsOnly, false, kPaperAdvice},
    {"implicit_euler", [](Settings s) { return make_implicit_euler(s.implicit_euler); },
     [](Settings s) { return make_implicit_euler_in_double(s.implicit_euler); }, kEverything, false,
     "raise solver.steps_per_frame, or set solver.adaptive = true"},
    {"newton", [](Settings s) { return make_newton(s.newton); },
     [](Settings) { return make_newton_in_double(); }, kEverything, true,
     "raise solver.max_steps_per_frame or solver.steps_per_frame"},
    {"xpbd",
     [](Settings s) { return make_xpbd(s.xpbd); },
     nullptr,
     {.elements = true, .seams = true, .pressure = true},
     false,
     "raise solver.xpbd.substeps or solver.steps_per_frame"},
};

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

std::span<const IntegratorRow> integrator_rows() { return kIntegrators; }

const IntegratorRow& find_integrator(std::string_view name) {
  for (const IntegratorRow& row : kIntegrators) {
    if (row.name == name) return row;
  }
  throw InputError("unknown integrator \"" + std::string(name) +
                   "\"; available: " + list_integrators([](const IntegratorRow&) { return true; }));
}

std::unique_ptr<Integrator> make_integrator(const IntegratorSettings& settings) {
  const IntegratorRow& row = find_integrator(settings.integrator);
  if (!settings.is_double) return row.make(settings);
  if (row.make_in_double) return row.make_in_double(settings);
  throw InputError("integrator \"" + settings.integrator + "\" does not support double precision; use " +
                   list_in_double());
}

double compute_stiffness_number(const ClothModel& model, double step) {
  return step * step * model.max_stiffness_rate;
}

double gravity_factor(double a) { return (1 + 2 * a) / ((1 + a) * (1 + a)); }

}  // namespace weft::engine
