#pragma once
/// Private to integrators/: the solver budget of a `newton` step.

#include "weft/integrators/integrator.h"
#include "weft/solvers/conjugate_gradients.h"

namespace weft::engine {

struct SolverBudget {
  int newton_steps = 1;      // minimum [1]
  int max_newton_steps = 8;  // maximum, at the guard's request [1]
  CgSettings free;           // budget of each Newton step without contact
  CgSettings in_contact;     // … and with contact
};

/// From the settings; values left open follow from the distance that waves travel through the cloth within a
/// step. `stiffness_number` is the mean of the stiffness number a = h² Σk/m, over the number of particles. It
/// does not depend on the mesh.
SolverBudget choose_budget(const NewtonSettings& settings, double stiffness_number);

/// stiffness number = h² · (this) [1/s²].
double compute_stiffness_rate(const ClothModel& model);

}  // namespace weft::engine
