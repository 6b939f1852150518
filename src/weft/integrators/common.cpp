#include "weft/integrators/common.h"

namespace weft {

void Weights::fit(const ClothModel& model, double step) {
  if (model.id == model_id_ && step == step_) return;
  model_id_ = model.id;
  step_ = step;
  mass_ = to_padded_floats(model.mass);
  std::vector<double> weight(model.mass.size());
  for (std::size_t i = 0; i < weight.size(); ++i)
    weight[i] = 1 / (model.mass[i] + step * step * model.stiffness_sum[i]);
  weight_ = to_padded_floats(weight);
}

void PinMotion::prepare(const PinTargets& pins, double step, const ClothState& state) {
  velocity_.resize(pins.particle.size());
  for (std::size_t p = 0; p < velocity_.size(); ++p) {
    velocity_[p] = (pins.position[p] - state.position(pins.particle[p])) / step;
  }
}

void PinMotion::finish(const PinTargets& pins, ClothState& state) const {
  for (std::size_t p = 0; p < velocity_.size(); ++p) {
    state.v.set(pins.particle[p], velocity_[p]);
    state.set_position(pins.particle[p], pins.position[p]);
  }
}

IncrementSettings make_increment_settings(const ClothModel& model, const Environment& environment,
                                          double step) {
  IncrementSettings settings;
  settings.step = static_cast<float>(step);
  settings.damping = static_cast<float>(model.material.damping);
  settings.projected = model.material.damping_kind == DampingKind::projected;
  settings.wind_rate = static_cast<float>(environment.wind.drag / model.material.density);
  settings.wind_velocity = environment.wind.velocity;
  return settings;
}

}  // namespace weft
