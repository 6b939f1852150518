#pragma once
/// Private to integrators/: a term (forces/term.h) in the potential of `newton`.

#include "weft/core/job_system.h"
#include "weft/core/padded_rows.h"
#include "weft/core/vec3_array.h"
#include "weft/integrators/integrator.h"

namespace weft::engine {

/// Positions are floats, laid out by padded rows. Sums are doubles in a fixed order.
class NewtonTerm {
 public:
  /// A step; `state` is that at its start, whose memory has been advanced. All outlive it.
  struct Step {
    const ClothModel& model;
    const Environment& environment;
    const ClothState& state;
    const PaddedRows& rows;
  };

  struct Place {
    const Vec3Array& x;  // y + e [m]
    const Vec3Array& e;  // correction of the prediction y [m]
  };

  virtual ~NewtonTerm() = default;

  virtual void begin(const Step& step) = 0;

  virtual double energy(const Place& at, JobSystem& jobs) = 0;  // [J]

  /// The energy; adds the forces, and stores the Hessian for add_product().
  virtual double linearise(const Place& at, JobSystem& jobs, Vec3Array& force) = 0;

  /// q += H p, and p·Hp [J].
  virtual double add_product(const Vec3Array& p, JobSystem& jobs, Vec3Array& q) = 0;
};

}  // namespace weft::engine
