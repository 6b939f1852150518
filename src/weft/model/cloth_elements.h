#pragma once
/// A fabric on a cloth's triangles: what stretches, shears and bends where there are no springs.

#include <memory>
#include <optional>

#include "weft/fabric/bending_rows.h"
#include "weft/fabric/elements.h"
#include "weft/fabric/membrane_law.h"

namespace weft::engine {

/// An entry of a matrix that is the same for x, y and z: ½ stiffness |x_j − x_i|².
struct Coupling {
  int i = 0, j = 0;      // particles, i < j
  double stiffness = 0;  // > 0 [N/m]
};

struct ClothElements {
  Mat3 stiffness = Mat3::Zero();  // of every membrane [N/m]
  StrainLimit limit;              // of every membrane
  StrainLimit spring_limit;       // of structural and shear springs, where they are the membranes
  std::vector<StretchKink> stretch_warp, stretch_weft;  // likewise
  std::vector<MembraneElement> membranes;               // one per triangle
  BendingRows bending;                                  // curvature stencils; none if there are hinges
  std::vector<HingeElement> hinges;                     // flat at rest; none if there are stencils
  double damping = 0;                                   // time constant τ of all of them [s]
  std::optional<GridWarp> grid_warp;  // set: the triangles are a grid's, with warp along one of its axes
  /// The membranes' Hessian at rest, roughly, as the paper's constant matrix (Eq. 11) is for springs: the
  /// positive cotangent weights times (C11 + C22)/2, by ascending i and j.
  std::vector<Coupling> couplings;

  MembraneLaw law() const { return {stiffness, limit, stretch_warp, stretch_weft}; }
  bool has_curves() const { return !stretch_warp.empty() || !stretch_weft.empty(); }
};

enum class BendingModel {
  stencils,  // the same rigidity in every direction, a constant Hessian
  hinges,    // angles between triangles, as most engines have it; stiffer along the mesh's diagonals
};

/// Of a grid and its mesh. The stencils are those of the grid, whatever way its cells are cut.
std::shared_ptr<const ClothElements> build_grid_elements(const Grid& grid, const TriangleMesh& mesh,
                                                         GridWarp warp, const Fabric& fabric,
                                                         BendingModel bending = BendingModel::stencils);

/// The grid's bending alone, beside springs that stand for the membranes, and their strain limit.
std::shared_ptr<const ClothElements> build_grid_bending_elements(const Grid& grid, GridWarp warp,
                                                                 const Fabric& fabric);

/// A mesh's bending alone, likewise. There is no strain limit.
std::shared_ptr<const ClothElements> build_mesh_bending_elements(const TriangleMesh& mesh,
                                                                 const WarpField& warp, const Fabric& fabric);

std::shared_ptr<const ClothElements> build_mesh_elements(const TriangleMesh& mesh, const WarpField& warp,
                                                         const Fabric& fabric,
                                                         BendingModel bending = BendingModel::stencils);

}  // namespace weft::engine
