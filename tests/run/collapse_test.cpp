/// Silk that falls on a ball keeps the shape of its triangles.

#include <gtest/gtest.h>

#include <algorithm>
#include <string>

#include "weft/run/scene_run.h"
#include "weft/scene/scene_reader.h"

namespace weft::engine {
namespace {

/// Cells of 15 mm on a ball of 10 cm; one step per frame, so that min_stretch covers every step.
SceneDesc silk_on_a_ball() {
  constexpr int kCells = 64;
  const double size = 0.015 * kCells;
  const std::string length = std::to_string(size), corner = std::to_string(-size / 2);
  const std::string count = std::to_string(kCells);
  return parse_scene(
      "[scene]\nformat = 1\nfps = 60\nduration = 1\n"
      "[[cloth]]\nfabric = \"silk\"\ngrid = { size = [" +
          length + ", " + length + "], cells = [" + count + ", " + count + "] }\nposition = [" + corner +
          ", 0.58, " + corner +
          "]\n[[collider]]\nshape = \"sphere\"\ncenter = [0, 0.4, 0]\nradius = 0.1\n"
          "friction = 0.3\n[solver]\nsteps_per_frame = 1\n",
      "silk.toml");
}

TEST(Collapse, SilkOnABallKeepsItsTrianglesWide) {
  const RunReport report = run_scene(silk_on_a_ball(), {.frames = 40});
  EXPECT_EQ(report.outcome, RunOutcome::done);
  EXPECT_EQ(report.intersections, 0);
  ASSERT_EQ(report.min_stretch.size(), 40u);
  EXPECT_GT(*std::min_element(report.min_stretch.begin(), report.min_stretch.end()), 0.2);
}

}  // namespace
}  // namespace weft::engine
