/// Cloth with a measured stretch curve.

#include <gtest/gtest.h>

#include "tests/support.h"
#include "weft/world/measures.h"

namespace weft::engine {
namespace {

/// Jersey-like: soft at first, ten times as stiff beyond 4 %.
Fabric jersey() {
  return {.density = 0.2,
          .c11 = 100,
          .c22 = 80,
          .c12 = 0,
          .g = 20,
          .bend_warp = 1e-6,
          .bend_weft = 1e-6,
          .bend_bias = 1e-6,
          .damping = 0.02,
          .strain_limit = 0,
          .stretch_warp = {{0.04, 4}, {0.08, 44}},
          .stretch_weft = {{0.05, 4}, {0.1, 30}}};
}

/// A strip of 10 by 50 cm as triangles, its long side along x.
struct Strip {
  Grid grid{.size_x = 0.5, .size_z = 0.1, .cells_x = 20, .cells_z = 4};
  std::shared_ptr<const ClothModel> model;
  ClothState state;
  Environment environment;

  Strip(const Fabric& fabric, GridWarp warp) {
    const auto topology = build_grid_topology(grid, SpringModel::alternating);
    model = build_cloth_model(topology, {.density = fabric.density, .structural = 0, .shear = 0, .bend = 0},
                              build_grid_elements(grid, topology->mesh, warp, fabric));
    state = make_state(topology->mesh.positions);
  }

  /// Pins both short sides, with the far one pulled out.
  void pull(double extension) {
    environment.pins = {};
    for (int i = 0; i < model->num_particles(); ++i) {
      const int column = i % grid.num_columns();
      if (column != 0 && column != grid.cells_x) continue;
      const Vec3 rest = model->topology->mesh.positions[i];
      environment.pins.particle.push_back(i);
      environment.pins.position.push_back(rest + Vec3(column == 0 ? 0 : extension * grid.size_x, 0, 0));
    }
  }
};

TEST(StretchCurve, IsWhatAPulledStripShows) {
  for (const GridWarp warp : {GridWarp::first_axis, GridWarp::second_axis}) {
    const Fabric fabric = jersey();
    const auto& curve = warp == GridWarp::first_axis ? fabric.stretch_warp : fabric.stretch_weft;
    for (const StretchPoint& point : curve) {
      Strip strip(fabric, warp);
      strip.environment.gravity = Vec3::Zero();
      const auto integrator = test::integrator("newton");
      const auto energy_at = [&](double extension) {
        strip.pull(extension);
        test::advance(*integrator, *strip.model, strip.environment, 1.0 / 60, 120, strip.state);
        return compute_elastic_energy(*strip.model, strip.state);
      };
      // The force at an extension, from the work of a small additional extension.
      const double width = strip.grid.size_z, length = strip.grid.size_x, step = 0.002;
      energy_at(point.strain / 2);
      const double low = energy_at(point.strain - step), high = energy_at(point.strain);
      const double force = (high - low) / (step * length) / width;
      const StretchPoint before = &point == &curve.front() ? StretchPoint{} : curve.front();
      const double slope = (point.tension - before.tension) / (point.strain - before.strain);
      EXPECT_NEAR(force, point.tension - slope * step / 2, 0.03 * point.tension) << point.strain;
    }
  }
}

TEST(StretchCurve, MovesAlikeInFloatsAndInDoubles) {
  constexpr int kSubsteps = 8;
  const Fabric curved = jersey();
  Fabric straight = curved;
  straight.stretch_warp.clear();
  straight.stretch_weft.clear();
  const auto swing = [&](const Fabric& fabric, std::unique_ptr<Integrator> integrator) {
    Strip strip(fabric, GridWarp::first_axis);
    strip.environment.pins = {{0, strip.grid.num_columns() * strip.grid.cells_z}, {}};
    for (const int p : strip.environment.pins.particle)
      strip.environment.pins.position.push_back(strip.state.position(p));
    test::advance(*integrator, *strip.model, strip.environment, 1.0 / 60 / kSubsteps, 30 * kSubsteps,
                  strip.state);
    return strip.state;
  };
  const ClothState fast = swing(curved, make_newton({.quality = NewtonQuality::high}));
  const ClothState exact = swing(curved, make_integrator({.integrator = "newton", .is_double = true}));
  EXPECT_LT(test::rms_distance(fast, exact), 2e-3);
  EXPECT_GT(test::rms_distance(fast, swing(straight, make_newton({}))), 1.5e-2);
}

}  // namespace
}  // namespace weft::engine
