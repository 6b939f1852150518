#include "weft/integrators/common.h"

#include "weft/forces/terms.h"

namespace weft::engine {
namespace {

/// Adds external forces as velocities at the start of the step.
void add_external(const Environment& environment, double step, ClothState& state) {
  for (std::size_t i = 0; i < environment.acceleration.size(); ++i)
    state.v.set(i, state.v.get(i) + step * environment.acceleration[i]);
}

class OneByOne final : public Integrator {
 public:
  explicit OneByOne(std::function<std::unique_ptr<ClothIntegrator>()> make) : make_(std::move(make)) {
    cloths_.push_back(make_());
  }

  int num_substeps(const ClothModel& model, const Environment& environment, double step) const override {
    return cloths_[0]->num_substeps(model, environment, step);
  }

  IntegratorReport advance(std::span<const Body> bodies, std::span<Contact>, const SystemStep& step,
                           JobSystem& jobs) override {
    while (cloths_.size() < bodies.size()) cloths_.push_back(make_());
    IntegratorReport report;
    for (std::size_t b = 0; b < bodies.size(); ++b) {
      const Body& body = bodies[b];
      add_external(*body.environment, step.step, *body.state);
      const IntegratorReport done =
          cloths_[b]->advance(*body.model, *body.environment, step.step, jobs, *body.state);
      report.include(done, static_cast<int>(b));
    }
    return report;
  }

 private:
  std::function<std::unique_ptr<ClothIntegrator>()> make_;
  std::vector<std::unique_ptr<ClothIntegrator>> cloths_;
};

}  // namespace

std::unique_ptr<Integrator> make_one_by_one(std::function<std::unique_ptr<ClothIntegrator>()> make) {
  return std::make_unique<OneByOne>(std::move(make));
}

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

double free_share(const ClothModel& model, const ClothState& state, const std::vector<Vec3>& x,
                  const std::vector<int>& pinned, const Vec3& gravity) {
  const double gravity_sq = gravity.squaredNorm();
  if (pinned.empty() || gravity_sq == 0) return 1;
  std::vector<Vec3> force(x.size(), Vec3::Zero());
  add_forces(make_elastic_terms(model, state), x, force);
  double mass = 0, carried = 0;
  for (const int p : pinned) {
    mass -= model.mass[p];
    force[p].setZero();
  }
  for (int i = 0; i < model.num_particles(); ++i) {
    mass += model.mass[i];
    carried -= force[i].dot(gravity) / gravity_sq;
  }
  return mass > 0 ? std::clamp(1 - carried / mass, 0.0, 1.0) : 1.0;
}

}  // namespace weft::engine
