#pragma once
/// Private to integrators/: the paper's constant approximate matrix (Eq. 11) as preconditioner of `newton`.

#include <memory>
#include <vector>

#include "weft/core/job_system.h"
#include "weft/core/padded_rows.h"
#include "weft/model/cloth_model.h"
#include "weft/solvers/aggregation_multigrid.h"
#include "weft/solvers/grid_multigrid.h"

namespace weft {

/// D + Σ k (e_i − e_j)(e_i − e_j)ᵀ over the springs, the same for x, y and z, solved roughly by one multigrid
/// V-cycle. Bending springs are not in it: on grids they count as four times their stiffness along the
/// structural springs, on meshes they are left out.
class ScalarPreconditioner {
 public:
  /// Rebuilds the values; the hierarchy itself only for another cloth. `diagonal` is D, laid out by `rows`;
  /// `damping` is added to every stiffness [N/m]. Pinned particles drop out of the matrix.
  void build(const ClothModel& model, const PaddedRows& rows, double damping,
             const std::vector<float>& diagonal, const std::vector<int>& pinned, JobSystem& jobs);

  /// z ≈ A⁻¹ r, zero at pinned particles. Returns r·z.
  double apply(const Vec3Array& r, JobSystem& jobs, Vec3Array& z);

 private:
  void build_mesh(const ClothModel& model, double damping, const float* diagonal,
                  const std::vector<int>& pinned);
  void fill_grid(const ClothModel& model, double damping);
  void pin_grid(const std::vector<int>& pinned);

  bool is_grid_ = true;
  int first_ = 0;  // index of particle 0
  GridMultigrid grid_;
  AggregationMultigrid mesh_;
};

}  // namespace weft
