#include "weft/render/pick.h"

#include <gtest/gtest.h>

#include <array>

#include "weft/mesh/solid.h"

namespace weft::engine {
namespace {

DrawnMesh drawn(const TriangleMesh& mesh) {
  DrawnMesh result{.triangles = mesh.triangles};
  for (const Vec3& p : mesh.positions) {
    for (const double c : p) result.positions.push_back(static_cast<float>(c));
  }
  return result;
}

const Camera kCamera = {.target = {0, 0, 0}, .distance = 4};
constexpr PictureSize kSize = {640, 360};

TEST(Pick, FindsThePointOfABallThatFacesTheCamera) {
  const std::array meshes = {drawn(make_sphere_mesh(Vec3::Zero(), 1, 24))};
  const auto hit = find_first_hit(meshes, kCamera.ray(320, 180, kSize));
  ASSERT_TRUE(hit.has_value());
  // The mesh is up to 1 - cos(π/48) inside the sphere.
  EXPECT_NEAR(hit->distance, 3, 0.005);
  EXPECT_NEAR(hit->weights.sum(), 1, 1e-12);
  Vec3 point = Vec3::Zero();
  for (int corner = 0; corner < 3; ++corner) {
    const int v = meshes[0].triangles[hit->triangle][corner];
    for (int axis = 0; axis < 3; ++axis)
      point[axis] += hit->weights[corner] * meshes[0].positions[3 * v + axis];
  }
  EXPECT_LT((point - hit->point).norm(), 1e-6) << "floats";
}

TEST(Pick, TheNearerMeshHidesTheFartherOne) {
  const std::array meshes = {drawn(make_sphere_mesh(-2 * kCamera.forward(), 0.2, 16)),
                             drawn(make_sphere_mesh(Vec3::Zero(), 1, 24))};
  const auto middle = find_first_hit(meshes, kCamera.ray(320, 180, kSize));
  ASSERT_TRUE(middle.has_value());
  EXPECT_EQ(middle->mesh, 0);
  const auto beside = find_first_hit(meshes, kCamera.ray(400, 180, kSize));
  ASSERT_TRUE(beside.has_value());
  EXPECT_EQ(beside->mesh, 1);
}

TEST(Pick, ClothIsMetFromBothSides) {
  for (const double side : {1.0, -1.0}) {
    const std::array meshes = {drawn(make_square_mesh(Vec3::Zero(), side * kCamera.forward(), 1))};
    EXPECT_TRUE(find_first_hit(meshes, kCamera.ray(321, 182, kSize)).has_value()) << side;
  }
}

TEST(Pick, ARayThatMissesMeetsNothing) {
  const std::array meshes = {drawn(make_sphere_mesh(Vec3::Zero(), 0.1, 16))};
  EXPECT_FALSE(find_first_hit(meshes, kCamera.ray(5, 5, kSize)).has_value());
  EXPECT_FALSE(find_first_hit({}, kCamera.ray(5, 5, kSize)).has_value());
  // Nor are points behind the eye.
  const Ray away{kCamera.eye(), -kCamera.forward()};
  EXPECT_FALSE(find_first_hit(meshes, away).has_value());
}

}  // namespace
}  // namespace weft::engine
