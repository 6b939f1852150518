#include "weft/pictures/scene_picture.h"

#include <gtest/gtest.h>

#include "weft/run/film.h"
#include "weft/run/scene_run.h"
#include "weft/scene/scene_library.h"
#include "weft/scene/scene_reader.h"
#include "weft/scene/scene_world.h"

namespace weft::engine {
namespace {

Animation simulate(const char* scene, int frames) {
  const SceneDesc desc =
      read_scene(find_scene(scene),
                 {"cloth[0].grid.cells=[6, 6]", "solver.steps_per_frame=2", "solver.integrator=paper_fixed"});
  FilmSink film;
  run_scene(desc, {.frames = frames}, {&film});
  return film.animation();
}

Picture draw(const Animation& animation, int frame, const SceneStyle& style = {}, const Camera& camera = {}) {
  return ScenePictures(animation, get_frame(animation, 0), style).at(get_frame(animation, frame), camera);
}

std::vector<int> shown(const Animation& animation) {
  const AnimationFrame start = get_frame(animation, 0);
  return ScenePictures(animation, start).shown(start);
}

TEST(ScenePictures, ShowClothAndBodies) {
  const Animation animation = simulate("paper/fig6_ball", 2);
  FramesInMemory frames(animation);
  const Picture picture = draw(animation, 1, {.ground = find_ground(frames)});
  ASSERT_EQ(picture.meshes.size(), 2u);
  EXPECT_EQ(picture.meshes[0].look.kind, Look::Kind::fabric);
  EXPECT_EQ(picture.meshes[0].positions, animation.cloths[0].frames[1]);
  EXPECT_EQ(picture.meshes[0].fabric_coordinates.size(), 2u * 49);
  EXPECT_EQ(picture.meshes[1].look.kind, Look::Kind::solid);
  ASSERT_TRUE(picture.ground);
  EXPECT_LT(*picture.ground, 0.1) << "below the ball";
}

TEST(ScenePictures, DrawALevelPlaneAsGroundAtItsHeight) {
  const Animation animation = simulate("contact/rotating_ball", 1);
  const Picture picture = draw(animation, 0);
  const Plane* floor = nullptr;
  for (const AnimatedBody& body : animation.bodies) {
    if (body.shape && std::holds_alternative<Plane>(*body.shape)) floor = &std::get<Plane>(*body.shape);
  }
  ASSERT_NE(floor, nullptr) << "the scene has a floor";
  EXPECT_EQ(picture.meshes.size(), animation.cloths.size() + animation.bodies.size() - 1);
  EXPECT_TRUE(picture.ground);
  FramesInMemory frames(animation);
  EXPECT_FALSE(find_ground(frames)) << "no other one is needed";
}

TEST(ScenePictures, GroundFollowsALevelPlaneThatMoves) {
  Animation animation = simulate("contact/rotating_ball", 1);
  for (AnimatedBody& body : animation.bodies) {
    if (!body.shape || !std::holds_alternative<Plane>(*body.shape)) continue;
    body.poses.resize(2, body.poses[0]);
    body.poses[1].translation.y() += 0.1;
  }
  EXPECT_NEAR(*draw(animation, 1).ground, *draw(animation, 0).ground + 0.1, 1e-12);
}

TEST(ScenePictures, SayWhatTheirMeshesShow) {
  Animation animation = simulate("contact/rotating_ball", 1);
  const std::vector<int> shown = engine::shown(animation);
  const std::vector<DrawnMesh> meshes = draw(animation, 0).meshes;
  ASSERT_EQ(shown.size(), meshes.size() + 1) << "the ground comes last";
  const int num_cloths = static_cast<int>(animation.cloths.size());
  for (std::size_t m = 0; m < meshes.size(); ++m) {
    EXPECT_EQ(meshes[m].triangles, shown[m] < num_cloths
                                       ? animation.cloths[shown[m]].triangles
                                       : animation.bodies[shown[m] - num_cloths].mesh.triangles);
  }
  const AnimatedBody& floor = animation.bodies[shown.back() - num_cloths];
  EXPECT_TRUE(floor.shape && std::holds_alternative<Plane>(*floor.shape));
  animation.bodies.clear();
  EXPECT_EQ(engine::shown(animation).back(), -1) << "a ground below all frames is no body";
}

TEST(ScenePictures, DrawEverySpringAsAskedFor) {
  const Animation animation = simulate("paper/fig3_horizontal", 1);
  const auto topology =
      build_grid_topology({.size_x = 1, .size_z = 1, .cells_x = 6, .cells_z = 6}, SpringModel::simplified);
  const Picture picture = draw(animation, 0, {.transparent = true, .ground = {}, .springs = {{0, topology}}});
  EXPECT_TRUE(picture.meshes.empty());
  ASSERT_EQ(picture.lines.size(), 3u);
  const auto count = [&](SpringKind kind) {
    return static_cast<std::size_t>(std::count_if(topology->springs.begin(), topology->springs.end(),
                                                  [&](const Spring& s) { return s.kind == kind; }));
  };
  EXPECT_EQ(picture.lines[0].ends.size() % count(SpringKind::bend), 0u);
  EXPECT_EQ(picture.lines[1].ends.size(), 2 * count(SpringKind::shear));
  EXPECT_EQ(picture.lines[2].ends.size(), 2 * count(SpringKind::structural));
  EXPECT_EQ(picture.dots[0].positions.size(), 49u);
}

TEST(ScenePictures, SmoothClothPassesItsParticlesAndBodiesStayBelow) {
  const Animation animation = simulate("paper/fig6_ball", 20);
  const Picture plain = draw(animation, 20), smooth = draw(animation, 20, {.ground = {}, .smooth = 2});
  EXPECT_EQ(smooth.meshes[0].triangles.size(), 16 * plain.meshes[0].triangles.size());
  for (std::size_t k = 0; k < plain.meshes[0].positions.size(); ++k)
    EXPECT_NEAR(smooth.meshes[0].positions[k], plain.meshes[0].positions[k], 0.05) << "a third of an edge";
  EXPECT_EQ(smooth.meshes[0].fabric_coordinates.size(), smooth.meshes[0].positions.size() / 3 * 2);
  Eigen::AlignedBox3f before, after;
  for (std::size_t k = 0; k < plain.meshes[1].positions.size(); k += 3) {
    before.extend(Eigen::Map<const Eigen::Vector3f>(&plain.meshes[1].positions[k]));
    after.extend(Eigen::Map<const Eigen::Vector3f>(&smooth.meshes[1].positions[k]));
  }
  EXPECT_TRUE(before.contains(after));
  EXPECT_NEAR((before.sizes() - after.sizes()).maxCoeff(), 0.01f, 1e-3f) << "5 mm on each side";
}

TEST(ScenePictures, CloseUpSmoothClothHasHems) {
  const Animation animation = simulate("paper/fig6_ball", 0);
  const SceneStyle style{.ground = {}, .smooth = 0};
  const std::size_t far = draw(animation, 0, style, {.distance = 5}).meshes[0].triangles.size(),
                    near = draw(animation, 0, style, {.distance = 0.3}).meshes[0].triangles.size();
  EXPECT_EQ(far, animation.cloths[0].triangles.size());
  EXPECT_EQ(near, far + 24u * 2 * Hem::kSides) << "24 border edges of 6 by 6 cells";
}

TEST(ScenePictures, ClothOfAPresetHasItsWeaveAndOtherClothChecks) {
  Animation animation = simulate("paper/fig6_ball", 0);
  EXPECT_GT(draw(animation, 0).meshes[0].look.check_size, 0);
  animation.cloths[0].fabric = "denim";
  const Look look = draw(animation, 0).meshes[0].look;
  EXPECT_EQ(look.check_size, 0);
  EXPECT_EQ(look.fabric, weft::find_fabric_preset("denim").look);
  EXPECT_EQ(look.fabric.weave, weft::Weave::twill);
}

TEST(ScenePictures, ValuesKeepTheirRangeInAllFrames) {
  const Animation animation = simulate("paper/fig5_falling", 10);
  FramesInMemory frames(animation);
  FramesWithSpeeds speeds(frames);
  const std::array<double, 2> range = find_range(speeds, {0, 5, 10});
  EXPECT_EQ(range[0], 0) << "at the start";
  EXPECT_NEAR(range[1], 9.81 * 9.5 / animation.frames_per_second, 0.1) << "a free fall's";
  const AnimationFrame frame = speeds.read(5);
  const Picture picture =
      ScenePictures(animation, speeds.read(0), {.ground = {}, .range = range}).at(frame, {});
  EXPECT_EQ(picture.meshes[0].values, frame.values[0]);
  EXPECT_EQ(picture.meshes[0].range, range);
}

TEST(FrameScene, OfClothLeavesBodiesOut) {
  Animation animation = simulate("paper/fig6_ball", 0);
  FramesInMemory frames(animation);
  const Camera all = frame_scene(frames, {0}, {}, 1.5),
               cloth = frame_scene(frames, {0}, {}, 1.5, Framed::cloth);
  EXPECT_GT(all.distance, cloth.distance);
  animation.bodies.clear();
  FramesInMemory bare(animation);
  EXPECT_EQ(frame_scene(bare, {0}, {}, 1.5).distance, cloth.distance);
}

TEST(FrameScene, HoldsTheWholeMotion) {
  const Animation animation = simulate("paper/fig5_falling", 30);
  FramesInMemory frames(animation);
  const Camera whole = frame_scene(frames, {0, 15, 30}, {}, 1.5), start = frame_scene(frames, {0}, {}, 1.5);
  EXPECT_GT(whole.distance, start.distance);
  EXPECT_LT(whole.target.y(), start.target.y());
}

}  // namespace
}  // namespace weft::engine
