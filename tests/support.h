#pragma once
/// Shared test helpers: small cloths, chains, random motion, energy.

#include <cmath>
#include <memory>
#include <vector>

#include "weft/core/random.h"
#include "weft/integrators/integrator.h"
#include "weft/model/cloth_model.h"
#include "weft/model/cloth_state.h"
#include "weft/world/measures.h"
#include "weft/world/world.h"

namespace weft::engine::test {

inline Vec3 random_vector(Random& random, double size) {
  return {random.uniform(-size, size), random.uniform(-size, size), random.uniform(-size, size)};
}

/// A square grid of the given cells and size.
inline Grid square(int cells, double size = 1) {
  return {.size_x = size, .size_z = size, .cells_x = cells, .cells_z = cells};
}

/// The grid's cloth as a triangle mesh: same particles, springs on every edge.
inline std::shared_ptr<const ClothTopology> mesh_of(const Grid& grid) {
  return build_mesh_topology(build_grid_mesh(grid, GridDiagonals::alternating));
}

/// Adds random displacements and velocities, the same for every call.
inline void shake(ClothState& state, double displacement, double speed, std::uint64_t seed = 1) {
  Random random(seed);
  for (std::size_t i = 0; i < state.x.size(); ++i) {
    state.x.set(i, state.x.get(i) + random_vector(random, displacement));
    state.v.set(i, state.v.get(i) + random_vector(random, speed));
  }
}

/// A chain of particles at the given positions, each of the given mass (density 1), joined by structural
/// springs of the given rest length.
inline std::shared_ptr<const ClothTopology> chain(const std::vector<Vec3>& places, double mass,
                                                  double rest_length) {
  auto topology = std::make_shared<ClothTopology>();
  topology->mesh.positions = places;
  topology->area.assign(places.size(), mass);
  for (int i = 0; i + 1 < static_cast<int>(places.size()); ++i) {
    topology->springs.push_back({i, i + 1, SpringKind::structural, rest_length});
  }
  topology->table = build_neighbour_table(topology->num_particles(), topology->springs);
  return topology;
}

/// Kinetic, elastic and gravitational energy of the first cloth [J].
inline double energy_of(const World& world) {
  const ClothModel& model = world.model(world.cloth(0));
  const ClothState& state = world.state(world.cloth(0));
  return compute_kinetic_energy(model, state) + compute_elastic_energy(model, state) +
         compute_gravity_energy(model, state, world.gravity());
}

/// Steps an integrator without a world: no substeps, no contact.
inline void advance(Integrator& integrator, const ClothModel& model, const Environment& environment,
                    double step, int num_steps, ClothState& state) {
  const auto jobs = make_serial_jobs();
  for (int s = 0; s < num_steps; ++s) integrator.advance(model, environment, step, *jobs, state);
}

inline std::unique_ptr<Integrator> integrator(std::string_view name) {
  return make_integrator({.integrator = std::string(name)});
}

/// A cloth hung by the two corners of its first row, released horizontally.
struct Hung {
  std::shared_ptr<const ClothModel> model;
  ClothState state;
  Environment environment;

  Hung(const std::shared_ptr<const ClothTopology>& topology, int cells, const ClothMaterial& material = {})
      : model(build_cloth_model(topology, material)), state(make_state(topology->mesh.positions)) {
    for (const int i : {0, cells}) {
      environment.pins.particle.push_back(i);
      environment.pins.position.push_back(state.position(i));
    }
  }

  /// Advances by a sixtieth of a second in equal steps.
  void advance_frame(Integrator& integrator, int num_steps) {
    advance(integrator, *model, environment, 1.0 / 60 / num_steps, num_steps, state);
  }
};

inline double rms_distance(const ClothState& a, const ClothState& b) {
  double sum = 0;
  for (std::size_t i = 0; i < a.x.size(); ++i) sum += (a.position(i) - b.position(i)).squaredNorm();
  return std::sqrt(sum / static_cast<double>(a.x.size()));
}

}  // namespace weft::engine::test
