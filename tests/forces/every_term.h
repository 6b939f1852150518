#pragma once
/// Cloths that between them have every row of forces/terms.h, in crumpled motion.

#include <algorithm>
#include <memory>
#include <string>
#include <vector>

#include "tests/forces/sheets.h"
#include "tests/integrators/fabric_sheets.h"
#include "tests/support.h"
#include "weft/forces/pressure.h"

namespace weft::engine::test {

struct CrumpledCloth {
  std::string name;
  std::shared_ptr<const ClothModel> model;
  ClothState state;
};

inline CrumpledCloth crumple(const std::string& name, std::shared_ptr<const ClothModel> model,
                             double displacement, const Vec3& place = Vec3::Zero()) {
  std::vector<Vec3> positions = model->topology->mesh.positions;
  for (Vec3& p : positions) p += place;
  CrumpledCloth cloth{name, std::move(model), make_state(positions)};
  shake(cloth.state, displacement, 0.5, 7);
  return cloth;
}

inline std::vector<CrumpledCloth> make_crumpled_cloths() {
  constexpr ClothMaterial kNoSprings{.structural = 0, .shear = 0, .bend = 0};
  // Weak membranes, beside which bending and friction show.
  Fabric fabric{.c11 = 8,
                .c22 = 5,
                .c12 = 1,
                .g = 2,
                .bend_warp = 0.002,
                .bend_weft = 0.001,
                .bend_bias = 0.001,
                .bend_hysteresis_warp = 0.01,
                .bend_hysteresis_weft = 0.02,
                .bend_set = 5,
                .damping = 0.01};
  const auto elements_of = [&](const TriangleMesh& mesh, BendingModel bending) {
    return build_mesh_elements(mesh, warp_from_direction(mesh, {0.8, 0, 0.6}), fabric, bending);
  };
  std::vector<CrumpledCloth> cloths;
  for (const DampingKind kind : {DampingKind::projected, DampingKind::plain}) {
    const ClothMaterial material{.structural = 200, .bend = 5, .damping = 0.05, .damping_kind = kind};
    cloths.push_back(crumple("springs of a grid",
                             build_cloth_model(build_grid_topology(square(6), SpringModel::basic), material),
                             0.02));
    cloths.push_back(
        crumple("springs of a mesh",
                build_cloth_model(build_mesh_topology(make_sheet(SheetKind::random, 6)), material), 0.02));
  }
  const auto grid = build_grid_topology(square(6), SpringModel::alternating);
  const auto with_elements = build_grid_elements(square(6), grid->mesh, GridWarp::second_axis, fabric);
  cloths.push_back(crumple("fabric on a grid", build_cloth_model(grid, kNoSprings, with_elements), 0.01));
  cloths.push_back(
      crumple("far away", build_cloth_model(grid, kNoSprings, with_elements), 0.01, {3e4, 10, -2e4}));
  cloths.push_back(crumple("collapsed", build_cloth_model(grid, kNoSprings, with_elements), 0.12));
  for (const BendingModel bending : {BendingModel::stencils, BendingModel::hinges}) {
    const auto mesh = build_mesh_topology(make_sheet(SheetKind::random, 6));
    cloths.push_back(crumple("fabric on a mesh",
                             build_cloth_model(mesh, kNoSprings, elements_of(mesh->mesh, bending)), 0.01));
  }
  Fabric limited = fabric;
  limited.strain_limit = 0.05;
  cloths.push_back(crumple("fabric with a limit", on_mesh(square(6), limited), 0.01));
  cloths.push_back(crumple("springs for a fabric, with a limit", springs_on(square(6), 0.02), 0.02));
  fabric.bend_hysteresis_warp = fabric.bend_hysteresis_weft = 0;
  fabric.bend_set = 0;
  const TriangleMesh ball = make_sphere_mesh({0.2, 1, 0}, 0.5, 10);
  const Seams seams{.springs = {{{3, 41, 47}, 0.3, 0.05, 700}, {{20, 60, 61}, 1, 0.02, 300}}, .time = 0.5};
  const auto closed = build_mesh_topology(ball, seams);
  const auto balloon = build_cloth_model(closed, kNoSprings, elements_of(ball, BendingModel::stencils));
  for (const Gas& gas : {seal_gas(500, 0.5), Gas{.pressure = 800}})
    cloths.push_back(crumple("balloon with seams", with_gas(*balloon, gas), 0.01));
  return cloths;
}

/// The same cloth without damping.
inline std::shared_ptr<const ClothModel> without_damping(const ClothModel& model) {
  ClothMaterial material = model.material;
  material.damping = material.damping_time = 0;
  std::shared_ptr<ClothElements> elements;
  if (model.elements) {
    elements = std::make_shared<ClothElements>(*model.elements);
    elements->damping = 0;
  }
  return with_gas(*build_cloth_model(model.topology, material, elements), model.gas);
}

inline double largest(const std::vector<Vec3>& values) {
  double result = 0;
  for (const Vec3& v : values) result = std::max(result, v.norm());
  return result;
}

}  // namespace weft::engine::test
