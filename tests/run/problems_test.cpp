/// Problems of a run, one at a time.

#include "weft/run/problems.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "tests/run/shipped.h"
#include "tests/support.h"
#include "weft/run/scene_run.h"
#include "weft/scene/scene_world.h"

namespace weft::engine {
namespace {

/// A sheet of a metre; the tests set the positions of its particles.
World make_sheet() {
  World world;
  world.add_cloth(
      {.name = "sheet", .topology = build_grid_topology(test::square(4), SpringModel::alternating)});
  world.add_collider({"floor", Plane{.point = {0, -10, 0}}, 0.3, {}});
  return world;
}

void scale(World& world, const Vec3& by) {
  World::Snapshot snapshot = world.snapshot();
  Vec3Array& x = snapshot.states[0].x;
  for (std::size_t i = 0; i < x.size(); ++i) x.set(i, x.get(i).cwiseProduct(by));
  world.restore(snapshot);
}

std::vector<WarningCode> codes_of(const ProblemFinder& finder) {
  std::vector<WarningCode> codes;
  for (const RunProblem& p : finder.problems()) codes.push_back(p.code);
  return codes;
}

using Codes = std::vector<WarningCode>;

TEST(Problems, NoneOfClothAtRest) {
  const World world = make_sheet();
  ProblemFinder finder(world);
  for (int frame = 0; frame < 20; ++frame) finder.add_frame(0, 1.0 - 0.01 * frame);
  EXPECT_EQ(codes_of(finder), Codes());
}

/// Impacts of shipped scenes; with a longest step for the energy check of 1/200 s they gained 37 and 9 mJ.
TEST(Problems, NoneOfImpactsInShippedScenes) {
  for (const auto& [name, frames] : {std::pair("two_layers", 22), std::pair("fabrics/drape", 16),
                                     std::pair("paper/fig3_horizontal_real", 60)}) {
    const RunReport report = run_scene(shipped(name), {.frames = frames, .check_passages = false});
    EXPECT_TRUE(report.problems.empty()) << name << ": " << report.problems[0].message;
  }
}

TEST(Problems, YarnsThatStayTooLong) {
  World world = make_sheet();
  scale(world, {1.2, 1, 1});
  ProblemFinder finder(world);
  for (int frame = 0; frame < 5; ++frame) finder.add_frame(0, 0);
  EXPECT_EQ(codes_of(finder), Codes()) << "five frames are a jerk";
  finder.add_frame(0, 0);
  EXPECT_EQ(codes_of(finder), Codes{WarningCode::yarn_strain});
  const RunProblem problem = finder.problems()[0];
  EXPECT_NEAR(problem.value, 0.2, 1e-5);
  EXPECT_EQ(problem.frames, 6);
  EXPECT_NE(problem.message.find("cloth \"sheet\""), std::string::npos);
  EXPECT_NE(problem.message.find("solver.max_steps_per_frame"), std::string::npos);
}

TEST(Problems, TrianglesThatStayFlat) {
  World world = make_sheet();
  scale(world, {1, 1, 0.05});
  ProblemFinder finder(world);
  for (int frame = 0; frame < 6; ++frame) finder.add_frame(0, 0);
  EXPECT_EQ(codes_of(finder), Codes{WarningCode::flat_triangle});
  EXPECT_NEAR(finder.problems()[0].value, 0.05, 1e-5);
}

TEST(Problems, EnergyFromNothing) {
  const World world = make_sheet();
  ProblemFinder finder(world);
  for (const double energy : {5.0, 4.0, 4.01, 4.0}) finder.add_frame(0, energy);
  EXPECT_EQ(codes_of(finder), Codes()) << "a hundredth of what has fallen";
  finder.add_frame(0, 4.1);
  EXPECT_EQ(codes_of(finder), Codes{WarningCode::energy_rise});
  EXPECT_NEAR(finder.problems()[0].value, 0.1, 1e-12);
}

TEST(Problems, ASwingThatLosesNothingMayVaryByAHundredth) {
  const World world = make_sheet();
  ProblemFinder finder(world);
  for (const double kinetic : {0.0, 0.5, 1.0, 0.5, 0.0}) finder.add_frame(kinetic, 1.01 - 0.99 * kinetic);
  EXPECT_EQ(codes_of(finder), Codes());
  finder.add_frame(0.5, 0.54);
  EXPECT_EQ(codes_of(finder), Codes{WarningCode::energy_rise});
}

TEST(Problems, EnergyOfWhatIsDrivenIsNone) {
  World world = make_sheet();
  world.set_wind({.velocity = {3, 0, 0}, .drag = 0.25});
  ProblemFinder finder(world);
  for (const double energy : {5.0, 4.0, 6.0}) finder.add_frame(0, energy);
  EXPECT_EQ(codes_of(finder), Codes());
}

TEST(Problems, YarnsBeyondTheLimitOfTheirFabric) {
  const std::string fabric = "cloth[0].fabric={base = \"cotton_shirting\", strain_limit = 0.01}";
  SceneWorld built = build_world(shipped("drape_box", {fabric}), make_serial_jobs());
  scale(built.world, {1.1, 1, 1});
  ProblemFinder finder(built.world);
  for (int frame = 0; frame < 6; ++frame) finder.add_frame(0, 0);
  EXPECT_EQ(codes_of(finder), Codes{WarningCode::yarn_strain}) << "0.15 is the limit of fabrics without one";
}

TEST(Problems, CrossingsThatAreLeft) {
  const World world = make_sheet();
  ProblemFinder finder(world);
  finder.add_frame(0, 0);
  finder.set_crossings(12);
  EXPECT_EQ(codes_of(finder), Codes{WarningCode::crossings});
  EXPECT_NE(finder.problems()[0].message.find("solver.untangle"), std::string::npos);
  finder.add_frame(0, 0);
  finder.set_crossings(0);
  EXPECT_EQ(codes_of(finder), Codes()) << "what has come apart is no problem any more";
}

TEST(Problems, WhatWentThroughBetweenFrames) {
  const World world = make_sheet();
  ProblemFinder finder(world);
  finder.add_frame(0, 0);
  finder.add_passages(3);
  EXPECT_EQ(codes_of(finder), Codes{WarningCode::passages});
  EXPECT_EQ(finder.problems()[0].value, 3);
}

TEST(Problems, ClothThatEndsInsideACollider) {
  SceneDesc scene = shipped("contact/ball_and_floor");
  scene.contact = false;
  const RunReport fallen = run_scene(scene, {.frames = 60, .check_passages = false});
  const auto inside = std::ranges::find(fallen.problems, WarningCode::penetration, &RunProblem::code);
  ASSERT_NE(inside, fallen.problems.end());
  EXPECT_EQ(inside->value, *fallen.penetration_max);
  EXPECT_NE(inside->message.find("mm inside collider \"floor\" at particle "), std::string::npos)
      << inside->message;
  EXPECT_NE(inside->message.find("solver.contact = true"), std::string::npos) << inside->message;

  World world = make_sheet();
  ProblemFinder finder(world);
  finder.set_inside(StepWarning{WarningCode::penetration, 0, 3, 0.012, StepFault::stretch, 0});
  ASSERT_EQ(codes_of(finder), Codes{WarningCode::penetration});
  EXPECT_NE(finder.problems()[0].message.find("12 mm inside collider \"floor\" at particle 3"),
            std::string::npos);
  const StepWarning gone{WarningCode::penetration, 0, 3, 0.012, StepFault::stretch, 9};
  EXPECT_NE(describe(world, gone).find("12 mm inside a collider at"), std::string::npos) << "it was removed";
  finder.set_inside({});
  EXPECT_EQ(codes_of(finder), Codes()) << "what has come out is no problem any more";
}

TEST(Problems, OfAWorldAsItIs) {
  World world = make_sheet();
  EXPECT_TRUE(find_problems(world).empty());
  scale(world, {1.2, 1, 1});
  std::vector<StepWarning> found = find_problems(world);
  ASSERT_EQ(found.size(), 1U) << "at once: a world has no frames";
  EXPECT_EQ(found[0].code, WarningCode::yarn_strain);
  scale(world, {1 / 1.2, 1, 0.05});
  found = find_problems(world);
  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(found[0].code, WarningCode::flat_triangle);
  scale(world, {1, 1, 20});

  World::Snapshot snapshot = world.snapshot();
  Vec3Array& x = snapshot.states[0].x;
  for (std::size_t i = 0; i < x.size(); ++i) x.set(i, x.get(i) - Vec3(0, 10.03, 0));
  world.restore(snapshot);
  found = find_problems(world);
  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(found[0].code, WarningCode::penetration);
  EXPECT_EQ(found[0].collider, 0);
  EXPECT_NEAR(found[0].value, 0.03, 1e-6);
}

/// A mesh far beyond what floats hold ended the checker.
TEST(Problems, OfAWorldWithAMeshBeyondAllNumbers) {
  World world = make_sheet();
  TriangleMesh body{.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1e300, 1e300, -1e300}},
                    .triangles = {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}}};
  world.add_collider({"body", MeshShape{.mesh = std::make_shared<const TriangleMesh>(body)}, 0.3, {}});
  EXPECT_LE(find_problems(world).size(), 2U);
}

TEST(Problems, OfStepsTheWorstAndHowOften) {
  const World world = make_sheet();
  ProblemFinder finder(world);
  for (const double value : {0.2, 0.5, 0.3}) {
    StepReport step;
    step.warnings = {{WarningCode::cap_reached, 0, 7, value, StepFault::stretch}};
    finder.add_step(step);
  }
  ASSERT_EQ(codes_of(finder), Codes{WarningCode::cap_reached});
  EXPECT_EQ(finder.problems()[0].value, 0.5);
  EXPECT_EQ(finder.problems()[0].frames, 3);
}

TEST(Problems, EachInfeasiblePairOnce) {
  const World world = make_sheet();
  ProblemFinder finder(world);
  StepReport step;
  step.infeasible = {{.cloth = 0, .particle = 3, .collider = 0}, {.cloth = 0, .particle = 4, .collider = 0}};
  for (int s = 0; s < 10; ++s) finder.add_step(step);
  ASSERT_EQ(codes_of(finder), Codes{WarningCode::infeasible});
  EXPECT_EQ(finder.problems()[0].value, 2);
  EXPECT_EQ(describe(world, step.infeasible[0]), "cloth \"sheet\" particle 3 and collider \"floor\"");
  step.infeasible[0].kind = InfeasibleKind::caught;
  EXPECT_EQ(describe(world, step.infeasible[0]),
            "cloth \"sheet\" particle 3, caught by collider \"floor\" and another");
}

}  // namespace
}  // namespace weft::engine
