/// `newton` at every iteration count: more iterations never make the cloth worse.

#include <gtest/gtest.h>

#include <cmath>

#include "tests/support.h"

namespace weft::engine {
namespace {

/// Kinetic energy of the difference between a particle and the mean of its four neighbours [J]: the shortest
/// ripples of the grid count fully, waves of ten cells by a hundredth.
double short_wave_energy(const ClothModel& model, const ClothState& state) {
  const Grid& grid = *model.topology->grid;
  double energy = 0;
  for (int j = 1; j < grid.cells_z; ++j) {
    for (int i = 1; i < grid.cells_x; ++i) {
      const auto v = [&](int di, int dj) { return state.v.get(grid.index(i + di, j + dj)); };
      const Vec3 ripple = v(0, 0) - (v(-1, 0) + v(1, 0) + v(0, -1) + v(0, 1)) / 4;
      energy += 0.5 * model.mass[grid.index(i, j)] * ripple.squaredNorm() / 4;
    }
  }
  return energy;
}

TEST(NewtonIterations, MakeNoErrorAndNoRipplesHoweverMany) {
  constexpr int kCells = 63, kFrames = 60;
  const std::vector<int> counts = {5, 10, 20, 40, 100, 200};
  const auto topology = build_grid_topology(test::square(kCells), SpringModel::simplified);
  test::Hung exact(topology, kCells);
  std::vector<test::Hung> sheets(counts.size(), exact);
  std::vector<std::unique_ptr<Integrator>> integrators;
  for (const int count : counts) integrators.push_back(make_newton({.iterations = count}));
  const auto explicit_euler = test::integrator("explicit");
  const double limit = explicit_step_limit(*exact.model, {});
  const int substeps = static_cast<int>(std::ceil(1.0 / 60 / (0.25 * limit)));
  std::vector<double> error(counts.size(), 0.0), ripples(counts.size(), 0.0);
  double true_ripples = 0;
  for (int frame = 0; frame < kFrames; ++frame) {
    exact.advance_frame(*explicit_euler, substeps);
    true_ripples += short_wave_energy(*exact.model, exact.state) / kFrames;
    for (std::size_t c = 0; c < counts.size(); ++c) {
      sheets[c].advance_frame(*integrators[c], 1);
      error[c] += test::rms_distance(sheets[c].state, exact.state) / kFrames;
      ripples[c] += short_wave_energy(*exact.model, sheets[c].state) / kFrames;
    }
  }
  for (std::size_t c = 0; c < counts.size(); ++c) {
    EXPECT_LT(error[c], counts[c] < 10 ? 0.06 : 0.045) << counts[c] << "; 4 cm in a swing of a metre";
    EXPECT_LT(ripples[c], true_ripples) << counts[c] << "; steps of 1/60 s damp them to a hundredth";
  }
}

}  // namespace
}  // namespace weft::engine
