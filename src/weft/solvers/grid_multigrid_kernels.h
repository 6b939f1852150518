#pragma once
/// Private to solvers/: kernels of the grid multigrid, each for a range of rows.

#include "weft/solvers/grid_multigrid.h"

namespace weft::engine::grid_kernels {

struct Component3 {
  float *x, *y, *z;
};
struct ConstComponent3 {
  const float *x, *y, *z;
};
inline Component3 components(Vec3Array& a) { return {a.x(), a.y(), a.z()}; }
inline ConstComponent3 components(const Vec3Array& a) { return {a.x(), a.y(), a.z()}; }

/// diagonal = excess + Σ c, inverse = Jacobi's weight over it.
void finish_rows(GridLevel& level, int row_begin, int row_end);

/// Coarsens a matrix along its rows: row_begin … row_end of `narrow`, which has half the columns.
void narrow_rows(const GridMatrix& fine, GridMatrix& narrow, int row_begin, int row_end);

/// Coarsens a narrowed matrix across its rows: row_begin … row_end of `coarse`, which has half the rows.
void merge_rows(const GridMatrix& narrow, GridMatrix& coarse, int row_begin, int row_end);

/// x = inverse · b: a Jacobi sweep from zero.
void smooth_from_zero(const GridLevel& level, ConstComponent3 b, Component3 x, int row_begin, int row_end);

/// out = x + inverse · (b − A x), zero where inverse is. dots[row] = b·out unless null.
void smooth(const GridLevel& level, ConstComponent3 b, ConstComponent3 x, Component3 out, int row_begin,
            int row_end, double* dots);

/// Rows row_begin … row_end of the coarse right side: Pᵀ (b − A x).
void restrict_residual(const GridLevel& fine, ConstComponent3 b, ConstComponent3 x, const GridLevel& coarse,
                       Component3 out, int row_begin, int row_end);

/// x += P e, for rows of the fine grid.
void prolong(const GridLevel& coarse, ConstComponent3 e, const GridLevel& fine, Component3 x, int row_begin,
             int row_end);

}  // namespace weft::engine::grid_kernels
