// The scenes of scenes/contact, coarser and shorter; at their full size: `make scenes`.

#include <gtest/gtest.h>

#include "weft/run/scene_run.h"
#include "weft/scene/scene_reader.h"

namespace weft::engine {
namespace {

/// Nothing crosses at any frame, nothing passes through anything within any step, nothing is inside a
/// collider by more than the checker's own rounding, and there is nothing that the last line had to give up.
void expect_held(const std::string& name, int frames, const Overrides& overrides) {
  const SceneDesc scene =
      read_scene(std::string(WEFT_SOURCE_DIR) + "/scenes/contact/" + name + ".toml", overrides);
  const RunReport report = run_scene(scene, {.frames = frames});
  EXPECT_EQ(report.outcome, RunOutcome::done);
  EXPECT_EQ(report.frames, frames);
  EXPECT_EQ(report.intersections, 0);
  EXPECT_EQ(report.passages, 0) << report.first_passage;
  EXPECT_LE(report.penetration_max.value_or(0), 1e-6);  // without a collider there is none to be in
  EXPECT_EQ(report.infeasible, std::vector<std::string>());
}

TEST(ContactScenes, ANeedleDoesNotPierce) { expect_held("needle", 60, {"cloth[0].grid.cells=[24, 24]"}); }

TEST(ContactScenes, AKnifeDoesNotCut) { expect_held("knife_edge", 60, {"cloth[0].grid.cells=[24, 24]"}); }

TEST(ContactScenes, ABulletDoesNotPass) { expect_held("bullet", 60, {"cloth[0].grid.cells=[24, 24]"}); }

TEST(ContactScenes, AWallIsNotPassedAtOneHundredMetresPerSecond) {
  expect_held("wall", 40, {"cloth[0].grid.cells=[24, 24]"});
}

TEST(ContactScenes, CrossedRibbonsHoldEachOther) {
  expect_held("crossed_strips", 110, {"cloth[0].grid.cells=[40, 8]", "cloth[1].grid.cells=[8, 40]"});
}

TEST(ContactScenes, ABodyThatCrossesItselfCarriesTheSheet) {
  expect_held("self_crossing_body", 120, {"cloth[0].grid.cells=[20, 20]"});
}

TEST(ContactScenes, FoldedLayersLandOnEachOther) { expect_held("folded_fall", 40, {}); }

}  // namespace
}  // namespace weft::engine
