/// Stiffness per spring.

#include <gtest/gtest.h>

#include <limits>

#include "tests/support.h"
#include "weft/error.h"
#include "weft/world/measures.h"

namespace weft::engine {
namespace {

using test::Hung;
using test::rms_distance;
using test::square;

constexpr double kStep = 1.0 / 60;

const ClothMaterial kSoft = {.structural = 100, .shear = 50, .bend = 2, .damping = 1e-3};

/// The state after half a second in steps that suit the integrator.
ClothState swing(const char* name, const std::shared_ptr<const ClothTopology>& topology, int cells,
                 const ClothMaterial& material) {
  Hung sheet(topology, cells, material);
  const auto integrator = test::integrator(name);
  const int steps = integrator->num_substeps(*sheet.model, sheet.environment, kStep);
  for (int frame = 0; frame < 30; ++frame) sheet.advance_frame(*integrator, steps);
  return sheet.state;
}

TEST(SpringFactors, OfTwoAreTwiceTheStiffnessForEveryIntegrator) {
  constexpr int kCells = 9;
  ClothMaterial twice = kSoft;
  for (double* k : {&twice.structural, &twice.shear, &twice.bend}) *k *= 2;
  for (const auto& topology :
       {build_grid_topology(square(kCells), SpringModel::simplified),
        build_grid_topology(square(kCells), SpringModel::alternating),
        build_grid_topology(square(kCells), SpringModel::basic), test::mesh_of(square(kCells))}) {
    ClothMaterial factors = kSoft;
    factors.spring_factors.assign(topology->springs.size(), 2.0);
    for (const char* name : {"explicit", "paper_fixed", "desbrun", "implicit_euler", "newton", "xpbd"}) {
      const ClothState expected = swing(name, topology, kCells, twice);
      EXPECT_LT(rms_distance(swing(name, topology, kCells, factors), expected), 1e-3) << name;
      EXPECT_GT(rms_distance(swing(name, topology, kCells, kSoft), expected), 2e-3) << name;
    }
  }
}

TEST(SpringFactors, OfAnyKindAreTheSameOnAGridAsInATable) {
  constexpr int kCells = 12;
  for (const SpringModel model : {SpringModel::simplified, SpringModel::alternating, SpringModel::basic}) {
    const auto grid = build_grid_topology(square(kCells), model);
    auto table = std::make_shared<ClothTopology>(*grid);
    table->grid.reset();
    table->table = build_neighbour_table(table->num_particles(), table->springs);
    ClothMaterial material = kSoft;
    material.damping_time = 0.01;
    Random random(7);
    for (std::size_t s = 0; s < grid->springs.size(); ++s)
      material.spring_factors.push_back(random.uniform(0.1, 10.0));
    const auto converged = make_newton({.iterations = 300});
    Hung stencils(grid, kCells, material), entries(table, kCells, material);
    for (int frame = 0; frame < 30; ++frame) {
      stencils.advance_frame(*converged, 1);
      entries.advance_frame(*make_newton({.iterations = 300}), 1);
    }
    EXPECT_LT(rms_distance(stencils.state, entries.state), 5e-4) << to_string(model);
    const double energy = compute_elastic_energy(*stencils.model, stencils.state);
    EXPECT_NEAR(compute_elastic_energy(*entries.model, entries.state), energy, 1e-3 * energy);
  }
}

/// A strip hung by its short end whose upper half is four times as stiff: each half extends by the weight
/// below it over the stiffness of its rows.
TEST(SpringFactors, MakeTheStiffHalfOfAHungStripStretchAsMuchLessAsItShould) {
  constexpr int kAcross = 2, kAlong = 40;
  const Grid grid{.size_x = 0.05, .size_z = 1, .cells_x = kAcross, .cells_z = kAlong};
  const auto topology = build_grid_topology(grid, SpringModel::simplified);
  ClothMaterial material{.density = 0.2, .structural = 100, .shear = 0, .bend = 0, .damping = 0.05};
  const auto row = [&](int p) { return p / grid.num_columns(); };
  for (const Spring& s : topology->springs)
    material.spring_factors.push_back(std::max(row(s.i), row(s.j)) <= kAlong / 2 ? 4.0 : 1.0);
  Hung strip(topology, kAcross, material);
  strip.environment.pins = {};
  for (int i = 0; i <= kAcross; ++i) {
    strip.environment.pins.particle.push_back(i);
    strip.environment.pins.position.push_back(strip.state.position(i));
  }
  for (int i = 0; i < strip.model->num_particles(); ++i) {
    const Vec3 flat = strip.state.position(i);
    strip.state.set_position(i, {flat.x(), -flat.z(), 0});  // hanging from the start
  }
  for (std::size_t p = 0; p < strip.environment.pins.particle.size(); ++p)
    strip.environment.pins.position[p] = strip.state.position(static_cast<std::size_t>(p));
  const auto integrator = test::integrator("newton");
  test::advance(*integrator, *strip.model, strip.environment, kStep, 1200, strip.state);
  const auto height = [&](int j) { return strip.state.position(grid.index(1, j)).y(); };
  // The middle column, whose particles carry half of the width: w(s) = density · width/2 · g · s below.
  const double per_metre = 0.2 * 0.05 / 2 * 9.81;
  const double spacing = 1.0 / kAlong;
  double expected_upper = 0, expected_lower = 0;
  for (int j = 0; j < kAlong; ++j) {
    const double below = per_metre * (1 - (j + 0.5) * spacing);
    (j < kAlong / 2 ? expected_upper : expected_lower) += below / (j < kAlong / 2 ? 400 : 100);
  }
  EXPECT_NEAR(height(0) - height(kAlong / 2), 0.5 + expected_upper, 0.01 * expected_upper);
  EXPECT_NEAR(height(kAlong / 2) - height(kAlong), 0.5 + expected_lower, 0.01 * expected_lower);
}

TEST(SpringFactors, ThatAreNoneAreRefused) {
  const auto topology = build_grid_topology(square(2), SpringModel::simplified);
  ClothMaterial material;
  material.spring_factors.assign(3, 1.0);
  EXPECT_THROW(build_cloth_model(topology, material), InputError);
  for (const double bad : {-1.0, std::numeric_limits<double>::quiet_NaN()}) {
    material.spring_factors.assign(topology->springs.size(), 1.0);
    material.spring_factors.back() = bad;
    EXPECT_THROW(build_cloth_model(topology, material), InputError);
  }
}

}  // namespace
}  // namespace weft::engine
