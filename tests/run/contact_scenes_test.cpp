// The scenes of scenes/contact, coarser and shorter; `make scenes` runs them at full size.

#include <gtest/gtest.h>

#include "weft/run/scene_run.h"
#include "weft/scene/scene_reader.h"

namespace weft::engine {
namespace {

/// Checks: no intersections in any frame, no passages within any step. Depth inside colliders is at most the
/// checker's rounding, and the CCD fail-safe has no infeasible pairs.
void expect_held(const std::string& name, int frames, const Overrides& overrides) {
  const SceneDesc scene =
      read_scene(std::string(WEFT_SOURCE_DIR) + "/scenes/contact/" + name + ".toml", overrides);
  const RunReport report = run_scene(scene, {.frames = frames});
  EXPECT_EQ(report.outcome, RunOutcome::done);
  EXPECT_EQ(report.frames, frames);
  EXPECT_EQ(report.intersections, 0);
  EXPECT_EQ(report.passages, 0) << report.first_passage;
  EXPECT_LE(report.penetration_max.value_or(0), 1e-6);  // empty without a collider
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

TEST(ContactScenes, AGarmentInAHeapIsSolvedInFewNewtonSteps) {
  // Its folds press particles with many times their weight. Without the forces of the steps before, every frame
  // took the largest number, 6 Newton steps.
  const SceneDesc scene =
      read_scene(std::string(WEFT_SOURCE_DIR) + "/scenes/garment_fall.toml", {"scene.duration=4"});
  const RunReport report = run_scene(scene, {.frames = 240});
  int newton_steps = 0;
  for (int frame = 180; frame < 240; ++frame) newton_steps += report.newton_steps[frame];
  EXPECT_LT(newton_steps, 60 * 5);
}

}  // namespace
}  // namespace weft::engine
