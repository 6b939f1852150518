#pragma once
/// Springs (forces/spring.h) and their damping (forces/damping.h) as terms.

#include <memory>

#include "weft/forces/motion.h"
#include "weft/forces/term.h"
#include "weft/model/cloth_model.h"
#include "weft/model/cloth_state.h"

namespace weft::engine {

/// Structural and shear springs, with the strain limit of those that replace membranes.
std::unique_ptr<Term> make_stretch_spring_term(const ClothModel& model, const ClothState& state);

std::unique_ptr<Term> make_bend_spring_term(const ClothModel& model, const ClothState& state);

/// Projected damping acts along the spring in the motion's `shape`: the potential stays quadratic.
std::unique_ptr<Term> make_spring_damping_term(const ClothModel& model, const Motion& motion);

}  // namespace weft::engine
