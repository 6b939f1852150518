#include "weft/run/frame_checks.h"

#include <gtest/gtest.h>

#include <memory>

#include "weft/mesh/grid.h"

namespace weft::engine {
namespace {

constexpr double kQuarterTurn = 90;  // [degrees]

/// A level sheet of one metre, its corner at the origin.
World make_sheet() {
  World world;
  const Grid grid{.size_x = 1, .size_z = 1, .cells_x = 4, .cells_z = 4};
  world.add_cloth({.name = "sheet", .topology = build_grid_topology(grid, SpringModel::alternating)});
  return world;
}

/// A square plate above the sheet that rotates about its own origin.
std::shared_ptr<const TriangleMesh> make_plate() {
  return std::make_shared<TriangleMesh>(make_square_mesh({0, 0, 0}, Vec3::UnitY(), 0.3));
}

TEST(FrameChecks, TakeMeshesWhereTheirMotionHasTakenThem) {
  World world = make_sheet();
  world.set_gravity(Vec3::Zero());
  world.set_contact(false);
  // The plate is 0.1 above the sheet, and after a second upright through it.
  const RigidMotion turn({{.time = 0}, {.time = 1, .angles_deg = {kQuarterTurn, 0, 0}}});
  world.add_collider({.name = "plate",
                      .shape = MeshShape{make_plate(), Mat3::Identity(), {0.4, 0.1, 0.4}},
                      .friction = 0.3,
                      .motion = turn});
  const WorldFrames frames(world);
  EXPECT_EQ(verify::check_frame(frames.now().frame).intersections, 0);
  world.step(1);
  const verify::FrameCheck check = verify::check_frame(frames.now().frame);
  EXPECT_GT(check.intersections, 0);
  EXPECT_FALSE(check.deepest.has_value()) << "a plate has no inside";
}

TEST(FrameChecks, SayWhereClothCrosses) {
  Animation meshes;
  meshes.cloths.push_back({.name = "rag", .triangles = {{0, 1, 2}, {3, 4, 5}}});
  AnimationFrame frame;
  // The second triangle stands upright through the first.
  frame.cloths = {{0, 0, 0, 1, 0, 0, 0, 0, 1, 0.2f, -1, 0.2f, 0.3f, 1, 0.2f, 0.2f, -1, 0.3f}};
  const FrameFindings found = check_frame(meshes, frame, 10);
  EXPECT_EQ(found.intersections, 1);
  ASSERT_EQ(found.places.size(), 1u);
  EXPECT_LT((found.places[0] - Vec3(1, 0, 1) / 3).norm(), 1) << "at a centre of the two";
  ASSERT_EQ(found.sentences.size(), 1u);
  EXPECT_NE(found.sentences[0].find("\"rag\""), std::string::npos) << found.sentences[0];
  EXPECT_FALSE(found.penetration.has_value()) << "there is no collider";
  frame.cloths[0] = {0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 1, 0, 1, 1, 0, 0, 1, 1};
  EXPECT_EQ(check_frame(meshes, frame, 10).intersections, 0);
}

TEST(FrameChecks, KnowTheInsideOfClosedMeshes) {
  World world = make_sheet();
  const auto ball = std::make_shared<TriangleMesh>(make_sphere_mesh({0, 0, 0}, 0.4, 32));
  world.add_collider(
      {.name = "ball", .shape = MeshShape{ball, Mat3::Identity(), {0.5, 0.1, 0.5}}, .motion = {}});
  const verify::FrameCheck check = verify::check_frame(WorldFrames(world).now().frame);
  EXPECT_NEAR(check.penetration(), 0.3, 0.01)
      << "the sheet's middle is 0.1 from the centre; the mesh is inscribed";
}

/// One triangle above a rising sphere; at frame 3 it is 0.05 deep.
Animation make_animation() {
  Animation animation;
  AnimatedCloth cloth{.name = "rag", .triangles = {{0, 1, 2}}, .frames = {}};
  cloth.frames.assign(5, {-1, 1, -1, 1, 1, -1, 0, 1, 2});
  animation.cloths.push_back(cloth);
  AnimatedBody ball{.name = "ball", .mesh = make_sphere_mesh({0, 0, 0}, 0.5, 4), .poses = {}};
  ball.shape = Sphere{Vec3::Zero(), 0.5};
  for (const double height : {0.1, 0.2, 0.3, 0.55, 0.5}) {
    ball.poses.push_back({{0, height, 0}, Eigen::Quaterniond::Identity()});
  }
  animation.bodies.push_back(ball);
  return animation;
}

AnimationCheck check(const Animation& animation, const AnimationCheckOptions& options = {}) {
  FramesInMemory frames(animation);
  return check_animation(frames, options);
}

TEST(FrameChecks, TellTheDeepestFrameOfAnAnimation) {
  const AnimationCheck result = check(make_animation());
  EXPECT_EQ(result.frames, 5);
  EXPECT_EQ(result.intersections, 0);
  EXPECT_FALSE(result.is_clean);
  EXPECT_NEAR(*result.penetration_max, 0.05, 1e-12);
  EXPECT_EQ(result.deepest_frame, 3);
  EXPECT_EQ(result.deepest_place, "cloth \"rag\" triangle 0 in collider \"ball\"");
  ASSERT_EQ(result.offences.size(), 1u);
  EXPECT_EQ(result.offences[0].frame, 3);
  EXPECT_TRUE(check(make_animation(), {.tolerance = 0.051}).is_clean);
}

TEST(FrameChecks, CountFramesThatCross) {
  Animation animation = make_animation();
  AnimatedCloth blade{.name = "blade", .triangles = {{0, 1, 2}}, .frames = {}};
  for (const float depth : {0.0f, 0.5f, 0.0f, 0.5f, 0.5f}) {
    blade.frames.push_back({0.1f, 2, 0, 0.2f, 2, 0, 0.1f, 1.2f - depth, 0.1f});
  }
  animation.cloths.push_back(blade);
  const AnimationCheck result = check(animation, {.tolerance = 1});
  EXPECT_EQ(result.frames_with_crossings, 3);
  EXPECT_EQ(result.intersections, 1);
  EXPECT_EQ(result.worst_frame, 1);
  ASSERT_EQ(result.offences.size(), 3u);
  EXPECT_EQ(result.offences[0].what, "cloth \"rag\" triangle 0 intersects cloth \"blade\" triangle 0");
}

TEST(FrameChecks, TellWhatMayHavePassedBetweenFrames) {
  Animation animation = make_animation();
  AnimatedCloth blade{.name = "blade", .triangles = {{0, 1, 2}}, .frames = {}};
  for (const float depth : {0.0f, 5.0f, 5.0f, 0.0f, 0.0f})  // completely below the rag, and back
    blade.frames.push_back({0.1f, 4 - depth, 0, 0.2f, 4 - depth, 0, 0.1f, 3 - depth, 0.1f});
  animation.cloths.push_back(blade);
  const AnimationCheck result = check(animation, {.tolerance = 1});
  EXPECT_EQ(result.intersections, 0);
  EXPECT_EQ(result.passages, 6) << "three corners, twice";
  ASSERT_EQ(result.possible_passages.size(), 2u);
  EXPECT_EQ(result.possible_passages[0].frame, 1);
  EXPECT_EQ(result.possible_passages[0].what,
            "cloth \"blade\" particle 0 passes through cloth \"rag\" triangle 0 (and 2 more)");
  EXPECT_EQ(result.possible_passages[1].frame, 3);
  EXPECT_TRUE(result.is_clean) << "straight lines between frames are a guess";
  EXPECT_FALSE(check(animation, {.tolerance = 1, .passages_offend = true}).is_clean);
}

}  // namespace
}  // namespace weft::engine
