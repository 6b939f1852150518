/// XPBD with small steps, as most engines have it: the peer that `newton` is measured against. The method and
/// its source are in xpbd_projection.h.

#include "weft/core/error.h"
#include "weft/integrators/common.h"
#include "weft/integrators/xpbd_projection.h"

namespace weft {
namespace {

class XpbdIntegrator final : public Integrator {
 public:
  explicit XpbdIntegrator(const XpbdSettings& settings) : settings_(settings) {}

  int num_substeps(const ClothModel&, const Environment&, double) const override {
    return settings_.substeps;
  }

  IntegratorReport advance(const ClothModel& model, const Environment& environment, double step,
                           JobSystem& jobs, ClothState& state) override {
    fit(model, environment.pins);
    const XpbdSubstep substep = make_substep(model, environment, step);
    pin_motion_.prepare(environment.pins, step, state);
    springs_->predict(substep, jobs, state);
    for (std::size_t p = 0; p < pinned_.size(); ++p) {
      springs_->move_to(pinned_[p], environment.pins.position[p] - state.origin,
                        step * pin_motion_.velocity()[p]);
    }
    springs_->project(substep, jobs);
    springs_->finish(substep, jobs, state);
    pin_motion_.finish(environment.pins, state);
    return {};
  }

 private:
  void fit(const ClothModel& model, const PinTargets& pins) {
    if (model.id == model_id_ && pins.particle == pinned_) return;
    if (model.elements)
      throw InputError("xpbd knows springs alone, no membranes: use newton or implicit_euler");
    if (model.topology != topology_ || model.has_equal_springs() != has_equal_springs_) {
      topology_ = model.topology;
      has_equal_springs_ = model.has_equal_springs();
      springs_ = has_equal_springs_ ? make_grid_projection(*topology_) : make_mesh_projection(*topology_);
    }
    model_id_ = model.id;
    pinned_ = pins.particle;
    springs_->set_numbers(model, pinned_);
  }

  static XpbdSubstep make_substep(const ClothModel& model, const Environment& environment, double step) {
    const double wind = step * environment.wind.drag / model.material.density, keep = 1 / (1 + wind);
    const Vec3 gain = keep * (step * environment.gravity + wind * environment.wind.velocity);
    return {.step = static_cast<float>(step),
            .keep = static_cast<float>(keep),
            .gain = gain.cast<float>(),
            .damping = static_cast<float>(model.material.damping),
            .is_projected = model.material.damping_kind == DampingKind::projected};
  }

  XpbdSettings settings_;
  std::uint64_t model_id_ = 0;
  std::shared_ptr<const ClothTopology> topology_;
  bool has_equal_springs_ = false;
  std::vector<int> pinned_;
  std::unique_ptr<SpringProjection> springs_;
  PinMotion pin_motion_;
};

}  // namespace

std::unique_ptr<Integrator> make_xpbd(const XpbdSettings& settings) {
  return std::make_unique<XpbdIntegrator>(settings);
}

}  // namespace weft
