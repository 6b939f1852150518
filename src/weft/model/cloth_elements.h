#pragma once
/// Elements of a fabric on a cloth's triangles: membranes and bending in place of springs.

#include <memory>
#include <optional>

#include "weft/fabric/bending_rows.h"
#include "weft/fabric/elements.h"
#include "weft/fabric/membrane_law.h"

namespace weft::engine {

/// An entry of a matrix that is equal for x, y and z: ½ stiffness |x_j − x_i|².
struct Coupling {
  int i = 0, j = 0;      // particles, i < j
  double stiffness = 0;  // > 0 [N/m]
};

struct ClothElements {
  Mat3 stiffness = Mat3::Zero();  // of every membrane [N/m]
  StrainLimit limit;              // of every membrane
  StrainLimit spring_limit;       // of structural and shear springs that replace membranes
  std::vector<StretchKink> stretch_warp, stretch_weft;  // of every membrane
  std::vector<MembraneElement> membranes;               // one per triangle
  std::vector<MembranePatch> patches;                   // of membranes: pairs on meshes, single ones on grids
  PatchDifference difference;                           // of every pair
  BendingRows bending;                                  // curvature stencils; empty with hinges
  std::vector<HingeElement> hinges;                     // flat at rest; empty with stencils
  ThreadBends thread_bends;           // beside the stencils: hysteresis and set; may be empty
  double damping = 0;                 // time constant τ of all of them [s]
  std::optional<GridWarp> grid_warp;  // set: triangles of a grid, with warp along one of its axes
  /// Approximation of the membranes' Hessian at rest, the counterpart of the paper's constant spring matrix
  /// (Eq. 11): the positive cotangent weights times (C11 + C22)/2, by ascending i and j.
  std::vector<Coupling> couplings;

  PatchLaw law() const { return {{stiffness, limit, stretch_warp, stretch_weft}, difference}; }
  bool has_curves() const { return !stretch_warp.empty() || !stretch_weft.empty(); }
};

enum class BendingModel {
  stencils,  // the same rigidity in every direction, a constant Hessian
  hinges,    // angles between triangles, as in most engines; stiffer along the mesh's diagonals
};

/// Elements of a grid and its mesh. The stencils are the grid's, independent of its cells' diagonals.
std::shared_ptr<const ClothElements> build_grid_elements(const Grid& grid, const RestMesh& mesh,
                                                         GridWarp warp, const Fabric& fabric,
                                                         BendingModel bending = BendingModel::stencils);

/// A grid's bending only, for springs that replace membranes, and their strain limit.
std::shared_ptr<const ClothElements> build_grid_bending_elements(const Grid& grid, GridWarp warp,
                                                                 const Fabric& fabric);

/// A mesh's bending only, likewise. There is no strain limit.
std::shared_ptr<const ClothElements> build_mesh_bending_elements(const RestMesh& mesh, const WarpField& warp,
                                                                 const Fabric& fabric);

std::shared_ptr<const ClothElements> build_mesh_elements(const RestMesh& mesh, const WarpField& warp,
                                                         const Fabric& fabric,
                                                         BendingModel bending = BendingModel::stencils);

}  // namespace weft::engine
