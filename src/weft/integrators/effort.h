#pragma once
/// Private to integrators/: the solver budget of a `newton` step.

#include "weft/integrators/integrator.h"
#include "weft/solvers/conjugate_gradients.h"

namespace weft::engine {

struct Effort {
  int newton_steps = 1;       // minimum [1]
  int most_newton_steps = 8;  // maximum, at the guard's request [1]
  CgSettings free;            // budget of each Newton step without contact
  CgSettings in_contact;      // … and with contact
};

/// From the settings; values left open follow from the distance that waves travel through the cloth within a
/// step. `reach` is the mean of the stiffness number a = h² Σk/m, over the number of particles. It does not
/// depend on the mesh.
Effort choose_effort(const NewtonSettings& settings, double reach);

/// reach = h² · (this) [1/s²].
double compute_reach_rate(const ClothModel& model);

}  // namespace weft::engine
