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
#include "weft/run/film.h"
#include "weft/run/run_folder.h"

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

TEST_F(PlaybackOfARun, WithoutAnimationIsRefused) {
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
  EXPECT_EQ(message(folder_), folder_.string() + " has no frames to show: it was run with --no-glb");
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
