#pragma once
/// Private to forces/: views that element_potential.cpp passes to the grid and mesh kernels.

#include "weft/core/padded_rows.h"
#include "weft/fabric.h"
#include "weft/forces/increments_kernels.h"
#include "weft/forces/limit_pull.h"

namespace weft::engine::kernels {

/// C with damping: (1 + η) [C11 C12 0; C12 C22 0; 0 0 G] [N/m].
struct MembraneNumbers {
  float c11 = 0, c22 = 0, c12 = 0, g = 0;
};

/// Kinks of a stretch curve, in floats.
struct CurveNumbers {
  int count = 0;
  float strain[kMaxStretchPoints] = {}, slope[kMaxStretchPoints] = {};
};

/// The nonlinear part of a membrane's law: its strain limit and its stretch curves.
struct StiffeningNumbers {
  LimitNumbers limit;
  CurveNumbers along_1, along_2;

  bool is_set() const { return limit.is_set() || along_1.count > 0 || along_2.count > 0; }
};

/// Entries of the stiffening's tangent: its upper triangle, D11 D12 D13 D22 D23 D33.
inline constexpr int kTangentSize = 6;

/// Entries of a Hessian block: row by row, from the particle that owns it.
inline constexpr int kBlockSize = 9;

/// The right angles of a cell's triangles are at the cell's corners, so that an edge along x, over dx, is the
/// first column of F, and one along z, over dz, the second:
///
///     a--h0--b      cut from a to d:   top (h0, v1), with its right angle at b    bottom (h1, v0), at c
///     |      |      cut from b to c:   top (h0, v0), at a                         bottom (h1, v1), at d
///    v0      v1
///     |      |      Each edge is owned by one particle. Direction by family: 0 right, 1 down, 2 down and
///     c--h1--d      right, 3 down and left, 4 two to the right, 5 two down.
struct GridElements {
  static constexpr int kFamilies = 6;
  static constexpr int kRow[kFamilies] = {0, 1, 1, 1, 0, 2}, kColumn[kFamilies] = {1, 0, 1, -1, 2, 0};

  PaddedRows rows;
  bool alternates = false;   // cell diagonals alternate; else all run from a to d
  float dx = 1, dz = 1;      // [m]
  MembraneNumbers membrane;  // with C11 along x
  float damping = 0;         // η
  StiffeningNumbers stiffening;
  float* tangent = nullptr;        // of stiffening, for tops and bottoms (12); null: none [N/m]
  float* peak = nullptr;           // largest principal strain of each row; null: none [1]
  const float* bending = nullptr;  // couplings b_ij of every family, at the owner [N/m]
  float* past = nullptr;           // rest strain of damping, of tops and bottoms (6)
  ConstRows x{}, damped{}, bent{};
  float* stress = nullptr;  // of tops and bottoms (6) [N/m]
  float* slope = nullptr;   // of the first four families [N/m]
  float* hessian = nullptr;
  Rows force{};

  /// Families whose edges are triangle edges.
  int num_edge_families() const { return alternates ? 4 : 3; }
  std::ptrdiff_t plane_pitch() const { return static_cast<std::ptrdiff_t>(rows.size()); }
  float* plane(float* planes, int k) const { return planes + k * rows.size(); }
  const float* plane(const float* planes, int k) const { return planes + k * rows.size(); }

  /// Component c of a family's blocks from row j on, in `hessian`; −1 <= j.
  std::ptrdiff_t hessian_row(int j, int family, int c) const {
    const std::ptrdiff_t row = (j + PaddedRows::kRowsAround) * num_edge_families() + family;
    return (row * kBlockSize + c) * rows.stride() + kPackLanes;
  }
  std::size_t hessian_size() const { return hessian_row(rows.num_rows, 0, 0) + kPackLanes; }
};

/// past += share · strain at x, for the cells of these rows.
void grid_past(const GridElements& g, float share, int row_begin, int row_end);

/// Stresses, and the energies of the rows: their cells, and the bending couplings they own.
void grid_membranes(const GridElements& g, int row_begin, int row_end, double* energy);

/// Slopes and Hessian blocks of the edges that the rows own, from the stresses.
void grid_blocks(const GridElements& g, int row_begin, int row_end);

/// force += forces of the slopes and of bending.
void grid_element_forces(const GridElements& g, int row_begin, int row_end);

/// q += A p, and p·(A p) of the rows.
void grid_multiply_elements(const GridElements& g, ConstRows p, Rows q, int row_begin, int row_end,
                            double* dot);

/// Stiffness of a pair's difference of strains, with damping, and the threads' beyond a large difference.
struct DifferenceNumbers {
  float soft = 0, begin = 0;  // [N/m, 1]
  float along_1 = 0, along_2 = 0;
};

/// Patches (forces/membrane_patch.h) and particle table entries are stored in slices of sixteen: value k of an item
/// is at (slice · count + k) · 16 + lane. Vertices 0 and 1 of a pair are its common edge; the first triangle is 0,
/// 1, 2, the second one 1, 0, 3. A single triangle is a pair whose second one has no area.
struct MeshElements {
  static constexpr int kShapeSize =
      11;  // gradients of vertices 1, 2 in the first triangle, 1, 3 in the second;
           // both areas, 1 / their sum
  static constexpr int kFrameSize =
      20;  // of both triangles F's columns, then their stresses; tangent of a large
           // difference along both threads
  static constexpr int kNumCouplings = 6;   // of a patch's vertices: 0-1, 0-2, 0-3, 1-2, 1-3, 2-3
  static constexpr int kCouplingSize = 10;  // slope, block from the first vertex
  static constexpr int kPatchSize = kNumCouplings * kCouplingSize;
  static constexpr int kTangents = 2 + 2 * kTangentSize;  // of the curves, of both triangles' limits

  int first = 0;  // index of particle 0
  MembraneNumbers membrane;
  DifferenceNumbers difference;
  float damping = 0;  // η
  StiffeningNumbers stiffening;
  float* tangent = nullptr;     // of stiffening, kTangents per patch; null: none [N/m]
  float* peak = nullptr;        // largest principal strain of each slice; null: none [1]
  const int* corner = nullptr;  // four of each patch
  const float* shape = nullptr;
  float* past = nullptr;  // rest strains of damping, of both triangles (6)
  float* frame = nullptr;
  float* patch = nullptr;            // slopes and blocks of the couplings
  const int* slice_begin = nullptr;  // of the particles' edges
  const int* neighbour = nullptr;    // of each entry
  const int* coupling =
      nullptr;  // two of each entry: 2 · its place in `patch`, + 1 if the entry is its second end
  const float* bending = nullptr;  // of each entry [N/m]
  const int* far_begin = nullptr;  // of the particles joined only by bending
  const int* far_neighbour = nullptr;
  const float* far_bending = nullptr;
  ConstRows x{}, damped{}, bent{};
  float* hessian = nullptr;  // a block of each entry
  Rows force{};
};

void mesh_past(const MeshElements& m, float share, int slice_begin, int slice_end);

/// Frames and energies of slices of patches.
void mesh_membranes(const MeshElements& m, int slice_begin, int slice_end, double* energy);

/// Bending energies of slices of particles; each end counts half of every coupling.
void mesh_bending(const MeshElements& m, int slice_begin, int slice_end, double* energy);

/// Slopes and blocks of slices of patches, from their frames.
void mesh_patches(const MeshElements& m, int slice_begin, int slice_end);

/// force += forces of membranes and bending; Hessian blocks of the entries, from those of the patches.
void mesh_blocks(const MeshElements& m, int slice_begin, int slice_end);

void mesh_multiply_elements(const MeshElements& m, ConstRows p, Rows q, int slice_begin, int slice_end,
                            double* dot);

}  // namespace weft::engine::kernels
