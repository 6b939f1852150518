#pragma once
/// Internal forces of a cloth on its particles (num_particles) [N]: in double precision, from the pure
/// functions of forces/, whatever the cloth's integrator computes with.

#include <vector>

#include "weft/model/cloth_model.h"
#include "weft/model/cloth_state.h"

namespace weft {

/// Of springs with their strain limit, membranes, curvature stencils and hinges: minus the gradient of
/// compute_elastic_energy(). They sum to zero.
std::vector<Vec3> compute_elastic_forces(const ClothModel& model, const ClothState& state);

/// Damping of springs and elements at the state's positions and velocities. They sum to zero, and their power
/// Σ f·v is never positive.
std::vector<Vec3> compute_damping_forces(const ClothModel& model, const ClothState& state);

}  // namespace weft
