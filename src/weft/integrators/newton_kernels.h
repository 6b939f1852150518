#pragma once
/// Private to integrators/: per-particle kernels of `newton` before and after its solve.

#include "weft/core/job_system.h"
#include "weft/core/padded_rows.h"
#include "weft/model/cloth_state.h"

namespace weft::engine {

/// A step of BDF2, or of implicit Euler (memory 0, beta 1), as a ballistic prediction without springs:
///
///     v ← drag_factor (v + memory (v − v₋₁)) + velocity_gain,   s ← memory s + (h/β) v,   y = x + s
///
/// where s is the displacement of the step. The result d of the solve then corrects both: v += (β/h) d, s +=
/// d, x += s. So x never enters a difference, and free fall is exact to rounding.
struct StepScheme {
  double step = 0;                    // h [s]
  double beta = 1;                    // β: x'' = (β/h)² (x − …) [1]
  double memory = 0;                  // weight of the change in the last step [1]
  double drag_factor = 1;             // drag factor: share of velocity that wind leaves [1]
  Vec3 velocity_gain = Vec3::Zero();  // velocity gain from gravity and wind [m/s]
};

/// BDF2 for a step of size `step` after one of size `step_before`.
StepScheme make_bdf2(double step, double step_before);

/// Predicts: state.v and the history's displacement become the predicted ones, the history's velocity that at
/// the start; y is laid out by `rows`.
void predict(const StepScheme& scheme, const PaddedRows& rows, JobSystem& jobs, ClothState& state,
             Vec3Array& y);

/// Corrects the predicted velocities, displacements and positions by d.
void correct(const StepScheme& scheme, const PaddedRows& rows, const Vec3Array& d, JobSystem& jobs,
             ClothState& state);

/// x = y + share · d.
void add_scaled(const Vec3Array& y, double share, const Vec3Array& d, JobSystem& jobs, Vec3Array& x);

}  // namespace weft::engine
