#pragma once
/// Finds the cloth that is caught between colliders, and holds it there (see caught_particles.h).

#include <span>
#include <vector>

#include "weft/contact/caught_particles.h"
#include "weft/contact/ccd_fail_safe.h"
#include "weft/contact/step_bodies.h"

namespace weft::engine {

/// Adds the particles that were caught in the step before, and still are.
void recall_caught(const StepBodies& bodies, CaughtParticles& caught);

/// Adds the particles that are caught from this step on: their constraints with colliders oppose each other, and
/// there is no room between. Returns whether there are any.
bool find_caught(const StepBodies& bodies, std::span<const Constraint> constraints, CaughtParticles& caught);

/// Appends the constraints that hold caught particles.
void add_caught_constraints(const StepBodies& bodies, const CaughtParticles& caught,
                            std::vector<Constraint>& constraints);

/// Stores the caught particles in the cloths' states. Returns those that are new, once for each of the
/// colliders that hold them.
std::vector<Infeasible> store_caught(const StepBodies& bodies, const CaughtParticles& caught);

}  // namespace weft::engine
