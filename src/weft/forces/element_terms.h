#pragma once
/// A fabric's elements (model/cloth_elements.h) as terms: membranes ½ Σ A eᵀ C e (forces/membrane_patch.h), bending
/// ½ Σ k |c|² (forces/bending.h) or ½ Σ k θ² (forces/hinge.h), and their damping τ/(2h) Σ (A δeᵀ C δe + k δc²).
///
/// Damping acts on the change since the start of the step: δe = B (x − x₀), B the strain's derivative in the motion's
/// `shape`, and δc = ĉ·Σ w (x − x₀), the change of the curvature's length: both are zero for a rigid rotation. Hinges
/// are damped like stencils, by the change of their angle.
///
/// All are null for a cloth without them.

#include <memory>

#include "weft/forces/motion.h"
#include "weft/forces/term.h"
#include "weft/model/cloth_model.h"
#include "weft/model/cloth_state.h"

namespace weft::engine {

std::unique_ptr<Term> make_membrane_term(const ClothModel& model, const ClothState& state);

std::unique_ptr<Term> make_stencil_term(const ClothModel& model, const ClothState& state);

/// Both of its Hessians are that of Gauss and Newton, without the stress term of folded hinges.
std::unique_ptr<Term> make_hinge_term(const ClothModel& model, const ClothState& state);

std::unique_ptr<Term> make_element_damping_term(const ClothModel& model, const Motion& motion);

}  // namespace weft::engine
