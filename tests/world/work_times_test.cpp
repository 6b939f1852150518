#include "weft/core/work_times.h"

#include <gtest/gtest.h>

#include "tests/support.h"
#include "weft/world/world.h"

namespace weft::engine {
namespace {

using test::square;

constexpr double kStep = 1.0 / 60;
constexpr double kRounding = 1e-12;  // of sums of seconds [1]
constexpr WorkClock::Kind kContact[] = {&WorkTimes::lists,  &WorkTimes::narrow_phase, &WorkTimes::rows,
                                        &WorkTimes::set_up, &WorkTimes::product,      &WorkTimes::projection,
                                        &WorkTimes::ccd};

void spend(double seconds) {
  WorkClock own;
  own.start();
  while (own.seconds() < seconds) {
  }
}

/// A level sheet of 12×12 cells at this height [m].
ClothParts make_sheet(double height) {
  ClothParts desc{.topology = build_grid_topology(square(12), SpringModel::alternating),
                  .material = {.structural = 2000, .shear = 1000, .bend = 20, .thickness = 2e-3}};
  desc.positions = desc.topology->mesh.positions;
  for (Vec3& p : desc.positions) p.y() += height;
  return desc;
}

/// A sheet pinned everywhere, and another that settles on it. No primitive shapes: every contact is a pair.
World make_layers() {
  World world;
  const ClothId lower = world.add_cloth(make_sheet(0));
  Pin all;
  for (int i = 0; i < world.model(lower).num_particles(); ++i) all.particles.push_back(i);
  world.set_pins(lower, {all});
  world.add_cloth(make_sheet(2e-3));
  world.set_division({.enabled = false});
  return world;
}

TEST(WorkClock, CountsABlockWithinABlockOnce) {
  constexpr double kWork = 2e-3;
  WorkClock clock;
  clock.start();
  {
    const WorkScope outer(&clock, &WorkTimes::projection);
    spend(kWork);
    {
      const WorkScope inner(&clock, &WorkTimes::lists);
      spend(kWork);
    }
    spend(kWork);
  }
  spend(kWork);
  const WorkTimes times = clock.stop();
  EXPECT_GE(times.projection, 2 * kWork);
  EXPECT_GE(times.lists, kWork);
  EXPECT_LE(times.kinds(), times.total - kWork + kRounding);
}

TEST(WorkTimes, OfASheetOnASheetHaveEveryKindAndAreNoMoreThanTheSteps) {
  World world = make_layers();
  WorkClock outside;
  WorkTimes sum;
  outside.start();
  for (int s = 0; s < 20; ++s) {
    const StepReport report = world.step(kStep);
    ASSERT_TRUE(report.ok);
    EXPECT_LE(report.work.active, static_cast<std::size_t>(report.work.pairs_listed)) << "step " << s;
    sum += report.work;
  }
  for (const WorkClock::Kind kind : kContact) EXPECT_GT(sum.*kind, 0);
  EXPECT_GT(sum.v_cycle, 0);
  EXPECT_EQ(sum.retries, 0) << "steps were not to be divided";
  EXPECT_LE(sum.kinds(), sum.total * (1 + kRounding));
  EXPECT_LE(sum.total, outside.seconds());
  EXPECT_GT(sum.active, 0u);
  EXPECT_GE(sum.looks, 20u) << "the last line looks in every step";
  EXPECT_GE(sum.pairs_tested, static_cast<std::size_t>(sum.pairs_listed));
  EXPECT_LE(sum.pairs_tested, sum.looks * sum.pairs_listed);
}

TEST(WorkTimes, WithoutContactAreThoseOfTheSolveAlone) {
  World world = make_layers();
  world.set_contact(false);
  for (int s = 0; s < 5; ++s) {
    const WorkTimes work = world.step(kStep).work;
    for (const WorkClock::Kind kind : kContact) EXPECT_EQ(work.*kind, 0);
    EXPECT_GT(work.v_cycle, 0);
    EXPECT_GE(work.total, work.v_cycle);
    EXPECT_EQ(work.looks + work.pairs_tested + work.active + work.list_renewals, 0u);
    EXPECT_EQ(work.pairs_listed, 0);
  }
}

WorkTimes work_of_free_fall(const ClothParts& sheet) {
  World world;
  world.add_cloth(sheet);
  WorkTimes second;
  for (int s = 0; s < 60; ++s) second += world.step(kStep).work;
  return second;
}

TEST(WorkTimes, OfFreeFallHaveAtMostTwoSearchesPerSecond) {
  ClothParts mesh = make_sheet(0);
  mesh.topology = test::mesh_of(square(12));
  const WorkTimes of_mesh = work_of_free_fall(mesh);
  EXPECT_GE(of_mesh.list_renewals, 1u);
  EXPECT_LE(of_mesh.list_renewals, 2u) << "what all cloth moves in common does not count";
  EXPECT_EQ(of_mesh.active, 0u);
  // A grid is surveyed instead, and no contact is possible.
  EXPECT_EQ(work_of_free_fall(make_sheet(0)).list_renewals, 0u);
}

TEST(WorkTimes, OfPartsThatWereThrownAwayAreToldApart) {
  World world;
  world.add_collider({"ball", Sphere{{0.5, 0, 0.5}, 0.3}, 0.3, {}});
  ClothParts sheet = make_sheet(0.35);
  sheet.velocity = {0, -20, 0};
  world.add_cloth(sheet);
  int retries = 0;
  for (int s = 0; s < 4; ++s) {
    const StepReport report = world.step(kStep);
    ASSERT_TRUE(report.ok);
    retries += report.retries;
    EXPECT_EQ(report.retries > 0, report.work.retries > 0) << "step " << s;
    EXPECT_LT(report.work.retries, report.work.total);
  }
  EXPECT_GT(retries, 0);
}

}  // namespace
}  // namespace weft::engine
