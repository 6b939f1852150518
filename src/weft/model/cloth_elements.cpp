#include "weft/model/cloth_elements.h"

#include <cmath>
#include <map>

namespace weft::engine {
namespace {

std::vector<Coupling> find_couplings(const ClothElements& elements) {
  const double stiffness = (elements.stiffness(0, 0) + elements.stiffness(1, 1)) / 2;
  std::map<std::pair<int, int>, double> sums;
  for (const auto& [vertices, rest] : elements.membranes) {
    for (int a = 0; a < 3; ++a) {
      const int b = (a + 1) % 3;
      sums[std::minmax(vertices[a], vertices[b])] -=
          stiffness * rest.area * rest.gradient[a].dot(rest.gradient[b]);
    }
  }
  std::vector<Coupling> couplings;
  for (const auto& [pair, sum] : sums) {
    if (sum > 1e-6 * stiffness) couplings.push_back({pair.first, pair.second, sum});
  }
  return couplings;
}

/// From the area of all triangles and the mean leg length of equivalent right-angled ones.
StrainLimit find_limit(const std::vector<MembraneElement>& membranes, const Fabric& fabric) {
  double area = 0;
  for (const MembraneElement& m : membranes) area += m.rest.area;
  return make_strain_limit(fabric, area, std::sqrt(2 * area / static_cast<double>(membranes.size())));
}

ClothElements make_elements(const RestMesh& mesh, const WarpField& warp, const Fabric& fabric,
                            BendingModel bending) {
  ClothElements elements;
  elements.stiffness = membrane_stiffness(fabric);
  elements.membranes = build_membranes(mesh, warp);
  elements.limit = find_limit(elements.membranes, fabric);
  elements.stretch_warp = make_stretch_kinks(fabric.stretch_warp, fabric.c11);
  elements.stretch_weft = make_stretch_kinks(fabric.stretch_weft, fabric.c22);
  elements.damping = fabric.damping;
  elements.patches = make_single_patches(elements.membranes);
  elements.difference = make_patch_difference(fabric);
  elements.couplings = find_couplings(elements);
  if (bending == BendingModel::hinges) elements.hinges = build_hinges(mesh, warp, fabric);
  return elements;
}

void bend_by_stencils(const Grid& grid, GridWarp warp, const Fabric& fabric, ClothElements& elements) {
  elements.bending = build_grid_bending(grid, warp, fabric);
  elements.thread_bends = build_grid_thread_bends(grid, warp, fabric);
}

void bend_by_stencils(const RestMesh& mesh, const WarpField& warp, const Fabric& fabric,
                      ClothElements& elements) {
  elements.bending = build_mesh_bending(mesh, warp, fabric);
  elements.thread_bends = build_mesh_thread_bends(mesh, warp, fabric);
}

}  // namespace

std::shared_ptr<const ClothElements> build_grid_elements(const Grid& grid, const RestMesh& mesh,
                                                         GridWarp warp, const Fabric& fabric,
                                                         BendingModel bending) {
  const Vec3 direction = warp == GridWarp::first_axis ? Vec3::UnitX() : Vec3::UnitZ();
  ClothElements elements = make_elements(mesh, warp_from_direction(mesh, direction), fabric, bending);
  elements.grid_warp = warp;
  if (bending == BendingModel::stencils) bend_by_stencils(grid, warp, fabric, elements);
  return std::make_shared<ClothElements>(std::move(elements));
}

std::shared_ptr<const ClothElements> build_grid_bending_elements(const Grid& grid, GridWarp warp,
                                                                 const Fabric& fabric) {
  ClothElements elements;
  // Per unit of length, so that a tension per width is the force of one edge.
  elements.spring_limit = make_strain_limit(fabric, grid.size_x * grid.size_z, 1);
  bend_by_stencils(grid, warp, fabric, elements);
  elements.damping = fabric.damping;
  elements.grid_warp = warp;
  return std::make_shared<ClothElements>(std::move(elements));
}

std::shared_ptr<const ClothElements> build_mesh_bending_elements(const RestMesh& mesh, const WarpField& warp,
                                                                 const Fabric& fabric) {
  ClothElements elements;
  bend_by_stencils(mesh, warp, fabric, elements);
  elements.damping = fabric.damping;
  return std::make_shared<ClothElements>(std::move(elements));
}

std::shared_ptr<const ClothElements> build_mesh_elements(const RestMesh& mesh, const WarpField& warp,
                                                         const Fabric& fabric, BendingModel bending) {
  ClothElements elements = make_elements(mesh, warp, fabric, bending);
  elements.patches = pair_triangles(mesh, warp, elements.membranes);
  if (bending == BendingModel::stencils) bend_by_stencils(mesh, warp, fabric, elements);
  return std::make_shared<ClothElements>(std::move(elements));
}

}  // namespace weft::engine
