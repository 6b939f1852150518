/// Fabrics in `xpbd`: membranes, stencils, hinges and limits against `implicit_euler` at the same small
/// steps, and against results that need no other integrator.

#include <gtest/gtest.h>

#include "tests/integrators/fabric_sheets.h"
#include "tests/support.h"
#include "weft/fabric.h"
#include "weft/world/measures.h"

namespace weft::engine {
namespace {

constexpr double kFrame = 1.0 / 60;
const Grid kSheet{.size_x = 0.3, .size_z = 0.3, .cells_x = 8, .cells_z = 8};

/// Steps of an integrator, with substeps as in World.
void run(Integrator& integrator, const ClothModel& model, const Environment& environment, int frames,
         ClothState& state) {
  const int substeps = integrator.num_substeps(model, environment, kFrame);
  test::advance(integrator, model, environment, kFrame / substeps, frames * substeps, state);
}

std::shared_ptr<const ClothModel> with_hinges(const Grid& grid, const Fabric& fabric) {
  const auto topology = build_mesh_topology(make_sheet(test::SheetKind::random, grid));
  const TriangleMesh& mesh = topology->mesh;
  return build_cloth_model(
      topology, {.density = fabric.density, .structural = 0, .shear = 0, .bend = 0},
      build_mesh_elements(mesh, warp_from_direction(mesh, Vec3::UnitX()), fabric, BendingModel::hinges));
}

std::vector<std::shared_ptr<const ClothModel>> all_kinds(const Fabric& fabric) {
  return {test::on_grid(kSheet, fabric), test::on_mesh(kSheet, fabric), with_hinges(kSheet, fabric),
          test::springs_on(kSheet, 0)};
}

TEST(XpbdFabric, SwingsAsWithImplicitEulerAtTheSameSteps) {
  // A fifth of a second after release from the horizontal; stiff enough in bending that no wrinkle has an
  // ambiguous direction. The remaining difference falls with the step.
  Fabric fabric = find_fabric("cotton_shirting");
  fabric.damping = 0.01;
  for (double* b : {&fabric.bend_warp, &fabric.bend_weft, &fabric.bend_bias}) *b *= 30;
  for (const auto& model : all_kinds(fabric)) {
    const Environment environment = test::hung_by(*model, {0, 8});
    double before = 1;
    for (const int substeps : {25, 100}) {
      ClothState fast = make_state(model->topology->mesh.positions), slow = fast;
      const auto xpbd = make_xpbd({.substeps = substeps});
      run(*xpbd, *model, environment, 12, fast);
      const auto euler = make_implicit_euler({.tolerance = 1e-5});
      test::advance(*euler, *model, environment, kFrame / substeps, 12 * substeps, slow);
      const double distance = test::rms_distance(fast, slow);
      EXPECT_LT(distance, before / 2);
      before = distance;
    }
    EXPECT_LT(before, 0.01);
  }
}

TEST(XpbdFabric, FallsFreelyAndStaysFlat) {
  for (const auto& model : all_kinds(find_fabric("cotton_shirting"))) {
    ClothState state = make_state(model->topology->mesh.positions);
    const auto xpbd = make_xpbd({});
    run(*xpbd, *model, {}, 20, state);
    for (int i = 0; i < model->num_particles(); ++i)
      EXPECT_NEAR(state.v.get(i).y(), -20 * 9.81 * kFrame, 1e-3);
  }
}

TEST(XpbdFabric, ShakenKeepsItsMomentum) {
  Fabric fabric = find_fabric("silk");
  fabric.damping = 0.01;
  for (const auto& model : all_kinds(fabric)) {
    ClothState state = make_state(model->topology->mesh.positions);
    test::shake(state, 0.002, 1);
    const Vec3 before = compute_momentum(*model, state);
    const auto xpbd = make_xpbd({});
    run(*xpbd, *model, {.gravity = Vec3::Zero()}, 10, state);
    EXPECT_LT((compute_momentum(*model, state) - before).norm(), 1e-6) << "0.01 kg at about 1 m/s, in floats";
  }
}

TEST(XpbdFabric, HasTheSameBitsForAnyNumberOfThreads) {
  const Grid grid{.size_x = 1, .size_z = 1, .cells_x = 60, .cells_z = 60};  // several chunks a colour
  Fabric fabric = find_fabric("cotton_shirting");
  fabric.damping = 0.01;
  for (const auto& model : {test::on_mesh(grid, fabric), with_hinges(grid, fabric)}) {
    const Environment environment = test::hung_by(*model, {0, 60});
    std::vector<ClothState> ends;
    for (const int threads : {1, 3}) {
      ends.push_back(make_state(model->topology->mesh.positions));
      const auto xpbd = make_xpbd({});
      const auto jobs = make_jobs(threads);
      for (int s = 0; s < 20; ++s) xpbd->advance(*model, environment, kFrame / 50, *jobs, ends.back());
    }
    for (int i = 0; i < model->num_particles(); ++i) ASSERT_EQ(ends[0].v.get(i), ends[1].v.get(i)) << i;
  }
}

TEST(XpbdFabric, KeepsAStrainLimitWithSubstepsEnough) {
  // A loose sheet; the limit acts as a separate stiff spring, which needs more substeps than the cloth.
  Fabric loose{.density = 0.2, .c11 = 20, .c22 = 20, .c12 = 0, .g = 5};
  constexpr double kLimit = 0.02;
  for (const bool has_limit : {false, true}) {
    loose.strain_limit = has_limit ? kLimit : 0;
    for (const auto& model : {test::on_mesh(kSheet, loose), test::springs_on(kSheet, loose.strain_limit)}) {
      ClothState state = make_state(model->topology->mesh.positions);
      const auto xpbd = make_xpbd({.substeps = 400});
      const Environment environment = test::hung_by(*model, {0, 8});
      double most = 0;
      for (int frame = 0; frame < 30; ++frame) {
        run(*xpbd, *model, environment, 1, state);
        const auto stretches = compute_principal_stretches(*model, state);
        most = std::max(most, stretches ? stretches->max - 1 : compute_strain(*model, state).max);
      }
      if (has_limit) {
        EXPECT_LT(most, 1.5 * kLimit);
      } else {
        EXPECT_GT(most, 2 * kLimit);
      }
    }
  }
}

}  // namespace
}  // namespace weft::engine
