#pragma once
/// Inertia, wind drag (forces/wind.h), and aerodynamic drag and lift (forces/air.h) as terms of an implicit step.

#include <memory>
#include <vector>

#include "weft/forces/motion.h"
#include "weft/forces/term.h"
#include "weft/forces/wind.h"
#include "weft/model/cloth_model.h"
#include "weft/model/cloth_state.h"

namespace weft::engine {

/// 1/(2h²) Σ m |x − y|². Pins have none. `target` is y, and outlives the term [m, s].
std::unique_ptr<Term> make_inertia_term(const ClothModel& model, const std::vector<int>& pinned,
                                        const std::vector<Vec3>& target, double step);

/// ½ h c_w Σ A |v − v_wind|²; null without drag.
std::unique_ptr<Term> make_wind_term(const ClothModel& model, const Wind& wind, const Motion& motion);

/// The air at the particles of a cloth. G of a particle is a third of those of its triangles.
struct ParticleAir {
  std::vector<Mat3> matrix;    // G (num_particles; empty without air) [N·s/m]
  std::vector<Vec3> velocity;  // of the air [m/s]
};

/// In a step from `state` that ends at a time [s].
ParticleAir find_air(const ClothModel& model, const ClothState& state, const Wind& wind, double time);

/// ½ h Σ uᵀ G u, u = v_air − v; null without air.
std::unique_ptr<Term> make_air_term(ParticleAir air, const Motion& motion);

}  // namespace weft::engine
