#include "weft/world/particle_values.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "weft/error.h"
#include "weft/fabric.h"
#include "weft/mesh/grid.h"

namespace weft::engine {
namespace {

const Grid kGrid{.size_x = 1, .size_z = 1, .cells_x = 4, .cells_z = 4};

/// A sheet in the linear image of its rest positions.
World deformed(SpringModel model, const Mat3& gradient, const Vec3& velocity = Vec3::Zero()) {
  ClothParts sheet{.topology = build_grid_topology(kGrid, model), .velocity = velocity};
  for (const Vec3& p : sheet.topology->mesh.positions) sheet.positions.push_back(gradient * p);
  World world;
  world.add_cloth(sheet);
  return world;
}

std::vector<float> values(ParticleValue value, const World& world) {
  return compute_values(value, world, world.cloth(0));
}

TEST(ParticleValues, OfAStretchedSheetAreItsStretch) {
  Mat3 gradient = Mat3::Identity();
  gradient(0, 0) = 1.1;
  gradient(2, 2) = 1.1;
  const World world = deformed(SpringModel::simplified, gradient);
  for (const float strain : values(ParticleValue::strain, world))
    EXPECT_NEAR(strain, 10, 1e-3) << "per cent, floats";
  for (const float shear : values(ParticleValue::shear, world)) EXPECT_NEAR(shear, 0, 1e-3);
}

TEST(ParticleValues, OfAShearedSheetAreItsAngle) {
  const double angle = 12 * std::numbers::pi / 180;
  Mat3 gradient = Mat3::Identity();
  gradient.col(2) = Vec3(std::sin(angle), 0, std::cos(angle));
  for (const float shear : values(ParticleValue::shear, deformed(SpringModel::alternating, gradient)))
    EXPECT_NEAR(shear, 12, 1e-3);
}

TEST(ParticleValues, SpeedsAreThoseOfTheParticles) {
  const World world = deformed(SpringModel::simplified, Mat3::Identity(), Vec3(3, 0, 4));
  for (const float speed : values(ParticleValue::speed, world)) EXPECT_FLOAT_EQ(speed, 5);
}

TEST(ParticleValues, AMeshOfSpringsHasNoShear) {
  TriangleMesh mesh;
  mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 0, 1}};
  mesh.triangles = {{0, 1, 2}};
  World world;
  world.add_cloth({.topology = build_mesh_topology(mesh)});
  EXPECT_THROW(values(ParticleValue::shear, world), InputError);
}

TEST(ParticleValues, ASheetThatLiesOnTheFloorHasThePressureOfItsWeight) {
  World world = deformed(SpringModel::simplified, Mat3::Identity());
  world.add_collider({.shape = Plane{.point = {0, -0.001, 0}, .normal = {0, 1, 0}}});
  world.track_contacts(true);
  for (int step = 0; step < 60; ++step) ASSERT_TRUE(world.step(1.0 / 60).ok);
  const ClothModel& model = world.model(world.cloth(0));
  const double weight = model.material.density * 9.81;  // per area [Pa]
  const std::vector<float> pressures = values(ParticleValue::contact, world);
  double mean = 0;  // over the area
  double mass = 0;
  for (std::size_t i = 0; i < pressures.size(); ++i) {
    mean += pressures[i] * model.mass[i];
    mass += model.mass[i];
  }
  EXPECT_NEAR(mean / mass, weight, 0.02 * weight);
}

TEST(ParticleValues, YarnsOfAShearedFabricAreItsColumns) {
  ClothParts sheet{.topology = build_grid_topology(kGrid, SpringModel::simplified)};
  sheet.elements =
      build_grid_elements(kGrid, sheet.topology->mesh, GridWarp::first_axis, find_fabric("denim"));
  World world;
  const ClothId cloth = world.add_cloth(sheet);
  Mat3 gradient = Mat3::Identity();
  gradient(0, 0) = 1.2;
  gradient(2, 2) = 0.9;
  std::vector<Vec3> positions;
  for (const Vec3& p : sheet.topology->mesh.positions) positions.push_back(gradient * p);
  world.set_positions(cloth, positions);
  for (int t = 0; t < static_cast<int>(sheet.topology->mesh.triangles.size()); ++t) {
    const std::optional<Yarns> yarns = find_yarns(world.model(cloth), world.state(cloth), t);
    ASSERT_TRUE(yarns.has_value());
    EXPECT_NEAR(std::min(yarns->warp_strain(), yarns->weft_strain()), -10, 1e-4) << "floats";
    EXPECT_NEAR(std::max(yarns->warp_strain(), yarns->weft_strain()), 20, 1e-4);
    EXPECT_NEAR(yarns->shear(), 0, 1e-4);
  }
  EXPECT_FALSE(find_yarns(*build_cloth_model(sheet.topology, {}), world.state(cloth), 0)) << "of springs";
}

}  // namespace
}  // namespace weft::engine
