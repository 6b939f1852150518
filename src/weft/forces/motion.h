#pragma once
/// What an implicit step of a cloth knows of its motion, for terms that depend on velocity.

#include <vector>

#include "weft/core/vec.h"

namespace weft::engine {

/// Velocities are (x − start)/step. Damping at x is that of `shape`: start, or for second order the prediction. Both
/// outlive the terms (num_particles) [m, s].
struct Motion {
  const std::vector<Vec3>& start;
  const std::vector<Vec3>& shape;
  double step;

  Vec3 velocity(const std::vector<Vec3>& x, int i) const { return (x[i] - start[i]) / step; }
};

}  // namespace weft::engine
