/// Eq. 16 with fixes, at the same cost. Forces equal for all particles, gravity g and wind, stay outside the
/// filter (wind implicitly, for stability at any strength):
///
///     v' = (v + h g + h r v_wind)/(1 + h r) + w,    r = c_w / density
///
/// and for the other forces
///
///     w_j ≈ h F̃_j / (m_j + h² Σ_l k_jl),    F̃ = elastic + damping + h Σ_j k_ij (v_j − v_i)
///     w_i = (h F̃_i + h² Σ_j k_ij w_j) / (m_i + h² Σ_j k_ij)
///
/// The last term of F̃ is the h·H·v that the paper drops: the scheme's own numerical damping. The Δv of a
/// pinned neighbour is prescribed, not estimated.

#include "weft/integrators/common.h"

namespace weft::engine {
namespace {

class PaperFixedIntegrator final : public ClothIntegrator {
 public:
  IntegratorReport advance(const ClothModel& model, const Environment& environment, double step,
                           JobSystem& jobs, ClothState& state) override {
    const double rate = environment.wind.drag / model.material.density;
    const double drag_factor = 1 / (1 + step * rate);
    const Vec3 velocity_gain = drag_factor * step * (environment.gravity + rate * environment.wind.velocity);
    weights_.fit(model, step);
    pins_.prepare(environment.pins, step, state);
    IncrementSettings settings = make_increment_settings(model, environment, step);
    settings.wind_rate = 0;
    settings.stiffness_damping = settings.step;
    compute_increments(model, state, settings, weights_.mass(), weights_.weight(), jobs, increments_);
    for (std::size_t p = 0; p < environment.pins.particle.size(); ++p) {
      const int i = environment.pins.particle[p];
      increments_.set(i, pins_.velocity()[p] - (drag_factor * state.v.get(i) + velocity_gain));
    }
    apply_filtered_increments(model, increments_, settings.step, weights_.weight(),
                              {static_cast<float>(drag_factor), velocity_gain}, jobs, state);
    pins_.finish(environment.pins, state);
    return {};
  }

 private:
  Weights weights_;
  PinMotion pins_;
  IncrementField increments_;
};

}  // namespace

std::unique_ptr<Integrator> make_paper_fixed() {
  return make_one_by_one([] { return std::make_unique<PaperFixedIntegrator>(); });
}

}  // namespace weft::engine
