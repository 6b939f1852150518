#include "weft/world/world.h"

#include <algorithm>
#include <cmath>

#include "weft/contact/response.h"
#include "weft/core/error.h"
#include "weft/core/hash.h"

namespace weft {
namespace {

void require(bool condition, const std::string& sentence) {
  if (!condition) throw InputError(sentence);
}

void validate(const ClothMaterial& m, const std::string& cloth) {
  const auto at_least_zero = [&](double value, const char* name) {
    require(std::isfinite(value) && value >= 0, "cloth \"" + cloth + "\": " + name + " must be 0 or more");
  };
  require(std::isfinite(m.density) && m.density > 0,
          "cloth \"" + cloth + "\": density must be more than 0 kg/m²");
  at_least_zero(m.structural, "structural stiffness");
  at_least_zero(m.shear, "shear stiffness");
  at_least_zero(m.bend, "bending stiffness");
  at_least_zero(m.damping, "damping");
  at_least_zero(m.thickness, "thickness");
  at_least_zero(m.friction, "friction");
}

/// A sum of products with zero: 0 if all values are finite, else not a number.
float finite_check(const float* values, std::size_t count) {
  constexpr std::size_t kLanes = 16;
  float sums[kLanes] = {};
  for (std::size_t i = 0; i + kLanes <= count; i += kLanes) {
    for (std::size_t lane = 0; lane < kLanes; ++lane) sums[lane] += 0.0f * values[i + lane];
  }
  float sum = 0;
  for (const float s : sums) sum += s;
  for (std::size_t i = count - count % kLanes; i < count; ++i) sum += 0.0f * values[i];
  return sum;
}

bool is_finite(const Vec3Array& a) {
  return finite_check(a.x(), a.size()) == 0 && finite_check(a.y(), a.size()) == 0 &&
         finite_check(a.z(), a.size()) == 0;
}

/// Index of the first particle whose position or velocity is not finite, -1 if all are.
int find_non_finite(const ClothState& state) {
  if (is_finite(state.x) && is_finite(state.v)) return -1;
  for (std::size_t i = 0; i < state.x.size(); ++i) {
    if (!state.x.get(i).allFinite() || !state.v.get(i).allFinite()) return static_cast<int>(i);
  }
  return -1;
}

std::string advice(const std::string& integrator) {
  if (integrator == "explicit")
    return "raise solver.explicit.substeps (0 chooses them), or soften the springs";
  if (integrator == "implicit_euler") return "raise solver.steps_per_frame";
  return "raise solver.steps_per_frame or lower the damping, which this integrator treats explicitly";
}

}  // namespace

World::World() : jobs_(make_serial_jobs()) {}

World::Cloth& World::at(ClothId id) { return cloths_.at(static_cast<std::size_t>(id.index)); }
const World::Cloth& World::at(ClothId id) const { return cloths_.at(static_cast<std::size_t>(id.index)); }

ClothId World::add_cloth(const ClothDesc& desc) {
  require(desc.topology != nullptr, "cloth \"" + desc.name + "\" has no topology");
  validate(desc.material, desc.name);
  const std::vector<Vec3>& positions =
      desc.positions.empty() ? desc.topology->mesh.positions : desc.positions;
  require(static_cast<int>(positions.size()) == desc.topology->num_particles(),
          "cloth \"" + desc.name + "\" has " + std::to_string(desc.topology->num_particles()) +
              " particles but " + std::to_string(positions.size()) + " positions");
  Cloth cloth;
  cloth.name = desc.name;
  cloth.model = build_cloth_model(desc.topology, desc.material);
  cloth.state = make_state(positions);
  for (std::size_t i = 0; i < positions.size(); ++i) cloth.state.v.set(i, desc.velocity);
  require(find_non_finite(cloth.state) < 0,
          "cloth \"" + desc.name + "\" has a position that is not a finite number");
  cloth.is_pinned.assign(positions.size(), 0);
  cloth.integrator = make_integrator(integrator_settings_);
  cloths_.push_back(std::move(cloth));
  return {num_cloths() - 1};
}

void World::set_pins(ClothId id, std::vector<Pin> pins) {
  Cloth& cloth = at(id);
  std::vector<char> is_pinned(cloth.state.x.size(), 0);
  std::vector<PinnedParticle> pinned;
  for (int p = 0; p < static_cast<int>(pins.size()); ++p) {
    for (const int i : pins[p].particles) {
      require(i >= 0 && i < cloth.model->num_particles(), "cloth \"" + cloth.name + "\" has no particle " +
                                                              std::to_string(i) + " to pin; it has " +
                                                              std::to_string(cloth.model->num_particles()));
      require(!is_pinned[i],
              "cloth \"" + cloth.name + "\": particle " + std::to_string(i) + " is pinned twice");
      is_pinned[i] = 1;
      pinned.push_back({i, p, cloth.state.position(i)});
    }
  }
  std::sort(pinned.begin(), pinned.end(),
            [](const auto& a, const auto& b) { return a.particle < b.particle; });
  cloth.pins = std::move(pins);
  cloth.pinned = std::move(pinned);
  cloth.is_pinned = std::move(is_pinned);
}

void World::set_material(ClothId id, const ClothMaterial& material) {
  Cloth& cloth = at(id);
  validate(material, cloth.name);
  cloth.model = build_cloth_model(cloth.model->topology, material);
}

void World::set_integrator(const IntegratorSettings& settings) {
  make_integrator(settings);  // throws before anything has changed
  integrator_settings_ = settings;
  for (Cloth& cloth : cloths_) cloth.integrator = make_integrator(settings);
}

void World::aim_pins(const Cloth& cloth, double time) {
  poses_.clear();
  for (const Pin& pin : cloth.pins) poses_.push_back(pin.motion.at(time));
  PinTargets& targets = environment_.pins;
  targets.particle.clear();
  targets.position.clear();
  for (const PinnedParticle& p : cloth.pinned) {
    targets.particle.push_back(p.particle);
    targets.position.push_back(apply(poses_[p.pin], cloth.pins[p.pin].pivot, p.anchor));
  }
}

void World::advance(Cloth& cloth, double dt, StepReport& report) {
  const ClothModel& model = *cloth.model;
  const bool touches = contact_ && !colliders_.empty();
  const int substeps = cloth.integrator->num_substeps(model, environment_, dt);
  const double h = dt / substeps;
  bool converged = true;
  for (int s = 1; s <= substeps; ++s) {
    const double now = time_ + dt * s / substeps;
    // What moves by prescription.
    aim_pins(cloth, now);
    if (touches)
      contact_response_.begin_step(colliders_, {.gap = model.material.thickness / 2, .time = now, .step = h});
    // What is in the cloth's way.
    environment_.contacts.clear();
    if (touches && cloth.integrator->resolves_contacts()) {
      contact_response_.find_contacts(environment_.gravity, model.mass, cloth.is_pinned, cloth.state,
                                      environment_.contacts);
    }
    // The cloth's own motion.
    const IntegratorReport done = cloth.integrator->advance(model, environment_, h, *jobs_, cloth.state);
    report.iterations += done.iterations;
    converged &= done.converged;
    // What has come too close all the same.
    if (touches) contact_response_.hold_off(cloth.is_pinned, *jobs_, cloth.state);
  }
  follow_cloth(cloth.state);
  report.substeps = std::max(report.substeps, substeps);
  if (!converged) {
    report.troubles.push_back({cloth.name, -1,
                               "the solver ran out of iterations before it reached its tolerance; raise "
                               "solver.iterations or solver.steps_per_frame"});
  }
}

StepReport World::step(double dt) {
  if (!std::isfinite(dt) || dt <= 0)
    throw InputError("the time step must be a finite number of seconds above 0");
  StepReport report;
  save(before_);
  for (Cloth& cloth : cloths_) {
    advance(cloth, dt, report);
    const int broken = find_non_finite(cloth.state);
    if (broken < 0) continue;
    report.ok = false;
    report.troubles.push_back({cloth.name, broken,
                               "the motion of particle " + std::to_string(broken) + " became infinite; " +
                                   advice(integrator_settings_.integrator)});
    restore(before_);
    return report;
  }
  time_ += dt;
  return report;
}

void World::save(Snapshot& snapshot) const {
  snapshot.time = time_;
  snapshot.states.resize(cloths_.size());
  for (std::size_t c = 0; c < cloths_.size(); ++c) snapshot.states[c] = cloths_[c].state;
}

World::Snapshot World::snapshot() const {
  Snapshot snapshot;
  save(snapshot);
  return snapshot;
}

void World::restore(const Snapshot& snapshot) {
  require(snapshot.states.size() == cloths_.size(),
          "the snapshot has another number of cloths than the world");
  for (std::size_t c = 0; c < cloths_.size(); ++c) {
    require(snapshot.states[c].x.size() == cloths_[c].state.x.size(),
            "the snapshot's cloth \"" + cloths_[c].name + "\" has another number of particles");
  }
  time_ = snapshot.time;
  for (std::size_t c = 0; c < cloths_.size(); ++c) cloths_[c].state = snapshot.states[c];
}

std::uint64_t World::state_hash() const {
  Hash hash;
  hash.add(time_);
  for (const Cloth& cloth : cloths_) add_to_hash(cloth.state, hash);
  return hash.value();
}

}  // namespace weft
