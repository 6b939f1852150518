#pragma once
/// Private to integrators/: the paper's constant approximate matrix (Eq. 11) as preconditioner of `newton`.

#include <memory>
#include <utility>
#include <vector>

#include "weft/core/job_system.h"
#include "weft/core/padded_rows.h"
#include "weft/model/cloth_model.h"
#include "weft/solvers/aggregation_multigrid.h"
#include "weft/solvers/grid_multigrid.h"

namespace weft::engine {

/// D + Σ k (e_i − e_j)(e_i − e_j)ᵀ over the springs, the same for x, y and z, solved approximately by one
/// multigrid V-cycle. Bending springs are not in it: on grids they count as four times their stiffness along
/// the structural springs, on meshes they are left out. For fabrics the elements' couplings replace the
/// springs; low shear, warp and weft, and bending need no other matrix.
class ScalarPreconditioner {
 public:
  /// Takes springs or elements, with their damping in steps of length `step`. Pinned particles drop out of
  /// the matrix. `least` is a lower bound for any D that will be set, laid out by `rows` [N/m].
  /// set_diagonal() must follow. `added` is additional stiffness of each of the elements' couplings, on a
  /// grid without membranes of each spring, or empty [N/m].
  void set_springs(const ClothModel& model, const PaddedRows& rows, double step,
                   const std::vector<float>& least, const std::vector<int>& pinned,
                   const std::vector<double>& added = {});

  /// Sets D, laid out by `rows` [N/m], and recomputes all values.
  void set_diagonal(const std::vector<float>& diagonal, JobSystem& jobs);

  /// z ≈ A⁻¹ r, zero at pinned particles. Returns r·z.
  double apply(const Vec3Array& r, JobSystem& jobs, Vec3Array& z);

 private:
  void build_mesh(const ClothModel& model, double step, const std::vector<double>& added);
  void fill_grid_by_springs(const ClothModel& model, double step);
  void scale_grid_springs(const ClothModel& model, double step, const std::vector<double>& added);
  void fill_grid_by_elements(const ClothElements& elements, double step, const std::vector<double>& added);
  void pin_grid();

  bool is_grid_ = true;
  int first_ = 0;  // index of particle 0
  std::vector<int> pinned_;
  std::vector<std::pair<int, float>> ties_;  // index of a particle on a grid, and its coupling to pins
  std::vector<float> least_;                 // on meshes
  std::vector<double> more_;                 // on meshes: D beyond `least_`
  GridMultigrid grid_;
  AggregationMultigrid mesh_;
};

}  // namespace weft::engine
