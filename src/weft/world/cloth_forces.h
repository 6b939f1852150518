#pragma once
/// Forces of a cloth, and of wind, on its particles (num_particles) [N]: in double precision, by the terms of
/// forces/terms.h, independent of the integrator's precision.

#include <vector>

#include "weft/forces/wind.h"
#include "weft/model/cloth_model.h"
#include "weft/model/cloth_state.h"

namespace weft::engine {

/// All elastic forces: minus the gradient of compute_elastic_energy(). They sum to zero.
std::vector<Vec3> compute_elastic_forces(const ClothModel& model, const ClothState& state);

/// Damping forces of springs and elements at the state's positions and velocities. They sum to zero, and
/// their power Σ f·v is never positive.
std::vector<Vec3> compute_damping_forces(const ClothModel& model, const ClothState& state);

/// Forces of wind drag, and of aerodynamic drag and lift, in a step from `before` to `after` that ends
/// at `time`. For a single time pass the same state twice.
std::vector<Vec3> compute_wind_forces(const ClothModel& model, const ClothState& before,
                                      const ClothState& after, const Wind& wind, double time);

}  // namespace weft::engine
