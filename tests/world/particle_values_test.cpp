#include "weft/world/particle_values.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "weft/error.h"

namespace weft::engine {
namespace {

const Grid kGrid{.size_x = 1, .size_z = 1, .cells_x = 4, .cells_z = 4};

/// The sheet in the linear image of its rest positions.
ClothState deform(const ClothModel& model, const Mat3& gradient) {
  std::vector<Vec3> positions;
  for (const Vec3& p : model.topology->mesh.positions) positions.push_back(gradient * p);
  return make_state(positions);
}

TEST(ParticleValues, OfAStretchedSheetAreItsStretch) {
  const auto model = build_cloth_model(build_grid_topology(kGrid, SpringModel::simplified), {});
  Mat3 gradient = Mat3::Identity();
  gradient(0, 0) = 1.1;
  gradient(2, 2) = 1.1;
  for (const float strain : compute_values(ParticleValue::strain, *model, deform(*model, gradient)))
    EXPECT_NEAR(strain, 10, 1e-3) << "per cent, floats";
  for (const float shear : compute_values(ParticleValue::shear, *model, deform(*model, gradient)))
    EXPECT_NEAR(shear, 0, 1e-3);
}

TEST(ParticleValues, OfAShearedSheetAreItsAngle) {
  const auto model = build_cloth_model(build_grid_topology(kGrid, SpringModel::alternating), {});
  const double angle = 12 * std::numbers::pi / 180;
  Mat3 gradient = Mat3::Identity();
  gradient.col(2) = Vec3(std::sin(angle), 0, std::cos(angle));
  for (const float shear : compute_values(ParticleValue::shear, *model, deform(*model, gradient)))
    EXPECT_NEAR(shear, 12, 1e-3);
}

TEST(ParticleValues, SpeedsAreThoseOfTheParticles) {
  const auto model = build_cloth_model(build_grid_topology(kGrid, SpringModel::simplified), {});
  ClothState state = deform(*model, Mat3::Identity());
  for (std::size_t i = 0; i < state.v.size(); ++i) state.v.set(i, Vec3(3, 0, 4));
  for (const float speed : compute_values(ParticleValue::speed, *model, state)) EXPECT_FLOAT_EQ(speed, 5);
}

TEST(ParticleValues, AMeshOfSpringsHasNoShear) {
  TriangleMesh mesh;
  mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 0, 1}};
  mesh.triangles = {{0, 1, 2}};
  const auto model = build_cloth_model(build_mesh_topology(mesh), {});
  EXPECT_THROW(compute_values(ParticleValue::shear, *model, make_state(mesh.positions)), InputError);
}

}  // namespace
}  // namespace weft::engine
