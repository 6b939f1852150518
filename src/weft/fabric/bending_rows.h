#pragma once
/// Mesh-independent bending: curvature by linear stencils, with the same rigidity in every direction.
///
/// Cloth bends nearly without stretching. In flat rest coordinates X (1 along warp, 2 along weft) the second
/// derivatives x,ij = ∂²x/∂X_i∂X_j are then normal to the cloth, with its curvatures as lengths. The bending
/// energy is thus a quadratic form of the positions (M. Bergou et al., A Quadratic Bending Model for
/// Inextensible Surfaces, SGP 2006):
///
///     W = ½ ∫ bend_warp |x,11|² + bend_weft |x,22|² + t |x,12|²,    t = 4 bend_bias − bend_warp − bend_weft
///
/// A cylinder rolled in the direction ψ from warp costs ½ bending_rigidity(ψ) κ² per area. Every x,ij becomes
/// a stencil, a row of weights on a few vertices; the energy becomes ½ Σ_r k_r |Σ_v w_rv x_v|². Its Hessian
/// is one constant matrix of scalars, positive semidefinite; no angles are computed.
///
///     on a grid:  1  −2   1       1          1 −1        rows cover borders with half their width
///                             −2          −1  1
///                                 1        (t, per cell)
///
///     on a mesh:  x,ab at an inner vertex i with area A_i is −1/A_i Σ_j (∫ ∂a φ_i ∂b φ_j, symmetrised) x_j
///                 over its one-ring, φ the linear shape functions (the trace is the cotangent Laplacian).
///
/// Measured ratio of effective to given rigidity over all angles, with the vertices free to settle (in
/// brackets hinges on the same mesh): grids 1; meshes with parallel diagonals 1.00 to 1.06 (0.7 to 3.6),
/// random meshes 1.01 to 1.06 (0.9 to 1.6), alternating diagonals, whose vertices have alternately 4 and 8
/// edges, 1.04 to 1.20 (0.8 to 1.5). tests/forces/bending_test.cpp prints the results.
///
/// Cloth is flat at rest in this model. Where bend_bias < (bend_warp + bend_weft)/4, t = 0 is used, and the
/// bias rigidity becomes (bend_warp + bend_weft)/4.

#include <vector>

#include "weft/fabric/elements.h"
#include "weft/mesh/grid.h"

namespace weft::engine {

/// ½ Σ_r stiffness_r |Σ_k weight_k x_{vertex_k}|², k from begin[r] to begin[r + 1].
struct BendingRows {
  std::vector<int> begin = {0};   // (num_rows + 1)
  std::vector<int> vertex;        // (begin.back())
  std::vector<double> weight;     // (begin.back()), sum zero per row [1/m²]
  std::vector<double> stiffness;  // (num_rows) rigidity times area [N·m³]

  int num_rows() const { return static_cast<int>(stiffness.size()); }
};

/// A grid with warp along its first or second axis.
enum class GridWarp { first_axis, second_axis };

BendingRows build_grid_bending(const Grid& grid, GridWarp warp, const Fabric& fabric);

/// Stencils of any mesh. Border vertices bend along the border with the adjacent inner vertices. Linear
/// hinges supplement the stencils with 2 % of the rigidity, and with all of it without a nearby inner vertex
/// (ears, ribbons of one cell). Non-manifold vertices count as border.
BendingRows build_mesh_bending(const RestMesh& mesh, const WarpField& warp, const Fabric& fabric);

/// Curvatures of warp and weft threads, for friction between threads and creases (forces/thread_bends.h). A row is a
/// curvature with sign, n·Σ_k weight_k x_{vertex_k}, n the normal of the cloth at vertex `center`.
struct ThreadBends {
  std::vector<int> begin = {0};   // (num_rows + 1)
  std::vector<int> vertex;        // (begin.back())
  std::vector<double> weight;     // (begin.back()), sum zero per row [1/m²]
  std::vector<int> center;        // (num_rows)
  std::vector<double> friction;   // (num_rows) moment per width at which threads slip, times area [N·m²]
  std::vector<double> stiffness;  // (num_rows) elastic rigidity times area, as in BendingRows [N·m³]
  double set = 0;                 // curvature that stays; 0: none [1/m]

  int num_rows() const { return static_cast<int>(center.size()); }
  bool empty() const { return center.empty(); }
};

/// Whether a fabric has hysteresis of bending, or a set.
bool has_bending_memory(const Fabric& fabric);

/// Empty for a fabric without them. Otherwise the rows depend on mesh and warp alone.
ThreadBends build_grid_thread_bends(const Grid& grid, GridWarp warp, const Fabric& fabric);

/// Of the curvatures of BendingRows along warp and weft, along borders, and across the edges that have a hinge of
/// full rigidity.
ThreadBends build_mesh_thread_bends(const RestMesh& mesh, const WarpField& warp, const Fabric& fabric);

/// Hessian of the rows: the same scalars for x, y and z, in CSR format, columns ascending.
struct BendingMatrix {
  std::vector<int> begin;     // (num_vertices + 1)
  std::vector<int> column;    // (begin.back()) vertex
  std::vector<double> value;  // likewise [N/m]
};

BendingMatrix build_bending_matrix(const BendingRows& rows, int num_vertices);

}  // namespace weft::engine
