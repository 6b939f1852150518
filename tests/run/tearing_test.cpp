/// Runs of cloth that tears: every file shows it, and the checker reads them.

#include <gtest/gtest.h>

#include <chrono>
#include <set>
#include <thread>

#include "tests/message_of.h"
#include "tests/own_folder.h"
#include "tests/read_text.h"
#include "tests/run/shipped.h"
#include "weft/io/glb_reader.h"
#include "weft/io/obj_reader.h"
#include "weft/mesh/soup.h"
#include "weft/run/frame_checks.h"
#include "weft/run/live.h"
#include "weft/run/playback.h"
#include "weft/run/run_folder.h"

namespace weft::engine {
namespace {

constexpr int kFrames = 45;

/// A ball through a sheet of 12 × 12 cells.
SceneDesc scene() {
  return shipped("tearing/ball", {"cloth[0].grid.cells=[12, 12]", "cloth[0].fabric.strength=60"});
}

class RunOfTornCloth : public testing::Test {
 protected:
  RunOptions options(const char* name, Unfinished unfinished = Unfinished::refuse) const {
    return {.frames = kFrames,
            .folder = (folder_ / name).string(),
            .obj = true,
            .unfinished = unfinished,
            .checkpoint_every = 10};
  }

  const std::filesystem::path folder_ = make_own_folder();
};

/// The number of places that the corners of a soup have.
std::size_t count_places(const std::vector<Triangle>& soup, const std::vector<float>& positions) {
  std::set<int> places;
  for (const Triangle& t : join_soup(soup, positions)) places.insert(t.begin(), t.end());
  return places.size();
}

TEST_F(RunOfTornCloth, IsShownByEveryFileAndHasNoIntersections) {
  const FinishedRun run = run_to_folder(scene(), options("run"));
  ASSERT_EQ(run.report.outcome, RunOutcome::done);
  EXPECT_GT(run.report.torn, 3);
  EXPECT_EQ(run.report.intersections, 0);
  EXPECT_EQ(run.report.passages, 0);
  const auto glb = open_frames(folder_ / "run");
  ASSERT_EQ(glb->num_frames(), kFrames + 1);
  const std::vector<Triangle>& soup = glb->meshes().cloths[0].triangles;
  ASSERT_TRUE(is_soup(soup));
  EXPECT_EQ(soup.size(), 288U);
  EXPECT_EQ(count_places(soup, glb->read(0).cloths[0]), 169U);
  EXPECT_GT(count_places(soup, glb->read(kFrames).cloths[0]), 169U + 3);
  EXPECT_TRUE(check_animation(*glb, {.passages_offend = true}).is_clean);
  const MeshFromFile last = read_obj(folder_ / "run/obj/sheet_0045.obj");
  EXPECT_EQ(last.mesh.num_vertices(), 3 * 288);
  // Without the animation the point cache has the same frames.
  RunOptions without = options("caches");
  without.glb = false;
  run_to_folder(scene(), without);
  const FramesAndWorld cached = open_frames_and_world(folder_ / "caches");
  EXPECT_EQ(cached.world, nullptr);
  EXPECT_EQ(cached.why_not, "cloth \"sheet\" tears: its past frames are positions only");
  EXPECT_EQ(cached.frames->read(kFrames).cloths[0].size(), 9U * 288);
  EXPECT_EQ(count_places(soup, cached.frames->read(kFrames).cloths[0]),
            count_places(soup, glb->read(kFrames).cloths[0]));
}

TEST_F(RunOfTornCloth, GoesOnAfterAnInterruption) {
  const FinishedRun whole = run_to_folder(scene(), options("whole"));
  run_to_folder(scene(), options("broken"), {},
                [](const Progress& progress) { return progress.frame < kFrames - 4; });
  const FinishedRun rest = run_to_folder(scene(), options("broken", Unfinished::resume));
  EXPECT_EQ(rest.report.state_hash, whole.report.state_hash);
  EXPECT_EQ(rest.report.torn, whole.report.torn);
  for (const char* file : {"animation.glb", "sheet.pc2", "sheet.mesh.obj", "run.json"})
    EXPECT_EQ(read_text(folder_ / "whole" / file) == read_text(folder_ / "broken" / file), true) << file;
}

TEST_F(RunOfTornCloth, IsNoStartOfAnother) {
  run_to_folder(scene(), options("run"));
  RunOptions next = options("next");
  next.start_from = (folder_ / "run").string() + "@last";
  EXPECT_NE(message_of([&] { run_to_folder(scene(), next); }).find("169 vertices in the scene, but 864 in"),
            std::string::npos);
}

TEST(LiveTornCloth, ShowsItsPresentMeshAndIsWholeAfterAReset) {
  LiveSimulation live(scene(), {.playing = false});
  live.measure({.color = ParticleValue::strain,
                .contacts = true,
                .yarns = true,
                .probe = ClothPoint{0, 140, {1, 0, 0}}});
  live.grab({0, 150, {0.2, 0.3, 0.5}});
  const auto frame_of = [&](std::int64_t steps) {
    LiveFrame frame;
    for (int n = 0; n < 60000 && (!live.take_newest(frame) || frame.status.steps != steps); ++n)
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    EXPECT_EQ(frame.status.steps, steps) << frame.status.failure;
    return frame;
  };
  live.step(kFrames);
  const LiveFrame torn = frame_of(kFrames);
  const RestMesh& mesh = torn.topologies[0]->mesh;
  EXPECT_GT(mesh.num_vertices(), 169 + 3);
  EXPECT_EQ(torn.meshes.cloths[0].size(), 3U * mesh.num_vertices());
  EXPECT_EQ(torn.meshes.values[0].size(), static_cast<std::size_t>(mesh.num_vertices()));
  EXPECT_TRUE(torn.probe);
  live.seek(kFrames - 20);
  EXPECT_EQ(frame_of(kFrames - 20).status.steps, kFrames - 20);
  live.reset();
  const LiveFrame whole = frame_of(0);
  EXPECT_EQ(whole.topologies[0]->mesh.num_vertices(), 169);
  EXPECT_EQ(whole.meshes.cloths[0].size(), 3U * 169);
}

}  // namespace
}  // namespace weft::engine
