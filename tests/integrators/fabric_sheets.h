#pragma once
/// Fabric sheets for tests of integrators: membranes and bending on grids and meshes, with their pins.

#include <memory>
#include <vector>

#include "tests/forces/sheets.h"
#include "weft/integrators/integrator.h"
#include "weft/model/fabric_springs.h"

namespace weft::engine::test {

inline std::shared_ptr<const ClothModel> on_grid(const Grid& grid, const Fabric& fabric) {
  const auto topology = build_grid_topology(grid, SpringModel::alternating);
  return build_cloth_model(topology, {.density = fabric.density, .structural = 0, .shear = 0, .bend = 0},
                           build_grid_elements(grid, topology->mesh, GridWarp::first_axis, fabric));
}

inline std::shared_ptr<const ClothModel> on_mesh(const Grid& grid, const Fabric& fabric) {
  const auto topology = build_mesh_topology(make_sheet(SheetKind::random, grid));
  return build_cloth_model(
      topology, {.density = fabric.density, .structural = 0, .shear = 0, .bend = 0},
      build_mesh_elements(topology->mesh, warp_from_direction(topology->mesh, Vec3::UnitX()), fabric));
}

/// A fabric whose membranes are a grid's springs.
inline std::shared_ptr<const ClothModel> springs_on(const Grid& grid, double strain_limit) {
  const Fabric fabric = {.density = 0.2,
                         .c11 = 250,
                         .c22 = 200,
                         .c12 = 30,
                         .g = 30,
                         .bend_warp = 1e-5,
                         .bend_weft = 1e-5,
                         .bend_bias = 1e-5,
                         .damping = 2e-3,
                         .strain_limit = strain_limit,
                         .stretch_warp = {},
                         .stretch_weft = {}};
  ClothMaterial material{.density = fabric.density, .bend = 0};
  set_fabric_springs(
      make_grid_springs(grid, CellDiagonals::alternating, GridWarp::first_axis, fabric, "test"), fabric,
      material);
  return build_cloth_model(build_grid_topology(grid, SpringModel::alternating), material,
                           build_grid_bending_elements(grid, GridWarp::first_axis, fabric));
}

/// Pins the given particles at their rest positions.
inline Environment hung_by(const ClothModel& model, const std::vector<int>& pins) {
  Environment environment;
  for (const int i : pins) {
    environment.pins.particle.push_back(i);
    environment.pins.position.push_back(model.topology->mesh.positions[i]);
  }
  return environment;
}

}  // namespace weft::engine::test
