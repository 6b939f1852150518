#pragma once
/// Contacts for the solve, from constraints.

#include "weft/contact/contact.h"
#include "weft/contact/contact_memory.h"
#include "weft/contact/step_bodies.h"

namespace weft::engine {

/// The contact that an integrator gets for a constraint: relative to the origins of its cloths, with a stiffness
/// from inertia, the pressure of gas, and the force that lasted the last two steps.
Contact make_contact(const Constraint& c, const StepBodies& bodies, const ContactMemory& memory);

}  // namespace weft::engine
