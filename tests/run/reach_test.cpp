#include "weft/run/reach.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/run/shipped.h"
#include "weft/run/scene_run.h"
#include "weft/scene/scene_world.h"

namespace weft::engine {
namespace {

Eigen::AlignedBox3d box_around(const std::vector<Vec3>& points) {
  Eigen::AlignedBox3d box;
  for (const Vec3& p : points) box.extend(p);
  return box;
}

Eigen::AlignedBox3d reach_of(const SceneDesc& scene) {
  return box_around(find_reach(build_world(scene, make_serial_jobs()).world));
}

TEST(Reach, HoldsWhatHangsFromItsPins) {
  const Eigen::AlignedBox3d box = reach_of(shipped("paper/fig3_horizontal"));
  // A square metre hung by two corners of one edge: the middle of the opposite edge is farthest from both.
  EXPECT_NEAR(box.sizes().y(), std::sqrt(1.25), 1e-6);
  const RunReport report = run_scene(shipped("paper/fig3_horizontal"), {.frames = 60});
  for (const double y : report.lowest_y) EXPECT_GT(y, box.min().y() - 0.05);
}

TEST(Reach, EndsAtTheFloor) {
  const Eigen::AlignedBox3d box = reach_of(shipped("drape_sphere"));
  EXPECT_NEAR(box.min().y(), 0, 1e-9);
  EXPECT_NEAR(box.max().y(), 0.75, 1e-6);
}

TEST(Reach, WithoutAFloorEndsALittleBelowTheColliders) {
  const Eigen::AlignedBox3d box = reach_of(shipped("paper/fig6_ball"));
  EXPECT_LT(box.min().y(), 0.1);
  EXPECT_GT(box.min().y(), -0.1);
}

}  // namespace
}  // namespace weft::engine
