/// Semi-implicit (symplectic) Euler: v' = v + h F(x, v)/m, x' = x + h v'.

#include <algorithm>
#include <cmath>

#include "weft/integrators/common.h"

namespace weft::engine {
namespace {

/// Safety factor on the stability limit for automatic substeps: the limit applies to the cloth at rest.
constexpr double kSafety = 0.5;

class ExplicitIntegrator final : public ClothIntegrator {
 public:
  explicit ExplicitIntegrator(const ExplicitSettings& settings) : settings_(settings) {}

  int num_substeps(const ClothModel& model, const Environment& environment, double step) const override {
    if (settings_.substeps > 0) return settings_.substeps;
    const double limit = explicit_step_limit(model, environment.wind);
    return std::max(1, static_cast<int>(std::ceil(step / (kSafety * limit))));
  }

  IntegratorReport advance(const ClothModel& model, const Environment& environment, double step,
                           JobSystem& jobs, ClothState& state) override {
    weights_.fit(model, 0.0);
    pins_.prepare(environment.pins, step, state);
    const IncrementSettings settings = make_increment_settings(model, environment, step);
    compute_increments(model, state, settings, weights_.mass(), weights_.weight(), jobs, increments_);
    apply_increments(increments_, settings.step, step * environment.gravity, jobs, state);
    pins_.finish(environment.pins, state);
    return {};
  }

 private:
  ExplicitSettings settings_;
  Weights weights_;
  PinMotion pins_;
  IncrementField increments_;
};

}  // namespace

double explicit_step_limit(const ClothModel& model, const Wind& wind) {
  // Gershgorin bounds the squared frequency by 2 max Σk/m and the damping rate by 2 max Σd/m, so
  // h²ω² + 2hγ < 4 is sufficient for every mode.
  const double omega_sq = 2 * model.max_stiffness_rate;
  const double gamma = 2 * model.max_damping_rate + wind.drag / model.material.density;
  if (omega_sq == 0 && gamma == 0) return std::numeric_limits<double>::infinity();
  return 4 / (gamma + std::sqrt(gamma * gamma + 4 * omega_sq));
}

std::unique_ptr<Integrator> make_explicit(const ExplicitSettings& settings) {
  return make_one_by_one([=] { return std::make_unique<ExplicitIntegrator>(settings); });
}

}  // namespace weft::engine
