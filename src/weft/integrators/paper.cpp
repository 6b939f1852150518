/// The paper's "modified implicit" integration, Eq. 16 as printed.
///
///     Δv_j ≈ h F_j / (m_j + h² Σ_l k_jl)                                        (15)
///     Δv_i = (h F_i + h² Σ_j k_ij Δv_j) / (m_i + h² Σ_j k_ij)                    (14, 16)
///
/// No linear system is solved: this is exactly two Jacobi sweeps from Δv = 0 on Eq. 12 without its term
/// h·H·v. All forces, gravity included, go through this filter, and pinned neighbours count as free ones do.

#include "weft/integrators/common.h"

namespace weft::engine {
namespace {

class PaperIntegrator final : public ClothIntegrator {
 public:
  explicit PaperIntegrator(const PaperSettings& settings) : settings_(settings) {}

  IntegratorReport advance(const ClothModel& model, const Environment& environment, double step,
                           JobSystem& jobs, ClothState& state) override {
    weights_.fit(model, step);
    pins_.prepare(environment.pins, step, state);
    IncrementSettings settings = make_increment_settings(model, environment, step);
    settings.acceleration = environment.gravity;
    if (settings_.printed_damping_sign) settings.damping = -settings.damping;
    compute_increments(model, state, settings, weights_.mass(), weights_.weight(), jobs, increments_);
    apply_filtered_increments(model, increments_, settings.step, weights_.weight(), {}, jobs, state);
    pins_.finish(environment.pins, state);
    return {};
  }

 private:
  PaperSettings settings_;
  Weights weights_;
  PinMotion pins_;
  IncrementField increments_;
};

}  // namespace

std::unique_ptr<Integrator> make_paper(const PaperSettings& settings) {
  return make_one_by_one([=] { return std::make_unique<PaperIntegrator>(settings); });
}

}  // namespace weft::engine
