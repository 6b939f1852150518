#pragma once
/// Bending without the mesh's grain: curvature by linear stencils, the same rigidity in every direction.
///
/// Cloth bends nearly without stretching. In flat rest coordinates X (1 along warp, 2 along weft) the second
/// derivatives x,ij = ∂²x/∂X_i∂X_j are then normal to the cloth and as long as its curvatures, so that the
/// bending energy is a quadratic form of the positions (M. Bergou et al., A Quadratic Bending Model for
/// Inextensible Surfaces, SGP 2006):
///
///     W = ½ ∫ bend_warp |x,11|² + bend_weft |x,22|² + t |x,12|²,    t = 4 bend_bias − bend_warp − bend_weft
///
/// A cylinder rolled in the direction ψ from warp costs ½ bending_rigidity(ψ) κ² per area. Every x,ij becomes
/// a stencil, a row of weights on a few vertices; the energy becomes ½ Σ_r k_r |Σ_v w_rv x_v|². Its Hessian
/// is one constant matrix of scalars, positive semidefinite, and no angle is ever computed.
///
///     on a grid:  1  −2   1       1          1 −1        rows cover borders with half their width
///                             −2          −1  1
///                                 1        (t, per cell)
///
///     on a mesh:  x,ab at an inner vertex i with area A_i is −1/A_i Σ_j (∫ ∂a φ_i ∂b φ_j, made symmetric)
///     x_j
///                 over its one-ring, φ the linear shape functions (the trace is the cotangent Laplacian).
///
/// Measured, rigidity shown over rigidity given at all angles, the vertices free to settle (and by hinges on
/// the same mesh): grids 1; meshes with parallel diagonals 1.00 to 1.06 (0.7 to 3.6), random meshes 1.01
/// to 1.06 (0.9 to 1.6), alternating diagonals, whose vertices have 4 and 8 edges by turns, 1.04 to 1.20 (0.8
/// to 1.5). tests/forces/bending_test.cpp prints the figures.
///
/// Cloth is flat at rest in this model. Where bend_bias < (bend_warp + bend_weft)/4, t = 0 is used, and bias
/// bending shows (bend_warp + bend_weft)/4.

#include <vector>

#include "weft/fabric/elements.h"
#include "weft/mesh/grid.h"

namespace weft::engine {

/// ½ Σ_r stiffness_r |Σ_k weight_k x_{vertex_k}|², k from begin[r] to begin[r + 1].
struct BendingRows {
  std::vector<int> begin = {0};   // (num_rows + 1)
  std::vector<int> vertex;        // (begin.back())
  std::vector<double> weight;     // likewise; those of a row sum to zero [1/m²]
  std::vector<double> stiffness;  // (num_rows) rigidity times area [N·m³]

  int num_rows() const { return static_cast<int>(stiffness.size()); }
};

/// A grid with warp along its first axis, or along its second.
enum class GridWarp { first_axis, second_axis };

BendingRows build_grid_bending(const Grid& grid, GridWarp warp, const Fabric& fabric);

/// Any mesh. Vertices on the border bend along it with the inner vertices next to them. Linear hinges stand
/// beside the stencils with 2 % of the rigidity, and with all of it where no inner vertex is near (ears,
/// ribbons of one cell). Non-manifold vertices count as border.
BendingRows build_mesh_bending(const TriangleMesh& mesh, const WarpField& warp, const Fabric& fabric);

/// The rows' Hessian: the same scalars for x, y and z, compressed by rows, columns ascending.
struct BendingMatrix {
  std::vector<int> begin;     // (num_vertices + 1)
  std::vector<int> column;    // (begin.back()) vertex
  std::vector<double> value;  // likewise [N/m]
};

BendingMatrix build_bending_matrix(const BendingRows& rows, int num_vertices);

}  // namespace weft::engine
