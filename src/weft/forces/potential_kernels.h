#pragma once
/// Private to forces/: views that potential.cpp passes to the grid and mesh kernels.

#include "weft/core/padded_rows.h"
#include "weft/forces/increments_kernels.h"
#include "weft/forces/limit_pull.h"

namespace weft::engine::kernels {

/// The springs of a grid come in families, each spring owned by one of its ends:
///
///     p--0--o         0 across, 1 down, 2 main diagonal, 3 and 4 bending across and down,
///     | \ 2           5 the other diagonal, owned by its upper end (to the particle below, on the left)
///     1  \ .
///     |   \ .
///     o     o
struct FamilyOffset {
  int rows, columns;
};
inline constexpr FamilyOffset kFamilyOffsets[6] = {{0, 1}, {1, 0}, {1, 1}, {0, 2}, {2, 0}, {1, -1}};

/// Data that the grid kernels read and write.
struct GridPotential {
  PaddedRows rows;
  int num_families = 5;                  // 5, 6 with both diagonals, 0 without springs
  bool alternates = false;               // diagonals start only at even row + column
  const float* stiffness = nullptr;      // of each family
  const float* own_stiffness = nullptr;  // of each spring, in slope_row's order; null: its family's
  const float* rest_length = nullptr;    // of each family
  bool has_soft_border = false;          // structural springs on the border have half stiffness
  LimitNumbers limit;                    // of structural and shear springs
  float* peak = nullptr;                 // with a limit: largest strain of each row's springs [1]
  float damping = 0;
  float damping_time = 0;  // additional damping of every spring, over its stiffness
  bool is_projected = true;
  const float* weight = nullptr;
  ConstRows x{}, offset{}, damped{};
  float* hessian = nullptr;
  float* slope = nullptr;
  Rows force{};

  /// Component c (t, wx, wy, wz) of a family's springs from row j on, in `hessian`; −2 <= j.
  int hessian_row(int j, int family, int c) const {
    return (((j + PaddedRows::kRowsAround) * num_families + family) * 4 + c) * rows.stride() + kPackLanes;
  }
  static std::size_t hessian_size(const PaddedRows& rows, int num_families) {
    return static_cast<std::size_t>(rows.num_rows + 2 * PaddedRows::kRowsAround) * num_families * 4 *
               rows.stride() +
           2 * kPackLanes;
  }
  /// Row j of a family's springs, in `slope`.
  int slope_row(int j, int family) const { return family * static_cast<int>(rows.size()) + rows.row(j); }
};

/// sum = a + b.
void add(const float* a, const float* b, float* sum, int begin, int end);

/// Energies of the rows; each spring counts at its owner. With `store`, Hessian and slopes as well.
void grid_springs(const GridPotential& g, bool store, int row_begin, int row_end, double* energy);

/// Forces of the rows, from the slopes.
void grid_forces(const GridPotential& g, int row_begin, int row_end);

/// q = A p and p·q of the rows.
void grid_multiply(const GridPotential& g, ConstRows p, Rows q, int row_begin, int row_end, double* dot);

struct MeshPotential {
  const NeighbourTable* table = nullptr;
  int first = 0;  // index of particle 0
  int num_particles = 0;
  const float* stiffness = nullptr;  // of each entry
  float damping = 0;
  float damping_time = 0;  // as on a grid
  bool is_projected = true;
  const float* weight = nullptr;
  ConstRows x{}, offset{}, damped{};
  float* hessian = nullptr;  // (entry rows · 4 · 16): t, wx, wy, wz of sixteen entries each
  Rows force{};
};

/// Energies of the slices; each end counts half of every spring. With `store`, Hessian and forces as well.
void mesh_springs(const MeshPotential& m, bool store, int slice_begin, int slice_end, double* energy);

void mesh_multiply(const MeshPotential& m, ConstRows p, Rows q, int slice_begin, int slice_end, double* dot);

}  // namespace weft::engine::kernels
