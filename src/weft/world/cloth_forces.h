#pragma once
/// Forces of a cloth, and of wind, on its particles (num_particles) [N]: in double precision, from the pure
/// functions of forces/, whatever the cloth's integrator computes with.

#include <vector>

#include "weft/forces/wind.h"
#include "weft/model/cloth_model.h"
#include "weft/model/cloth_state.h"

namespace weft::engine {

/// Of springs with their strain limit, membranes, collapse, curvature stencils and hinges: minus the gradient of
/// compute_elastic_energy(). They sum to zero.
std::vector<Vec3> compute_elastic_forces(const ClothModel& model, const ClothState& state);

/// Damping of springs and elements at the state's positions and velocities. They sum to zero, and their power
/// Σ f·v is never positive.
std::vector<Vec3> compute_damping_forces(const ClothModel& model, const ClothState& state);

/// Of the wind's drag and the air's drag and lift, in a step from `before` to `after` that ends at `time`, or at a
/// moment, which is both.
std::vector<Vec3> compute_wind_forces(const ClothModel& model, const ClothState& before,
                                      const ClothState& after, const Wind& wind, double time);

}  // namespace weft::engine
