#pragma once
/// Extreme random scenes for robustness tests of integrators.

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "lab/accuracy/hung_cloth.h"
#include "weft/core/random.h"
#include "weft/world/measures.h"

namespace weft::engine::lab {

/// Stiffness 1 to 10⁶ N/m, 0.01 to 10 kg/m², steps of 1/1000 to 1/15 s, all log-uniform. 1 to 20 cells each
/// way, as a grid of any model or a mesh. Damping in half of the scenes, noise of up to 0.3 cells in half of
/// them. 0 to 3 pinned particles. A seed gives the same scene on every machine.
struct RandomScene {
  HungCloth cloth;
  double step = 0;  // [s]

  double energy() const {
    return compute_kinetic_energy(*cloth.model, cloth.state) +
           compute_elastic_energy(*cloth.model, cloth.state) + height_energy();
  }
  double height_energy() const {
    return compute_gravity_energy(*cloth.model, cloth.state, cloth.environment.gravity);
  }

  /// Vertical speed of the centre of mass [m/s].
  double vertical_speed() const {
    double mass = 0;
    for (const double m : cloth.model->mass) mass += m;
    return compute_momentum(*cloth.model, cloth.state).y() / mass;
  }
};

inline RandomScene make_random_scene(std::uint64_t seed) {
  Random random(seed);
  const auto between = [&](double low, double high) {
    return low * std::pow(high / low, random.uniform(0, 1));
  };
  const int cells_x = 1 + static_cast<int>(random.uniform(0, 20));
  const int cells_z = 1 + static_cast<int>(random.uniform(0, 20));
  const Grid grid{.cells_x = cells_x, .cells_z = cells_z};
  const int kind = static_cast<int>(random.uniform(0, 4));
  const SpringModel models[] = {SpringModel::basic, SpringModel::simplified, SpringModel::alternating};
  const auto topology = kind < 3 ? build_grid_topology(grid, models[kind])
                                 : build_mesh_topology(build_grid_mesh(grid, GridDiagonals::alternating));
  const double k = between(1, 1e6);
  ClothMaterial material{.density = between(0.01, 10), .structural = k, .shear = k / 2, .bend = k / 100};
  if (random.uniform(0, 1) < 0.5) material.damping = between(1e-4, 1) * std::sqrt(k) * 1e-2;
  if (random.uniform(0, 1) < 0.5) material.damping_kind = DampingKind::plain;
  RandomScene scene;
  HungCloth& cloth = scene.cloth;
  cloth.name = "seed " + std::to_string(seed);
  cloth.model = build_cloth_model(topology, material);
  scene.step = between(1e-3, 1.0 / 15);
  cloth.state = make_state(topology->mesh.positions);
  const double cell = std::min(grid.spacing_x(), grid.spacing_z());
  if (random.uniform(0, 1) < 0.5) {
    const double noise = random.uniform(0, 0.3) * cell;
    Random shaking(seed);
    const auto by = [&](double size) {
      return Vec3{shaking.uniform(-size, size), shaking.uniform(-size, size), shaking.uniform(-size, size)};
    };
    for (std::size_t i = 0; i < cloth.state.x.size(); ++i) {
      cloth.state.x.set(i, cloth.state.x.get(i) + by(noise));
      cloth.state.v.set(i, cloth.state.v.get(i) + by(0.1));
    }
  }
  const int num_pins = static_cast<int>(random.uniform(0, 4));
  PinTargets& pins = cloth.environment.pins;
  for (int p = 0; p < num_pins; ++p) {
    const int i = static_cast<int>(random.uniform(0, cloth.model->num_particles()));
    if (!pins.particle.empty() && i <= pins.particle.back()) continue;
    pins.particle.push_back(i);
    pins.position.push_back(cloth.state.position(i));
  }
  return scene;
}

}  // namespace weft::engine::lab
