#pragma once
/// Private to integrators/: how hard `newton` works on a step.

#include "weft/integrators/integrator.h"
#include "weft/solvers/conjugate_gradients.h"

namespace weft {

struct Effort {
  int newton_steps = 1;       // that are always made [1]
  int most_newton_steps = 4;  // if the guard asks for more [1]
  CgSettings linear;
};

/// From the settings, and where they leave it open from how far a step lets waves run through the cloth: the
/// stiffness number a = h² Σk/m over the number of particles does not depend on the mesh.
Effort choose_effort(const NewtonSettings& settings, const ClothModel& model, double step);

}  // namespace weft
