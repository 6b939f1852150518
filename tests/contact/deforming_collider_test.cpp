/// Deforming mesh colliders push cloth, and are never penetrated.

#include <gtest/gtest.h>

#include <cmath>

#include "tests/support.h"
#include "weft/animation/mesh_sequence.h"
#include "weft/mesh/sample_meshes.h"
#include "weft/run/frame_checks.h"
#include "weft/world/measures.h"

namespace weft::engine {
namespace {

const ClothMaterial kCotton{.structural = 200, .shear = 60, .bend = 0.5, .damping = 2e-3};

/// A ball that widens by this factor, flattens, and returns, in half a second each.
Collider make_pulsing_ball(double radius, double factor) {
  TriangleMesh ball = make_sphere_mesh(Vec3::Zero(), radius, 12);
  std::vector<Vec3> wide;
  for (const Vec3& p : ball.positions) wide.push_back(p.cwiseProduct(Vec3(factor, factor, factor)));
  MeshShape shape;
  shape.source = std::make_shared<const MeshSequence>(std::vector<MeshSequence::Key>{
      {0.0, ball.positions}, {0.2, ball.positions}, {0.4, wide}, {0.7, ball.positions}});
  shape.mesh = std::make_shared<const TriangleMesh>(std::move(ball));
  return {"ball", shape, 0.3, {}};
}

TEST(DeformingCollider, IsItsSequenceAtEveryTime) {
  const Collider ball = make_pulsing_ball(0.1, 2);
  const auto radius_at = [&](double time) {
    return std::get<MeshShape>(shape_at(ball, time)).vertex(5).norm();
  };
  EXPECT_NEAR(radius_at(0), 0.1, 1e-12);
  EXPECT_NEAR(radius_at(0.3), 0.15, 1e-12);
  EXPECT_NEAR(radius_at(0.4), 0.2, 1e-12);
  EXPECT_NEAR(radius_at(9), 0.1, 1e-12);
}

TEST(DeformingCollider, LiftsTheSheetThatLiesOnItAndIsNotPassedThrough) {
  for (const char* integrator : {"newton", "paper_fixed"}) {
    World world;
    world.set_integrator({.integrator = integrator});
    world.add_collider(make_pulsing_ball(0.1, 2));
    const auto topology = build_grid_topology(test::square(16, 0.4), SpringModel::alternating);
    std::vector<Vec3> positions;
    for (const Vec3& p : topology->mesh.positions) positions.push_back(p + Vec3(-0.19, 0.101, -0.21));
    const ClothId sheet =
        world.add_cloth({.name = "sheet", .topology = topology, .material = kCotton, .positions = positions});
    const WorldFrames frames(world);
    double highest = 0;
    const int steps_per_second = std::string(integrator) == "newton" ? 60 : 300;
    for (int s = 0; s < steps_per_second; ++s) {
      const StepReport report = world.step(1.0 / steps_per_second);
      ASSERT_TRUE(report.ok);
      EXPECT_TRUE(report.infeasible.empty());
      const FrameToCheck now = frames.now();
      const verify::FrameCheck check = verify::check_frame(now.frame, 1);
      ASSERT_EQ(check.intersections, 0) << integrator << ", step " << s;
      ASSERT_LE(check.penetration(), 1e-6) << integrator << ", step " << s;
      for (const Vec3& p : now.positions[0]) highest = std::max(highest, p.y());
    }
    EXPECT_GT(highest, 0.19) << integrator << ": it was lifted from 0.1 m to nearly 0.2 m";
    (void)sheet;
  }
}

TEST(DeformingCollider, ThatSnapsOpenInOneStepTakesClothAlong) {
  // From 5 cm to 20 cm within one step of 1/60 s: 9 m/s.
  TriangleMesh ball = make_sphere_mesh(Vec3::Zero(), 0.05, 12);
  std::vector<Vec3> wide;
  for (const Vec3& p : ball.positions) wide.push_back(4 * p);
  MeshShape shape;
  shape.source = std::make_shared<const MeshSequence>(
      std::vector<MeshSequence::Key>{{0.0, ball.positions}, {1.0 / 60, wide}});
  shape.mesh = std::make_shared<const TriangleMesh>(std::move(ball));
  World world;
  world.add_collider({"ball", shape, 0.3, {}});
  const auto topology = build_grid_topology(test::square(16, 0.4), SpringModel::alternating);
  std::vector<Vec3> positions;
  for (const Vec3& p : topology->mesh.positions) positions.push_back(p + Vec3(-0.19, 0.06, -0.21));
  world.add_cloth({.name = "sheet", .topology = topology, .material = kCotton, .positions = positions});
  for (int frame = 0; frame < 30; ++frame) {
    const StepReport report = world.step(1.0 / 60);
    ASSERT_TRUE(report.ok);
    EXPECT_TRUE(report.infeasible.empty()) << frame;
    const verify::FrameCheck check = verify::check_frame(WorldFrames(world).now().frame, 1);
    ASSERT_EQ(check.intersections, 0) << frame;
    ASSERT_LE(check.penetration(), 1e-6) << frame;
  }
}

}  // namespace
}  // namespace weft::engine
