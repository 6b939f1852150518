#pragma once
/// Algebraic multigrid for scalar matrices on any mesh, the same for x, y and z: smoothed aggregation
/// (Vaněk, Mandel, Brezina 1996). The counterpart of GridMultigrid for meshes.
///
///     (A u)_i = excess_i u_i + Σ_j c_ij (u_i − u_j)            c_ij, excess_i >= 0
///
/// Neighbours are joined to aggregates, each of which becomes one particle of the next level. The
/// prolongation spreads its value over the aggregate and smooths it by one Jacobi sweep; with plain
/// aggregates the number of cycles would grow with the mesh.

#include <vector>

#include "weft/core/aligned.h"
#include "weft/core/job_system.h"
#include "weft/core/vec3_array.h"
#include "weft/solvers/sparse_matrix.h"

namespace weft::engine {

/// A matrix for SIMD (sliced ELLPACK): sixteen interleaved rows per slice, with as many entry rows as the
/// longest of them has entries.
struct SlicedMatrix {
  std::vector<int> slice_begin;  // (num_slices + 1) first entry row of each slice
  std::vector<int> column;       // (num_entry_rows · 16), 0 where unused
  AlignedFloats value;           // likewise, 0 where unused

  int num_slices() const { return slice_begin.empty() ? 0 : static_cast<int>(slice_begin.size()) - 1; }
};

SlicedMatrix slice(const SparseMatrix& a);

class AggregationMultigrid {
 public:
  /// Builds the hierarchy of a matrix: `couplings` holds c_ij at (i, j) and at (j, i). Rows without entries
  /// and without excess drop out: their values stay zero.
  void build(const SparseMatrix& couplings, const std::vector<double>& excess);

  /// Adds to the excess of build(), and replaces what an earlier call added: only diagonals are recomputed. A
  /// coarse level receives Pᵀ of it, all on the diagonal: a little more than PᵀDP.
  void add_excess(const std::vector<double>& more);

  /// z ≈ A⁻¹ r by one V-cycle, for particle i at index first + i. Returns r·z.
  double apply(const Vec3Array& r, int first, JobSystem& jobs, Vec3Array& z);

  int num_levels() const { return static_cast<int>(levels_.size()); }

 private:
  struct Level {
    int size = 0;
    SlicedMatrix couplings;             // without the diagonal
    SlicedMatrix prolong, restriction;  // from and to the next level
    SparseMatrix spread;                // `restriction`, for add_excess()
    double largest_eigenvalue = 1;      // of D⁻¹A
    std::vector<double> built_diagonal;
    AlignedFloats diagonal, inverse;  // Jacobi's weight / diagonal, 0 where that is 0
    Vec3Array right_side, value, residual, smoothed;
  };

  static Level make_level(const SparseMatrix& couplings, const std::vector<double>& diagonal,
                          double largest_eigenvalue);
  void invert_coarsest(const std::vector<double>& more);
  void cycle(std::size_t level, const float* const b[3], float* const out[3], JobSystem& jobs, double* dots);
  void solve_coarsest(const float* const b[3], float* const out[3]) const;

  std::vector<Level> levels_;
  SparseMatrix coarsest_;                   // couplings of the coarsest level
  std::vector<double> coarsest_inverse_;    // empty: the coarsest level is only smoothed
  std::vector<double> more_, coarse_more_;  // work space of add_excess()
  std::vector<double> dots_;                // of each slice
};

}  // namespace weft::engine
