#include "weft/model/cloth_elements.h"

namespace weft {
namespace {

ClothElements make_elements(const TriangleMesh& mesh, const WarpField& warp, const Fabric& fabric,
                            BendingModel bending) {
  ClothElements elements;
  elements.stiffness = membrane_stiffness(fabric);
  elements.membranes = build_membranes(mesh, warp);
  elements.damping = fabric.damping;
  if (bending == BendingModel::hinges) elements.hinges = build_hinges(mesh, warp, fabric);
  return elements;
}

}  // namespace

std::shared_ptr<const ClothElements> build_grid_elements(const Grid& grid, const TriangleMesh& mesh,
                                                         GridWarp warp, const Fabric& fabric,
                                                         BendingModel bending) {
  const Vec3 direction = warp == GridWarp::first_axis ? Vec3::UnitX() : Vec3::UnitZ();
  ClothElements elements = make_elements(mesh, warp_from_direction(mesh, direction), fabric, bending);
  if (bending == BendingModel::stencils) elements.bending = build_grid_bending(grid, warp, fabric);
  return std::make_shared<ClothElements>(std::move(elements));
}

std::shared_ptr<const ClothElements> build_mesh_elements(const TriangleMesh& mesh, const WarpField& warp,
                                                         const Fabric& fabric, BendingModel bending) {
  ClothElements elements = make_elements(mesh, warp, fabric, bending);
  if (bending == BendingModel::stencils) elements.bending = build_mesh_bending(mesh, warp, fabric);
  return std::make_shared<ClothElements>(std::move(elements));
}

}  // namespace weft
