#pragma once
/// Private to integrators/: how hard `newton` works on a step.

#include "weft/integrators/integrator.h"
#include "weft/solvers/conjugate_gradients.h"

namespace weft::engine {

struct Effort {
  int newton_steps = 1;       // that are always made [1]
  int most_newton_steps = 8;  // if the guard asks for more [1]
  CgSettings free;            // of each Newton step without contact
  CgSettings in_contact;      // … and with contact
};

/// From the settings, and where they leave it open from how far waves run through the cloth within a step:
/// `reach` is the mean of the stiffness number a = h² Σk/m, over the number of particles. It does not depend
/// on the mesh.
Effort choose_effort(const NewtonSettings& settings, double reach);

/// reach = h² · (this) [1/s²].
double compute_reach_rate(const ClothModel& model);

}  // namespace weft::engine
