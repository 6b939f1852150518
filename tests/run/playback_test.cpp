/// Frames of runs that are shown again: the right ones, at the right times.

#include "weft/run/playback.h"

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <fstream>

#include "tests/run/shipped.h"
#include "weft/error.h"
#include "weft/io/glb_reader.h"
#include "weft/io/obj_reader.h"
#include "weft/mesh/grid.h"
#include "weft/run/film.h"
#include "weft/run/run_folder.h"
#include "weft/run/scene_run.h"

namespace weft::engine {
namespace {

namespace fs = std::filesystem;

class PlaybackOfARun : public testing::Test {
 protected:
  void SetUp() override { fs::remove_all(folder_); }

  static SceneDesc scene() {
    return shipped("contact/rotating_ball", {"cloth[0].grid.cells=[6, 6]", "cloth[0].color=[0, 0.5, 1]"});
  }

  RunOptions options(int frames) const {
    return {.frames = frames, .folder = folder_.string(), .pc2 = false};
  }

  /// Frame `k` is that of the run: cloth to the last bits of a difference, poses to those of floats.
  static void expect_frame(const AnimationFrame& frame, const Animation& film, int k) {
    const AnimationFrame expected = get_frame(film, static_cast<std::size_t>(k));
    ASSERT_EQ(frame.cloths.size(), expected.cloths.size());
    ASSERT_EQ(frame.cloths[0].size(), expected.cloths[0].size());
    for (std::size_t i = 0; i < frame.cloths[0].size(); ++i)
      ASSERT_NEAR(frame.cloths[0][i], expected.cloths[0][i], 1e-6) << k;
    ASSERT_EQ(frame.poses.size(), expected.poses.size());
    for (std::size_t b = 0; b < frame.poses.size(); ++b) {
      EXPECT_LT((frame.poses[b].translation - expected.poses[b].translation).norm(), 1e-6);
      EXPECT_LT(frame.poses[b].rotation.angularDistance(expected.poses[b].rotation), 1e-3);
    }
  }

  const fs::path folder_ =
      fs::path(WEFT_OUTPUT_DIR) / testing::UnitTest::GetInstance()->current_test_info()->name();
};

TEST_F(PlaybackOfARun, HasItsFramesColoursAndBodies) {
  FilmSink film;
  run_to_folder(scene(), options(5), {&film});
  for (const fs::path& path : {folder_, folder_ / "animation.glb"}) {
    const auto playback = open_frames(path);
    EXPECT_EQ(playback->num_frames(), 6);
    EXPECT_NEAR(playback->meshes().frames_per_second, scene().fps, 1e-4) << "by float times";
    EXPECT_EQ(playback->meshes().title, "contact/rotating_ball");
    EXPECT_EQ(playback->meshes().cloths[0].color, (std::array{0.0, 0.5, 1.0}));
    EXPECT_EQ(playback->meshes().bodies.size(), scene().colliders.size());
    EXPECT_TRUE(playback->meshes().cloths[0].frames.empty());
    for (const int k : {3, 0, 5, 1}) expect_frame(playback->read(k), film.animation(), k);
  }
}

TEST_F(PlaybackOfARun, ThatIsUnfinishedHasTheFramesSoFarAndFollowsIt) {
  FilmSink film;
  run_scene(scene(), {.frames = 6}, {&film});
  const pid_t child = fork();
  if (child == 0) {
    run_to_folder(scene(), options(6), {}, [](const Progress& progress) {
      if (progress.frame == 4) raise(SIGKILL);
      return true;
    });
    _exit(0);
  }
  waitpid(child, nullptr, 0);
  const fs::path log = folder_ / kUnfinishedName / kFramesName;
  const std::uintmax_t size = fs::file_size(log);
  fs::resize_file(log, size / 5 * 3 + 7);  // as if the run wrote its fourth frame now
  const auto playback = open_frames(folder_);
  EXPECT_EQ(playback->num_frames(), 3);
  EXPECT_EQ(playback->meshes().cloths[0].color, (std::array{0.0, 0.5, 1.0}));
  for (const int k : {2, 0, 1}) expect_frame(playback->read(k), film.animation(), k);

  RunOptions resumed = read_unfinished_run(folder_).options;
  resumed.keep_going = [&] {
    EXPECT_GE(playback->num_frames(), 1);
    return true;
  };
  run_to_folder(scene(), resumed);
  EXPECT_FALSE(fs::exists(log));
  EXPECT_EQ(playback->num_frames(), 7) << "of the open file, which has been removed";
  for (const int k : {6, 3, 0}) expect_frame(playback->read(k), film.animation(), k);
}

TEST_F(PlaybackOfARun, HasItsWorldAtEveryFrame) {
  FilmSink film;
  RunOptions without = options(5);
  without.pc2 = true;
  without.glb = false;
  run_to_folder(scene(), without, {&film});
  const FramesAndWorld run = open_frames_and_world(folder_);
  ASSERT_TRUE(run.world) << run.why_not;
  EXPECT_EQ(run.counts.newton_steps.size(), 5u);
  EXPECT_EQ(run.frames->meshes().title, "contact/rotating_ball");
  EXPECT_EQ(run.frames->num_frames(), 6);
  EXPECT_EQ(open_frames(folder_)->num_frames(), 6);
  EXPECT_EQ(run.frames->meshes().cloths[0].color, (std::array{0.0, 0.5, 1.0}));
  for (const int k : {3, 0, 5, 1}) expect_frame(run.frames->read(k), film.animation(), k);

  SceneRun live(scene(), make_serial_jobs());
  for (int k = 0; k < 4; ++k) live.next_frame();
  run.world->show(*run.frames, 4);
  const World &past = run.world->world(), &now = live.world();
  EXPECT_EQ(past.time(), 4 / scene().fps);
  for (const ParticleValue value : {ParticleValue::strain, ParticleValue::shear}) {
    const std::vector<float> found = compute_values(value, past, past.cloth(0)),
                             expected = compute_values(value, now, now.cloth(0));
    ASSERT_EQ(found.size(), expected.size());
    for (std::size_t i = 0; i < found.size(); ++i) EXPECT_NEAR(found[i], expected[i], 1e-3) << i;
  }
  const double fall = 4 / scene().fps * 9.81;
  EXPECT_NEAR(past.state(past.cloth(0)).v.get(0).y(), -fall, 0.2 * fall) << "a mean over the last frame";
}

TEST_F(PlaybackOfARun, ThatIsUnfinishedHasItsWorld) {
  FilmSink film;
  RunOptions some = options(6);
  some.checkpoint_every = 2;
  run_to_folder(scene(), some, {&film}, [](const Progress& progress) { return progress.frame < 4; });
  ASSERT_TRUE(fs::exists(folder_ / kUnfinishedName));
  fs::remove(folder_ / kRunName);  // of the interrupted run
  const FramesAndWorld run = open_frames_and_world(folder_);
  ASSERT_TRUE(run.world) << run.why_not;
  EXPECT_EQ(run.frames->num_frames(), 5);
  run.world->show(*run.frames, 2);
  EXPECT_NEAR(run.world->world().state(run.world->world().cloth(0)).position(7).y(),
              film.animation().cloths[0].frames[2][22], 1e-6);
}

TEST_F(PlaybackOfARun, HasNoWorldWithoutTheFilesOfItsScene) {
  const fs::path mesh = folder_.string() + ".obj";
  write_obj(mesh, build_grid_mesh({.size_x = 1, .size_z = 1, .cells_x = 3, .cells_z = 3},
                                  GridDiagonals::alternating));
  SceneDesc sheet = scene();
  sheet.cloths[0].shape = MeshSource{.file = mesh};
  RunOptions both = options(1);
  both.pc2 = true;
  run_to_folder(sheet, both);
  EXPECT_TRUE(open_frames_and_world(folder_).world);
  const auto expect_positions_only = [&](const std::string& why) {
    const FramesAndWorld run = open_frames_and_world(folder_);
    EXPECT_FALSE(run.world);
    EXPECT_EQ(run.why_not, why);
    EXPECT_EQ(run.frames->num_frames(), 2);
  };
  std::ofstream(mesh, std::ios::app) << "v 7 7 7\n";
  expect_positions_only((folder_ / "as_run/scene.toml").string() +
                        ": scene or meshes have changed since the run");
  fs::remove(mesh);
  EXPECT_FALSE(open_frames_and_world(folder_).world);
  fs::remove_all(folder_ / "as_run");
  EXPECT_FALSE(open_frames_and_world(folder_).world);
  EXPECT_EQ(open_frames_and_world(folder_ / "animation.glb").why_not,
            (folder_ / "animation.glb").string() + " contains positions only");
}

TEST_F(PlaybackOfARun, WithoutFramesIsRefused) {
  RunOptions without = options(1);
  without.glb = false;
  const auto message = [&](const fs::path& path) -> std::string {
    try {
      open_frames(path);
    } catch (const InputError& error) {
      return error.what();
    }
    return "no error";
  };
  EXPECT_EQ(message(folder_), folder_.string() + ": cannot be read: No such file or directory");
  run_to_folder(scene(), without);
  EXPECT_EQ(message(folder_),
            folder_.string() + " has no frames to show: it was run with --no-glb and --no-pc2");
  fs::create_directories(folder_ / "empty");
  EXPECT_EQ(message(folder_ / "empty"), (folder_ / "empty").string() + " holds no run: there is no run.json");
}

TEST(PlayHead, FollowsTheTimeAndLoops) {
  PlayHead head{.frames_per_second = 30};
  head.advance(0.5, 100);
  EXPECT_EQ(head.frame(), 15);
  head.advance(3, 100);
  EXPECT_EQ(head.frame(), 5) << "the last frame lasts as long as the others";
  head.is_playing = false;
  head.advance(1, 100);
  EXPECT_EQ(head.frame(), 5);
}

TEST(PlayHead, StopsAtTheEndAndBeginsAgain) {
  PlayHead head{.frames_per_second = 30, .loops = false};
  head.advance(10, 100);
  EXPECT_EQ(head.frame(), 99);
  EXPECT_FALSE(head.is_playing);
  head.play(100);
  EXPECT_EQ(head.frame(), 0);
  head.advance(1, 100);
  EXPECT_EQ(head.frame(), 30);
}

TEST(PlayHead, StepsPauseAndStayWithinTheRun) {
  PlayHead head{.frames_per_second = 30};
  head.step(1, 3);
  EXPECT_EQ(head.frame(), 1);
  EXPECT_FALSE(head.is_playing);
  head.step(5, 3);
  EXPECT_EQ(head.frame(), 2);
  head.step(-1, 3);
  head.step(-7, 3);
  EXPECT_EQ(head.frame(), 0);
  head.seek(2, 3);
  EXPECT_EQ(head.frame(), 2);
}

}  // namespace
}  // namespace weft::engine
