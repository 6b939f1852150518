#include "weft/run/live.h"

#include <gtest/gtest.h>

#include <functional>

#include "tests/run/shipped.h"
#include "weft/error.h"
#include "weft/run/scene_run.h"
#include "weft/scene/pin_edits.h"
#include "weft/scene/scene_changes.h"
#include "weft/scene/tunables.h"

namespace weft::engine {
namespace {

/// 13 x 13 particles over a ball, six steps a frame, soft enough for every integrator.
SceneDesc small_scene(const std::string& integrator = "paper_fixed") {
  return shipped("paper/fig6_ball", {"cloth[0].grid.cells=[12, 12]", "solver.steps_per_frame=6",
                                     "solver.integrator=" + integrator});
}

/// Polls until a frame satisfies the condition. Long timeout, because other processes may be busy.
LiveFrame wait_for(LiveSimulation& live, const std::function<bool(const LiveFrame&)>& is_wanted) {
  LiveFrame frame;
  const auto start = std::chrono::steady_clock::now();
  while (std::chrono::steady_clock::now() - start < std::chrono::seconds(60)) {
    if (live.take_newest(frame) && is_wanted(frame)) return frame;
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  ADD_FAILURE() << "nothing came; the last frame has step " << frame.status.steps << ", "
                << frame.status.failure;
  return frame;
}

LiveFrame wait_for_steps(LiveSimulation& live, std::int64_t steps) {
  return wait_for(live, [&](const LiveFrame& f) { return f.status.steps >= steps; });
}

std::uint64_t hash_of_run(const SceneDesc& scene, int frames) {
  const RunReport report = run_scene(scene, {.frames = frames});
  return std::stoull(report.state_hash, nullptr, 16);
}

double mean_height(const LiveFrame& frame) {
  double sum = 0;
  for (std::size_t i = 1; i < frame.meshes.cloths[0].size(); i += 3) sum += frame.meshes.cloths[0][i];
  return 3 * sum / static_cast<double>(frame.meshes.cloths[0].size());
}

TEST(Live, PlaysInRealTimeAndHasTheBitsOfARunHoweverOftenItIsPausedAndLookedAt) {
  const SceneDesc scene = small_scene();
  LiveSimulation live(scene);
  wait_for_steps(live, 30);
  live.pause();
  LiveFrame frame = wait_for(live, [](const LiveFrame& f) { return !f.status.playing; });
  live.play();
  wait_for_steps(live, frame.status.steps + 12);
  live.pause();
  frame = wait_for(live, [](const LiveFrame& f) { return !f.status.playing; });
  constexpr int kFrames = 60;
  ASSERT_LT(frame.status.steps, 6 * kFrames) << "it has not raced ahead of the clock";
  live.step(6 * kFrames - static_cast<int>(frame.status.steps));
  frame = wait_for_steps(live, 6 * kFrames);
  EXPECT_EQ(frame.status.frames, kFrames);
  EXPECT_NEAR(frame.status.time, 1, 1e-9);
  EXPECT_EQ(live.state_hash(), hash_of_run(scene, kFrames));
}

TEST(Live, StandsStillUntilToldToPlay) {
  LiveSimulation live(small_scene(), {.playing = false});
  const LiveFrame frame = wait_for(live, [](const LiveFrame&) { return true; });
  EXPECT_EQ(frame.status.steps, 0);
  EXPECT_FALSE(frame.status.playing);
  EXPECT_EQ(frame.meshes.cloths[0].size(), 3u * 13 * 13);
  EXPECT_EQ(frame.meshes.poses.size(), 1u);
  EXPECT_EQ(live.start().cloths[0].frames[0], frame.meshes.cloths[0]);
}

TEST(Live, MakesSingleStepsAndPausesForThem) {
  LiveSimulation live(small_scene());
  wait_for_steps(live, 6);
  live.step();
  wait_for(live, [](const LiveFrame& f) { return !f.status.playing; });
  // The step may be pending still; a reset drops it, and the count is known.
  live.reset();
  wait_for(live, [](const LiveFrame& f) { return f.status.steps == 0; });
  live.step();
  const LiveFrame after = wait_for_steps(live, 1);
  EXPECT_EQ(after.status.steps, 1);
  EXPECT_FALSE(after.status.playing);
  live.step(3);
  EXPECT_EQ(wait_for_steps(live, 4).status.steps, 4);
}

TEST(Live, ResetGoesBackToTheStartBitByBit) {
  LiveSimulation live(small_scene(), {.playing = false});
  const std::uint64_t start = live.state_hash();
  live.step(20);
  wait_for_steps(live, 20);
  const std::uint64_t later = live.state_hash();
  EXPECT_NE(later, start);
  live.reset();
  EXPECT_EQ(live.state_hash(), start);
  wait_for(live, [](const LiveFrame& f) { return f.status.steps == 0; });
  live.step(20);
  wait_for_steps(live, 20);
  EXPECT_EQ(live.state_hash(), later);
}

TEST(Live, EveryIntegratorTakesOverFromEveryOther) {
  LiveSimulation live(small_scene(), {.playing = false});
  std::int64_t steps = 0;
  for (const std::string_view name : integrator_names()) {
    live.set_integrator(std::string(name));
    live.step(3);
    const LiveFrame frame = wait_for_steps(live, steps += 3);
    EXPECT_EQ(frame.status.integrator, name);
    EXPECT_EQ(frame.status.failure, "");
  }
  EXPECT_THROW(live.set_integrator("verlet"), InputError);
}

TEST(Live, AnIntegratorThatDoesNotSupportTheSceneIsRefusedAndPlayGoesOn) {
  struct Case {
    const char *change, *name, *why;
  };
  for (const auto& [change, name, why] :
       std::initializer_list<Case>{{"cloth[0].fabric=silk", "paper", "paper supports springs only"},
                                   {"cloth[0].fabric=denim", "xpbd", "xpbd does not support bend_hysteresis"},
                                   {"solver.adaptive=true", "xpbd", "xpbd does not support step division"},
                                   {"solver.precision=double", "xpbd", "xpbd does not support \"double\""}}) {
    LiveSimulation live(shipped("drape_sphere", {change, "cloth[0].grid.cells=[8, 8]"}), {.playing = false});
    live.set_integrator(name);
    const LiveFrame refused = wait_for(live, [](const LiveFrame& f) { return !f.status.warnings.empty(); });
    EXPECT_EQ(refused.status.warnings[0].find(std::string("keeping newton: ") + why), 0u)
        << refused.status.warnings[0];
    live.step(3);
    EXPECT_EQ(wait_for_steps(live, 3).status.failure, "");
  }
}

TEST(Live, SpringModelsChangeWhereTheClothIs) {
  LiveSimulation live(small_scene(), {.playing = false});
  live.step(30);
  const LiveFrame before = wait_for_steps(live, 30);
  EXPECT_EQ(before.status.model, "simplified");
  live.set_model(SpringModel::basic);
  const LiveFrame after = wait_for(live, [](const LiveFrame& f) { return f.status.model == "basic"; });
  EXPECT_EQ(after.meshes.cloths, before.meshes.cloths);
  EXPECT_GT(after.topologies[0]->springs.size(), before.topologies[0]->springs.size());
  live.step(30);
  EXPECT_EQ(wait_for_steps(live, 60).status.failure, "");
}

TEST(Live, WindBlowsWhileItIsSet) {
  // A sheet without other sideways forces.
  SceneDesc scene = shipped("paper/fig5_falling", {"cloth[0].grid.cells=[8, 8]", "scene.gravity=[0, 0, 0]",
                                                   "solver.integrator=paper_fixed"});
  scene.colliders.clear();
  LiveSimulation live(scene, {.playing = false});
  SceneDesc windy = scene;
  windy.wind = {.drag = 0.25, .keys = {{0, Vec3(4, 0, 0)}}};
  live.change(windy);
  live.step(60);
  const LiveFrame blown = wait_for_steps(live, 60);
  EXPECT_EQ(blown.status.wind.velocity.x(), 4);
  EXPECT_GT(blown.meshes.cloths[0][0], live.start().cloths[0].frames[0][0]);
  live.change(scene);
  live.step();
  EXPECT_EQ(wait_for_steps(live, 61).status.wind.drag, 0);
}

/// The state after so many steps from the start, with another scene from `changed` on.
std::uint64_t hash_after(const SceneDesc& scene, const SceneDesc& other, int changed, int steps) {
  SceneRun run(scene, make_jobs(1));
  for (int s = 0; s < steps; ++s) {
    if (s == changed) run.change(other);
    glide_colliders(run.scene(), run.scene().step_length(), run.public_world());
    run.step();
  }
  return run.world().state_hash();
}

TEST(Live, ChangedNumbersAreThoseOfTheNextStepWithoutARestart) {
  const SceneDesc scene = small_scene();
  SceneDesc other = scene;
  other.gravity = {0, -3, 1};
  other.cloths[0].material.structural *= 2;
  other.colliders[0].friction = 0.9;
  LiveSimulation live(scene, {.playing = false});
  live.step(20);
  wait_for_steps(live, 20);
  live.change(other);
  live.step(20);
  const LiveFrame after = wait_for_steps(live, 40);
  EXPECT_TRUE(after.status.keys_for_restart.empty());
  EXPECT_EQ(live.state_hash(), hash_after(scene, other, 20, 40));
  EXPECT_NE(live.state_hash(), hash_after(scene, scene, 20, 40));
}

TEST(Live, WhatNeedsANewWorldWaitsForTheReset) {
  const SceneDesc scene = small_scene();
  SceneDesc finer = scene;
  std::get<Grid>(finer.cloths[0].shape).cells_x = 16;
  LiveSimulation live(scene, {.playing = false});
  live.change(finer);
  live.step(2);
  const LiveFrame waiting = wait_for_steps(live, 2);
  EXPECT_EQ(waiting.status.keys_for_restart, std::vector<std::string>{"cloth[0].grid"});
  EXPECT_EQ(waiting.meshes.cloths[0].size(), 3u * 13 * 13);
  live.reset();
  const LiveFrame fresh = wait_for(live, [](const LiveFrame& f) { return f.status.steps == 0; });
  EXPECT_TRUE(fresh.status.keys_for_restart.empty());
  EXPECT_EQ(fresh.meshes.cloths[0].size(), 3u * 17 * 13);
  EXPECT_EQ(live.state_hash(), SceneRun(finer, make_jobs(1)).world().state_hash());
}

TEST(Live, InvalidNumbersAreRefusedAndLeaveTheWorldAsItIs) {
  const SceneDesc scene = small_scene();
  SceneDesc bad = scene;
  bad.gravity = {0, -1, 0};
  bad.cloths[0].material.density = -1;
  LiveSimulation live(scene, {.playing = false});
  live.change(bad);
  const LiveFrame refused = wait_for(live, [](const LiveFrame& f) { return !f.status.failure.empty(); });
  EXPECT_NE(refused.status.failure.find("density"), std::string::npos) << refused.status.failure;
  live.step(10);
  wait_for_steps(live, 10);
  EXPECT_EQ(live.state_hash(), hash_after(scene, scene, 0, 10));
}

TEST(Live, CollidersComeGoAndMoveWhileClothMoves) {
  const SceneDesc scene = small_scene();
  SceneDesc more = scene;
  more.colliders.push_back({.name = "box", .shape = PlacedBox{.center = {0, -0.4, 0}}});
  SceneDesc moved = more;
  std::get<PlacedBox>(moved.colliders.back().shape).center.x() = 0.1;
  LiveSimulation live(scene, {.playing = false});
  live.change(more);
  live.step(3);
  LiveFrame frame = wait_for_steps(live, 3);
  EXPECT_EQ(frame.start->bodies.size(), scene.colliders.size() + 1);
  live.change(moved);
  double last = 0;
  for (int s = 4; s <= 363; ++s) {
    live.step(1);
    frame = wait_for_steps(live, s);
    const double x = frame.meshes.poses.back().translation.x();
    EXPECT_GE(x, last);
    EXPECT_LE(x - last, 4 * scene.step_length() + 1e-6) << "as fast as a hand";
    last = x;
  }
  EXPECT_NEAR(last, 0.1, 1e-6) << "within a second";
  EXPECT_EQ(frame.status.failure, "");
  live.change(scene);
  live.step(1);
  EXPECT_EQ(wait_for_steps(live, 364).start->bodies.size(), scene.colliders.size());
}

TEST(Live, ThePastHasTheSameBitsWithAllChangesMadeInIt) {
  const SceneDesc scene = small_scene();
  SceneDesc light = scene;
  light.gravity = {0, -2, 0};
  std::get<Sphere>(light.colliders[0].shape).center.x() += 0.2;  // glides over many of the steps
  LiveSimulation live(scene, {.playing = false});
  std::vector<std::uint64_t> hashes = {live.state_hash()};
  for (int s = 1; s <= 64; ++s) {
    if (s == 24) live.change(light);
    if (s == 40) live.grab({.cloth = 0, .triangle = 20});
    if (s > 40 && s < 50) live.move_grab(Vec3(0.2, 1, 0.01 * s));
    if (s == 50) live.release();
    live.step();
    hashes.push_back(live.state_hash());  // a step may not be done yet
    while (hashes.back() == hashes[hashes.size() - 2]) hashes.back() = live.state_hash();
  }
  for (const int s : {64, 60, 41, 25, 24, 23, 7, 45, 10, 0}) {
    live.seek(s);
    EXPECT_EQ(live.state_hash(), hashes[s]) << "step " << s;
  }
  // Steps from the past take the newest numbers, and what came after is forgotten.
  live.seek(12);
  live.step(2);
  const LiveFrame again = wait_for(live, [](const LiveFrame& f) { return f.status.steps == 14; });
  EXPECT_EQ(again.status.last_step, 14);
  EXPECT_EQ(live.state_hash(), hash_after(scene, light, 12, 14));
  live.seek(12);
  EXPECT_EQ(live.state_hash(), hashes[12]);
}

TEST(Live, PinsComeAndGoWhileClothMovesWithTheSameBitsInThePast) {
  const SceneDesc scene = small_scene();
  SceneDesc pinned = scene;
  pin_vertices(std::vector{0, 12}, {}, pinned.cloths[0]);
  LiveSimulation live(scene, {.playing = false});
  live.step(20);
  wait_for_steps(live, 20);
  live.change(pinned);
  live.step(30);
  LiveFrame frame = wait_for_steps(live, 50);
  ASSERT_EQ((*frame.pins)[0].particles, (std::vector{0, 12}));
  EXPECT_EQ((*frame.pins)[0].vertices, (PinnedVertices{{0, 12}}));
  const float height = frame.meshes.cloths[0][1];
  const std::uint64_t hung = live.state_hash();
  live.change(scene);
  live.step(30);
  frame = wait_for_steps(live, 80);
  EXPECT_TRUE((*frame.pins)[0].particles.empty());
  EXPECT_LT(frame.meshes.cloths[0][1], height - 0.005f) << "it falls again";
  EXPECT_TRUE(frame.status.keys_for_restart.empty());
  live.seek(50);
  EXPECT_EQ(live.state_hash(), hung);
  live.seek(45);
  frame = wait_for(live, [](const LiveFrame& f) { return f.status.steps == 45; });
  EXPECT_EQ((*frame.pins)[0].particles.size(), 2u) << "the pins of that time";
}

TEST(Live, AGrabLeavesSoftPinsWhereTheyAre) {
  SceneDesc scene = small_scene();
  PinDesc& pin = scene.cloths[0].pins.emplace_back();
  pin.select.emplace<ParticleIndices>().indices = {0, 12, 156, 168};
  pin.stiffness = 500;
  pin.damping = 1;
  LiveSimulation live(scene, {.playing = false});
  live.grab({.cloth = 0, .triangle = 144});
  live.step(3);
  wait_for_steps(live, 3);
  live.release();
  live.step(6 * 60);
  const LiveFrame frame = wait_for_steps(live, 3 + 6 * 60);
  const std::vector<float>& start = live.start().cloths[0].frames[0];
  EXPECT_NEAR(frame.meshes.cloths[0][1], start[1], 0.05) << "a corner still hangs by its spring";
  EXPECT_EQ((*frame.pins)[0].particles, (std::vector{0, 12, 156, 168})) << "they are shown as pinned";
}

TEST(Live, InstrumentsChangeNoBits) {
  const SceneDesc scene = small_scene();
  LiveSimulation live(scene, {.playing = false});
  live.measure({.color = ParticleValue::contact,
                .contacts = true,
                .yarns = true,
                .probe = ClothPoint{.cloth = 0, .triangle = 144, .weights = {0.2, 0.7, 0.1}}});
  live.step(240);
  const LiveFrame frame = wait_for_steps(live, 240);
  EXPECT_EQ(live.state_hash(), hash_after(scene, scene, 0, 240));
  ASSERT_EQ(frame.meshes.values.size(), 1u);
  EXPECT_EQ(frame.meshes.values[0].size(), 13u * 13);
  EXPECT_FALSE(frame.contacts.empty()) << "the sheet lies on the ball";
  EXPECT_GT(*std::ranges::max_element(frame.meshes.values[0]), 0);
  EXPECT_TRUE(frame.yarns.empty()) << "a cloth of springs has no yarns";
  ASSERT_TRUE(frame.probe.has_value());
  EXPECT_EQ(frame.probe->particle, live.start().cloths[0].triangles[144][1]) << "the nearest corner";
  EXPECT_GT(frame.probe->mass, 0);
}

TEST(Live, YarnsOfAFabricAreMeasuredAndWhatHasNoneSaysWhy) {
  SceneDesc scene = small_scene("newton");
  SceneDesc fabric = scene;
  take_fabric(find_fabric_preset("cotton_shirting"), fabric.cloths[0]);
  LiveSimulation live(fabric, {.playing = false});
  live.measure({.yarns = true});
  const LiveFrame frame = wait_for(live, [](const LiveFrame& f) { return !f.yarns.empty(); });
  EXPECT_EQ(frame.yarns.size(), 2u * 12 * 12);
  EXPECT_NEAR(frame.yarns[0].yarns.warp_strain(), 0, 1e-4) << "at rest, floats";

  scene.cloths[0].shape =
      MeshSource{.mesh = std::make_shared<weft::TriangleMesh>(weft::TriangleMesh{
                     .positions = {{0, 1, 0}, {0.1, 1, 0}, {0, 1, 0.1}}, .triangles = {{0, 1, 2}}})};
  LiveSimulation mesh(scene, {.playing = false});
  mesh.measure({.color = ParticleValue::shear});
  const LiveFrame none = wait_for(mesh, [](const LiveFrame& f) { return !f.no_color.empty(); });
  EXPECT_NE(none.no_color.find("warp and weft"), std::string::npos) << none.no_color;
  EXPECT_TRUE(none.meshes.values.empty());
}

TEST(Live, AMeshBodyIsDisplacedWhileClothMoves) {
  SceneDesc scene = small_scene();
  scene.colliders.push_back(
      {.name = "tetrahedron",
       .shape = PlacedMesh{.source = {.mesh = std::make_shared<weft::TriangleMesh>(weft::TriangleMesh{
                                          .positions = {{0, 0, 0}, {0.1, 0, 0}, {0, 0.1, 0}, {0, 0, 0.1}},
                                          .triangles = {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {0, 3, 2}}})},
                           .position = {0.9, 0, 0}}});
  SceneDesc moved = scene;
  PlacedMesh& mesh = std::get<PlacedMesh>(moved.colliders.back().shape);
  mesh.position = {0.9, 0.2, 0};
  mesh.rotation_deg = {0, 45, 0};
  LiveSimulation live(scene, {.playing = false});
  live.step(2);
  wait_for_steps(live, 2);
  live.change(moved);
  live.step(400);
  const LiveFrame frame = wait_for_steps(live, 402);
  EXPECT_EQ(frame.status.failure, "");
  EXPECT_TRUE(frame.status.keys_for_restart.empty());
  const AnimatedBody::Pose& pose = frame.meshes.poses.back();
  const Vec3 corner =
      pose.rotation * frame.start->bodies.back().vertex(0, frame.meshes.body_vertices.back()) +
      pose.translation;
  EXPECT_LT((corner - Vec3(0.9, 0.2, 0)).norm(), 1e-6);
}

TEST(Live, ProblemsHaveTheirCodesAndGoWithAReset) {
  SceneDesc scene = small_scene("newton");
  scene.steps_per_frame = 1;
  scene.cloths[0].material.structural = 1;  // soft enough to be stretched by its weight
  scene.colliders.clear();
  pin_vertices(std::vector{0, 12}, {}, scene.cloths[0]);
  LiveSimulation live(scene, {.playing = false});
  live.step(60);
  const LiveFrame frame = wait_for_steps(live, 60);
  ASSERT_FALSE(frame.status.problems.empty());
  const auto strained = std::ranges::find(frame.status.problems, WarningCode::yarn_strain, &RunProblem::code);
  ASSERT_NE(strained, frame.status.problems.end());
  EXPECT_GT(strained->frames, 5);
  live.reset();
  const LiveFrame fresh = wait_for(live, [](const LiveFrame& f) { return f.status.steps == 0; });
  EXPECT_TRUE(fresh.status.problems.empty());
}

TEST(LiveHistory, KeepsTenSecondsAndAQuarterOfAGigabyte) {
  LiveHistory history;
  for (int s = 0; s <= 1200; ++s) {
    if (history.wants(s)) history.add({.steps = s, .time = s / 60.0}, 100);
  }
  EXPECT_EQ(history.first(), 600);
  EXPECT_EQ(history.moment_before(1199).steps, 1190);
  EXPECT_EQ(history.moment_before(603).steps, 600);
  LiveHistory heavy;
  for (int s = 0; s <= 1200; s += LiveHistory::kSpacing) heavy.add({.steps = s}, 129 * 129);
  const auto moments = static_cast<double>((1200 - heavy.first()) / LiveHistory::kSpacing);
  EXPECT_LE(moments * LiveHistory::kBytesPerParticle * 129 * 129, 256e6);
}

TEST(Live, ClothThatIsGrabbedFollowsAndFallsWhenItIsLetGo) {
  LiveSimulation live(small_scene(), {.playing = false});
  live.grab({.cloth = 0, .triangle = 144});
  const LiveFrame start = wait_for(live, [](const LiveFrame& f) { return f.status.held.has_value(); });
  const Vec3 target = *start.status.held + Vec3(0, 1, 0);
  live.move_grab(target);
  live.step(6 * 90);
  const LiveFrame held = wait_for_steps(live, 6 * 90);
  EXPECT_LT((*held.status.held - target).norm(), 0.05) << "the spring sags by about 1 cm";
  EXPECT_GT(mean_height(held), mean_height(start) + 0.3);
  live.release();
  live.step(6 * 12);
  const LiveFrame free = wait_for_steps(live, 6 * 102);
  EXPECT_FALSE(free.status.held.has_value());
  EXPECT_LT(mean_height(free), mean_height(held) - 0.1) << "a fifth of a second's fall is 20 cm";
}

TEST(Live, AStepThatFailsPausesTellsWhyAndKeepsTheLastGoodState) {
  SceneDesc scene =
      shipped("paper/fig3_horizontal_real", {"solver.integrator=explicit", "solver.explicit.substeps=1",
                                             "cloth[0].name=sail", "cloth[0].grid.cells=[12, 12]"});
  LiveSimulation live(scene);
  const LiveFrame frame = wait_for(live, [](const LiveFrame& f) { return !f.status.failure.empty(); });
  EXPECT_FALSE(frame.status.playing);
  EXPECT_NE(frame.status.failure.find("sail"), std::string::npos);
  EXPECT_NE(frame.status.failure.find("substeps"), std::string::npos);
  for (const float x : frame.meshes.cloths[0]) ASSERT_TRUE(std::isfinite(x));
  // Another integrator continues from this state.
  live.set_integrator("implicit_euler");
  live.reset();
  live.step(2);
  EXPECT_EQ(wait_for(live, [](const LiveFrame& f) { return f.status.steps == 2; }).status.failure, "");
}

TEST(Live, TooHeavyClothSlowsTimeAndSaysSo) {
  // A frame with so many steps takes much longer than a sixtieth of a second on any machine.
  LiveSimulation live(shipped("paper/fig6_ball", {"solver.steps_per_frame=5000"}));
  const LiveFrame frame = wait_for(live, [](const LiveFrame& f) { return f.status.too_heavy; });
  EXPECT_LT(frame.status.simulated_per_second, 0.95);
  EXPECT_GT(frame.status.simulated_per_second, 0);
  EXPECT_GT(frame.status.steps_per_second, 0);
  EXPECT_GT(frame.status.ms_per_step, 0);
}

TEST(Live, WarnsOfThePapersFrozenCloth) {
  LiveSimulation live(shipped("paper/fig3_horizontal_real"), {.playing = false});
  live.set_integrator("paper");
  const LiveFrame frame = wait_for(live, [](const LiveFrame& f) { return f.status.integrator == "paper"; });
  ASSERT_FALSE(frame.status.warnings.empty());
  EXPECT_NE(frame.status.warnings[0].find("of gravity"), std::string::npos);
}

TEST(Live, EndsInTheMiddleOfPlay) {
  for (int i = 0; i < 20; ++i) LiveSimulation live(small_scene());
}

}  // namespace
}  // namespace weft::engine
