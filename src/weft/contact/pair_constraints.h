#pragma once
/// Narrow phase of cloth and meshes: constraints of vertex–triangle and edge–edge pairs.

#include <vector>

#include "weft/contact/caught_particles.h"
#include "weft/contact/contact_memory.h"
#include "weft/contact/step_bodies.h"
#include "weft/core/job_system.h"

namespace weft::engine {

struct PairInput {
  const StepBodies& bodies;
  const Proximity& lists;         // of candidates
  const CaughtParticles& caught;  // have no pairs with what holds them
  const ContactMemory& memory;    // pairs that pressed each other stay in the solve
  Purpose purpose;
};

/// Appends the constraints of all pairs that are near, or pass through each other, in the order of the lists.
/// `chunks` is work space.
void generate_pair_constraints(const PairInput& input, JobSystem& jobs,
                               std::vector<std::vector<Constraint>>& chunks,
                               std::vector<Constraint>& constraints);

}  // namespace weft::engine
