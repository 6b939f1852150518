#pragma once
/// Results of a step as data. Cloths and colliders are numbers n of World::cloth(n) and World::collider(n).

#include <cstddef>
#include <optional>
#include <vector>

#include "weft/export.h"
#include "weft/ids.h"
#include "weft/vec.h"

namespace weft {

/// Why a step was too long.
enum class StepFault {
  stretch,     // a structural spring has become longer, over its rest length [1]
  collapse,    // a triangle has lost area: what is left of it, over its area at rest [1]
  energy,      // kinetic and potential energy have risen without work [J]
  infeasible,  // prescribed motions left no room for a pair of features
  skipped,     // cloth moved by more than its own size, and contact was left out
  non_finite,  // a position or a velocity
};

enum class WarningCode {
  not_converged,    // the solver ran out of iterations before it reached its tolerance
  contact_skipped,  // the cloth moved by more than its own size within a step, and contact was left out
  non_finite,       // a position or velocity of `particle` became infinite: the step failed
  cap_reached,      // the step is too long, and cannot be divided further; `fault` and `value` say why
  yarn_strain,      // a spring or yarn stays longer than its limit; `value` is the strain [1]
  flat_triangle,    // a triangle has less than a tenth of its area; `value` is its share [1]
  energy_rise,      // energy has risen without work; `value` is by how much [J]
  crossings,        // pairs of triangles cross at the end; `value` is how many [1]
  passages,         // features went through each other between frames; `value` is how many [1]
  infeasible,       // prescribed motions left no room for pairs of features; `value` is how many [1]
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
  int cloth = -1;     // -1: the feature is a collider's, and so is `collider` only if both are
  int particle = -1;  // of `cloth`
  int other_cloth = -1, other_particle = -1, collider = -1;

  bool operator==(const InfeasiblePair&) const = default;
};

/// Wall time on the thread that calls World::step(). The kinds do not overlap; what `total` has beyond their
/// sum is springs and elements, vectors, copies. `rows` to `v_cycle` are of `newton` only.
struct WorkTimes {
  double total = 0;         // of whole steps [s]
  double lists = 0;         // broad phase: lists of pairs that may meet [s]
  double narrow_phase = 0;  // distances of listed pairs and of plain shapes, as constraints [s]
  double rows = 0;          // contacts in the solve: linearised, and their energy [s]
  double set_up = 0;        // preconditioners rebuilt for contacts [s]
  double product = 0;       // of contacts' Hessian with a vector, in conjugate gradients [s]
  double v_cycle = 0;       // preconditioners applied, with contact and without [s]
  double projection = 0;    // Gauss–Seidel over positions and velocities, after the solve and before [s]
  double ccd = 0;           // continuous collision detection without its lists [s]
  double retries = 0;       // parts of steps that were thrown away, all their work: no kind of its own [s]

  int pairs_listed = 0;          // in the longest list [1]
  std::size_t looks = 0;         // times that all listed pairs were tested [1]
  std::size_t pairs_tested = 0;  // in these [1]
  std::size_t active = 0;  // contacts that pushed in the solve, or else were set apart; of every part [1]
  std::size_t list_renewals = 0;  // searches for pairs, of all or of what had moved [1]

  double kinds() const { return lists + narrow_phase + rows + set_up + product + v_cycle + projection + ccd; }
  WEFT_API WorkTimes& operator+=(const WorkTimes& other);
};

struct StepReport {
  bool ok = true;  // false: the step failed, and every cloth is as it was before it
  std::vector<StepWarning> warnings =
      {};                               // with ok = true: the step was made, but less exactly than asked for
  int substeps = 0;                     // of the cloth that needed most [1]
  int divisions = 1;                    // parts that the step was divided into (StepDivision) [1]
  int retries = 0;                      // parts that were too long, and were taken again [1]
  std::optional<StepFault> fault = {};  // of the worst part that was taken again
  int iterations = 0;                   // of nonlinear solvers, all cloths [1]
  std::optional<int> linear_iterations = {};  // of linear solvers inside them; empty if there are none [1]
  std::optional<int> guard_events = {};       // of newton's guard; empty for integrators without one [1]
  int hits = 0;   // pairs left to the fail-safe, continuous collision detection [1]
  int zones = 0;  // rigid impact zones there [1]
  std::vector<InfeasiblePair> infeasible = {};  // pushed through each other by prescribed motions, once each
  WorkTimes work = {};                          // of all parts, also of those that were taken again
};

/// A place where a cloth touched something in the last step.
struct ContactPoint {
  Vec3 position = {};  // [m]
  Vec3 normal = {};    // unit length, towards the cloth
  Vec3 force = {};     // on the cloth, friction included; the other side gets the opposite [N]
  ClothId cloth = {};
  int particle = 0;                         // of the cloth, the nearest
  std::optional<ClothId> other_cloth = {};  // either this one, which may be the same cloth, …
  std::optional<ColliderId> collider = {};  // … or this one
  int other_vertex = -1;                    // nearest particle or mesh vertex there; -1: of a plain shape
};

/// Stretching of a triangle. Warp and weft are a fabric's; of springs, axes along the first edge and across it.
struct TriangleStrain {
  double warp = 0, weft = 0;                // length over rest length − 1, along each [1]
  double shear = 0;                         // angle by which warp and weft leave 90° [rad]
  double min_stretch = 1, max_stretch = 1;  // of any direction: length over that at rest [1]
};

/// Of all cloths [J].
struct Energies {
  double kinetic = 0;
  double elastic = 0;  // of stretching and shearing
  double bending = 0;
  double gravitational = 0;  // zero at the world's origin

  double total() const { return kinetic + elastic + bending + gravitational; }
};

/// Point of a cloth's surface.
struct SurfacePoint {
  ClothId cloth = {};
  int triangle = 0;
  Vec3 weights = {};    // of its corners, sum 1 [1]
  Vec3 position = {};   // [m]
  double distance = 0;  // from the ray's origin, or from the point asked about [m]
};

}  // namespace weft
