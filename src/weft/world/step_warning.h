#pragma once
/// What went wrong in a step, as data. run/warnings.h has the sentences.

#include <algorithm>
#include <vector>

#include "weft/world/step_check.h"

namespace weft {

enum class WarningCode {
  not_converged,    // the solver ran out of iterations before it reached its tolerance
  contact_skipped,  // the cloth moved by more than its own size within a step, and contact was left out
  non_finite,       // a position or velocity of `particle` became infinite: the step failed
  cap_reached,    // the step could not be divided further, and is too long still; `fault` and `value` say why
  yarn_strain,    // a spring or yarn stays longer than its limit; `value` is the strain [1]
  flat_triangle,  // a triangle has less than a tenth of its area; `value` is its share [1]
  energy_rise,    // energy has risen without work; `value` is by how much [J]
  crossings,      // pairs of triangles cross at the end; `value` is how many [1]
  passages,       // features went through each other between frames; `value` is how many [1]
  infeasible,     // prescribed motions left no room for pairs of features; `value` is how many [1]
};

struct StepWarning {
  WarningCode code = WarningCode::not_converged;
  int cloth = -1;                        // -1: none in particular
  int particle = -1;                     // likewise
  double value = 0;                      // see the code
  StepFault fault = StepFault::stretch;  // of cap_reached
};

/// A pair of features that prescribed motions have pushed through each other: a particle, and the other cloth
/// or the collider that the other feature belongs to.
struct InfeasiblePair {
  int cloth = -1,
      particle = -1;  // cloth -1: the feature is a collider's, and so is `collider` only if both are
  int other_cloth = -1, other_particle = -1, collider = -1;

  bool operator==(const InfeasiblePair&) const = default;
};

/// Lists a pair once.
inline void add_once(const InfeasiblePair& pair, std::vector<InfeasiblePair>& pairs) {
  if (std::find(pairs.begin(), pairs.end(), pair) == pairs.end()) pairs.push_back(pair);
}

}  // namespace weft
