#pragma once
/// Geometric multigrid for scalar matrices on grids, the same for x, y and z: one V-cycle approximates A⁻¹ in
/// a time proportional to the number of particles. The preconditioner of the fast solver.
///
///     (A u)_i = excess_i u_i + Σ_j c_ij (u_i − u_j)            c_ij, excess_i >= 0
///
/// over the eight neighbours j of particle i. Coarse grids keep every second particle of every second row;
/// between them values are interpolated linearly. The coarse matrices are the Galerkin operators PᵀAP, by
/// closed formulas row by row: rebuilding the hierarchy costs about as much as a few iterations. Excess and
/// couplings are coarsened separately, because in floats their sum would lose the excess of stiff cloth.

#include <vector>

#include "weft/core/aligned.h"
#include "weft/core/job_system.h"
#include "weft/core/padded_rows.h"
#include "weft/core/vec3_array.h"

namespace weft::engine {

/// Particles per row (or rows) of the next coarser grid than n: every second one. If n is even, the last one
/// is kept as well, in its place; two become one.
constexpr int coarse_length(int n) { return n == 2 ? 1 : n / 2 + 1; }
static_assert(coarse_length(1) == 1 && coarse_length(5) == 3 && coarse_length(6) == 4);

/// A matrix, laid out by `rows`, with zeros in the padding.
struct GridMatrix {
  PaddedRows rows;
  AlignedFloats right, down, down_right, down_left;  // c_ij with the neighbour on that side [N/m]
  AlignedFloats excess;                              // [N/m]; particles without any entry stay at zero
  AlignedFloats diagonal;                            // excess + Σ c [N/m]

  explicit GridMatrix(const PaddedRows& rows);
};

/// One grid of the hierarchy.
struct GridLevel : GridMatrix {
  bool has_down_left = true;  // false: `down_left` is zero everywhere
  AlignedFloats inverse;      // Jacobi's weight / diagonal, 0 where that is 0 [m/N]
  Vec3Array right_side, value, smoothed;

  explicit GridLevel(const PaddedRows& rows);
};

class GridMultigrid {
 public:
  /// Allocates grids of this size. A no-op if they exist.
  void resize(const PaddedRows& rows);

  /// The finest grid: set its couplings and excess, then call build().
  GridLevel& finest() { return levels_.front(); }

  /// Computes the hierarchy from the finest grid's couplings and excess.
  void build(JobSystem& jobs);

  /// z ≈ A⁻¹ r by one V-cycle: a symmetric positive definite operation. Returns r·z.
  double apply(const Vec3Array& r, JobSystem& jobs, Vec3Array& z);

  int num_levels() const { return static_cast<int>(levels_.size()); }

 private:
  void cycle(std::size_t level, const Vec3Array& b, Vec3Array& out, JobSystem& jobs, double* dots);
  void invert_coarsest();
  double apply_coarsest(const Vec3Array& r, Vec3Array& z) const;
  void solve_coarsest(const Vec3Array& b, Vec3Array& out) const;

  std::vector<GridLevel> levels_;
  std::vector<GridMatrix> narrowed_;  // of build(): each level coarsened along its rows only
  std::vector<double> coarsest_inverse_;
  std::vector<double> dots_;  // of each row
};

}  // namespace weft::engine
