#pragma once
/// The bodies of a step as the repair of intersecting starts takes them (see untangle.h).

#include <vector>

#include "weft/contact/step_bodies.h"
#include "weft/contact/untangle.h"

namespace weft::engine {

/// The result refers to `bodies`.
RepairInput make_repair_input(const StepBodies& bodies);

/// Positions of cloth at the start of the step, and of colliders at its end [m].
std::vector<Vec3> positions_now(const StepBodies& bodies);

}  // namespace weft::engine
