#pragma once
/// Step results as data. Cloths and colliders are indices n of World::cloth(n) and World::collider(n).

#include <cstddef>
#include <optional>
#include <vector>

#include "weft/export.h"
#include "weft/ids.h"
#include "weft/vec.h"

namespace weft {

/// Why a step was too long. In brackets, the unit of the fault's value.
enum class StepFault {
  stretch,     // stretch increase of a structural spring, over its rest length [1]
  collapse,    // area loss of a triangle: the remaining area over that at rest [1]
  energy,      // rise of kinetic and potential energy without work [J]
  infeasible,  // prescribed motions that leave no room for a pair of features
  skipped,     // cloth moved by more than its own size, and contact was skipped
  non_finite,  // non-finite position or velocity
};

enum class WarningCode {
  not_converged,    // the solver reached its iteration limit before its tolerance
  contact_skipped,  // the cloth moved by more than its own size within a step, and contact was skipped
  non_finite,       // a position or velocity of `particle` is not finite: the step failed
  cap_reached,      // the step is too long, but cannot be divided further; see `fault` and `value`
  yarn_strain,      // a spring or yarn exceeds its limit; `value` is the strain [1]
  flat_triangle,    // a triangle has less than a tenth of its rest area; `value` is its share [1]
  energy_rise,      // energy has risen without work; `value` is the rise [J]
  crossings,        // pairs of triangles intersect at the end; `value` is their number [1]
  passages,         // features passed through each other between frames; `value` is their number [1]
  infeasible,       // prescribed motions left no room for pairs of features; `value` is their number [1]
  open_seam,        // a seam is open after its time; `value` is how far, at `particle` [m]
  penetration,      // cloth at `particle` is inside `collider` at the end; `value` is the depth [m]
};

struct StepWarning {
  WarningCode code = WarningCode::not_converged;
  int cloth = -1;                        // -1: no specific cloth
  int particle = -1;                     // -1: no specific particle
  double value = 0;                      // see the code
  StepFault fault = StepFault::stretch;  // of cap_reached
  int collider = -1;                     // of penetration
};

enum class InfeasibleKind {
  passed,  // prescribed motions have pushed the two through each other
  caught,  // a particle lies between colliders that overlap, of which `collider` is one
};

/// A pair of features that prescribed motions leave no room for: a particle, and the other feature's cloth or
/// collider.
struct InfeasiblePair {
  int cloth = -1;     // -1 only if both features are colliders'
  int particle = -1;  // of `cloth`
  int other_cloth = -1, other_particle = -1, collider = -1;
  InfeasibleKind kind = InfeasibleKind::passed;

  bool operator==(const InfeasiblePair&) const = default;
};

/// Wall time on the thread that calls World::step(). The kinds do not overlap; `total` less their sum is
/// springs and elements, vectors, copies. `rows` to `v_cycle` are of `newton` only.
struct WorkTimes {
  double total = 0;         // of whole steps [s]
  double lists = 0;         // broad phase: candidate pair lists [s]
  double narrow_phase = 0;  // distances of listed pairs and of primitive shapes, as constraints [s]
  double rows = 0;          // contacts in the solve: their linearisation and energy [s]
  double set_up = 0;        // preconditioners rebuilt for contacts [s]
  double product = 0;       // products of the contact Hessian with a vector, in conjugate gradients [s]
  double v_cycle = 0;       // preconditioners applied, with and without contact [s]
  double projection = 0;    // Gauss–Seidel on positions and velocities, before and after the solve [s]
  double ccd = 0;           // continuous collision detection without its pair lists [s]
  double retries = 0;       // all work of discarded parts of steps: not a separate kind [s]

  int pairs_listed = 0;           // in the longest list [1]
  std::size_t looks = 0;          // passes over all listed pairs [1]
  std::size_t pairs_tested = 0;   // in these passes, together [1]
  std::size_t active = 0;         // contacts with a force in the solve, or else projected; in all parts [1]
  std::size_t list_renewals = 0;  // broad phase queries, of all features or only of moved ones [1]

  double kinds() const { return lists + narrow_phase + rows + set_up + product + v_cycle + projection + ccd; }
  WEFT_API WorkTimes& operator+=(const WorkTimes& other);
};

struct StepReport {
  bool ok = true;  // false: the step failed, and every cloth has its state before the step
  std::vector<StepWarning> warnings = {};     // with ok = true: complete, but below the requested accuracy
  int substeps = 0;                           // of the cloth with the most [1]
  int divisions = 1;                          // parts of the divided step (StepDivision) [1]
  int retries = 0;                            // parts that were too long, and were repeated [1]
  std::optional<StepFault> fault = {};        // of the worst repeated part
  int iterations = 0;                         // of nonlinear solvers, over all cloths [1]
  std::optional<int> linear_iterations = {};  // of linear solvers inside them; empty without any [1]
  /// Of newton's linear solves, before the last iteration of each: the largest √(rᵀP⁻¹r) as a share of that at
  /// its start, with the residual r and the preconditioner P. Empty for other integrators [1].
  std::optional<double> residual = {};
  std::optional<int> guard_events = {};  // of newton's guard; empty for integrators without one [1]
  int hits = 0;   // pairs that reached the fail-safe, continuous collision detection [1]
  int zones = 0;  // its rigid impact zones [1]
  int torn = 0;   // cuts through vertices (Fabric::strength): particles and triangles have changed [1]
  std::vector<InfeasiblePair> infeasible = {};  // that prescribed motions leave no room for, once each
  WorkTimes work = {};                          // of all parts, including repeated ones
};

/// A contact of the last step.
struct ContactPoint {
  Vec3 position = {};  // [m]
  Vec3 normal = {};    // unit length, towards the cloth
  Vec3 force = {};     // on the cloth, friction included; the other side gets the opposite [N]
  ClothId cloth = {};
  int particle = 0;                         // nearest particle of the cloth
  std::optional<ClothId> other_cloth = {};  // the other body: this cloth, possibly the same, …
  std::optional<ColliderId> collider = {};  // … or this collider
  int other_vertex = -1;                    // its nearest particle or mesh vertex; -1: of a primitive shape
};

/// Strain of a triangle. Warp and weft are the fabric's; with springs, axes along and across the first edge.
struct TriangleStrain {
  double warp = 0, weft = 0;                // length over rest length − 1, along each [1]
  double shear = 0;                         // deviation of the warp–weft angle from 90° [rad]
  double min_stretch = 1, max_stretch = 1;  // extremes over all directions: length over rest length [1]
};

/// Energies of all cloths [J].
struct Energies {
  double kinetic = 0;
  double elastic = 0;  // of stretching and shearing, and of gas in closed cloth
  double bending = 0;
  double gravitational = 0;  // zero at the world's origin

  double total() const { return kinetic + elastic + bending + gravitational; }
};

/// Point on a cloth's surface.
struct SurfacePoint {
  ClothId cloth = {};
  int triangle = 0;
  Vec3 weights = {};    // of its corners, sum 1 [1]
  Vec3 position = {};   // [m]
  double distance = 0;  // from the ray's origin, or from the query point [m]
};

}  // namespace weft
