#pragma once
/// Private to integrators/: the triangles' resistance to collapse (forces/collapse.h) in the potential of
/// `newton`.

#include <array>
#include <memory>
#include <vector>

#include "weft/core/job_system.h"
#include "weft/core/padded_rows.h"
#include "weft/core/vec3_array.h"
#include "weft/forces/collapse.h"
#include "weft/forces/narrow_triangles.h"

namespace weft::engine {

/// Σ W over the narrow triangles of the last linearise(): those with W > 0, and those that a Newton step may
/// narrow that far. All others have W = 0. Positions are floats, laid out by the rows; the sums are doubles,
/// one triangle after the other. The preconditioner needs no change: see CollapseHessian.
class CollapseTerms {
 public:
  /// Discards the triangles of the last step.
  void begin(const ClothModel& model, const PaddedRows& rows);

  /// Finds the narrow triangles; returns the value [J]; adds the forces, and stores the Hessian.
  double linearise(const Vec3Array& x, JobSystem& jobs, Vec3Array& force);

  double energy(const Vec3Array& x) const;

  /// q += H p, and p·Hp [J].
  double add_product(const Vec3Array& p, Vec3Array& q) const;

 private:
  struct Narrow {
    std::array<int, 3> at;  // indices into the rows
    RestTriangle rest;
  };
  struct Active {
    std::array<int, 3> at;
    CollapseHessian hessian;
  };

  std::uint64_t model_id_ = 0;
  std::shared_ptr<const ClothTopology> topology_;
  PaddedRows rows_;
  StrainLimit law_;
  NarrowTriangles finder_;
  std::vector<Narrow> narrow_;
  std::vector<Active> active_;
};

}  // namespace weft::engine
