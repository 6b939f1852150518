/// XPBD with small steps, as in most engines: the baseline for `newton`. xpbd_projection.h describes the
/// method and its source, xpbd_elements.h the method for fabrics.

#include "weft/forces/seam_springs.h"
#include "weft/forces/terms.h"
#include "weft/integrators/common.h"
#include "weft/integrators/xpbd_projection.h"

namespace weft::engine {
namespace {

class XpbdIntegrator final : public ClothIntegrator {
 public:
  explicit XpbdIntegrator(const XpbdSettings& settings) : settings_(settings) {}

  int num_substeps(const ClothModel&, const Environment&, double) const override {
    return settings_.substeps;
  }

  IntegratorReport advance(const ClothModel& model, const Environment& environment, double step,
                           JobSystem& jobs, ClothState& state) override {
    fit(model, environment.pins);
    advance_memory(model, step, state);
    const XpbdSubstep substep = make_substep(model, environment, step, state);
    pin_motion_.prepare(environment.pins, step, state);
    cloth_->predict(substep, jobs, state);
    for (std::size_t p = 0; p < pinned_.size(); ++p) {
      cloth_->move_to(pinned_[p], environment.pins.position[p] - state.origin,
                      step * pin_motion_.velocity()[p]);
    }
    cloth_->project(substep, jobs);
    cloth_->finish(substep, jobs, state);
    pin_motion_.finish(environment.pins, state);
    return {};
  }

 private:
  /// Identity of a projection; numbers may change without a new one.
  struct Layout {
    std::shared_ptr<const ClothTopology> topology;
    std::shared_ptr<const ClothElements> elements;
    bool is_grid = false;

    bool operator==(const Layout&) const = default;
  };

  /// Whether the springs of each kind are all equal, and there are no other forces. Grids have neither seams nor gas.
  static bool is_grid_of_equals(const ClothModel& model) {
    return model.has_equal_springs() && !model.elements && !model.material.structural_z &&
           model.material.damping_time == 0;
  }

  void fit(const ClothModel& model, const PinTargets& pins) {
    if (model.id == model_id_ && pins.particle == pinned_) return;
    const Layout layout{model.topology, model.elements, is_grid_of_equals(model)};
    if (layout != layout_) {
      layout_ = layout;
      cloth_ = layout.is_grid ? make_grid_projection(*model.topology) : make_mesh_projection(model);
    }
    model_id_ = model.id;
    pinned_ = pins.particle;
    cloth_->set_numbers(model, pinned_);
  }

  static XpbdSubstep make_substep(const ClothModel& model, const Environment& environment, double step,
                                  const ClothState& state) {
    const double wind = step * environment.wind.drag / model.material.density, drag_factor = 1 / (1 + wind);
    const Vec3 velocity_gain = drag_factor * (step * environment.gravity + wind * environment.wind.velocity);
    return {.step = static_cast<float>(step),
            .drag_factor = static_cast<float>(drag_factor),
            .velocity_gain = velocity_gain.cast<float>(),
            .is_projected = model.material.damping_kind == DampingKind::projected,
            .seam_opening = seam_opening(model, state),
            .gas = model.gas};
  }

  XpbdSettings settings_;
  std::uint64_t model_id_ = 0;
  Layout layout_;
  std::vector<int> pinned_;
  std::unique_ptr<ClothProjection> cloth_;
  PinMotion pin_motion_;
};

}  // namespace

std::unique_ptr<Integrator> make_xpbd(const XpbdSettings& settings) {
  return make_one_by_one([=] { return std::make_unique<XpbdIntegrator>(settings); });
}

}  // namespace weft::engine
