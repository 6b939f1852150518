/// `weft render` and the pictures of `weft demo`, from a shell.

#include <chrono>
#include <thread>

#include "tests/app/background.h"
#include "tests/app/program.h"
#include "weft/render/device.h"
#include "weft/render/image.h"

namespace weft::engine {
namespace {

const std::string kQuick = " --set cloth[0].grid.cells=[8,8] --set solver.steps_per_frame=20";

class Render : public App {
 protected:
  void SetUp() override {
    App::SetUp();
    try {
      make_offscreen_device();
    } catch (const GraphicsError& error) {
      GTEST_SKIP() << error.what();
    }
  }
};

TEST_F(Render, DrawsAFrameOfTheSizeThatWasAskedFor) {
  const Finished done =
      shell("weft render paper/fig6_ball --frame 4 --size 320x200 --out a/ball.png" + kQuick);
  EXPECT_EQ(done.exit_code, 0) << done.err;
  EXPECT_TRUE(contains(done.out, "a/ball.png"));
  const Image image = read_png("a/ball.png");
  EXPECT_EQ(image.width, 320);
  EXPECT_EQ(image.height, 200);
  EXPECT_EQ(image.pixel(0, 0)[3], 255);
}

TEST_F(Render, DrawsAContactSheetOfAnEarlierRunWithoutSimulating) {
  ASSERT_EQ(shell("weft run paper/fig3_horizontal --frames 6 --out done" + kQuick).exit_code, 0);
  EXPECT_EQ(shell("weft render done --frames 0,3,6 --columns 2 --size 100x80 --transparent --out sheet.png")
                .exit_code,
            0);
  const Image sheet = read_png("sheet.png");
  EXPECT_GE(sheet.width, 200);
  EXPECT_LT(sheet.width, 220);
  EXPECT_GE(sheet.height, 160);
  EXPECT_EQ(sheet.pixel(0, 0)[3], 0) << "transparent";
  EXPECT_EQ(shell("weft render done/animation.glb --frame 2 --out b.jpg").exit_code, 0);
}

TEST_F(Render, MakesAVideo) {
  if (shell("ffprobe -version").exit_code != 0) GTEST_SKIP() << "ffmpeg is not installed";
  EXPECT_EQ(shell("weft render paper/fig6_ball --frames 6 --every 2 --size 100x80 --out ball.mp4" + kQuick)
                .exit_code,
            0);
  const Finished probe = shell(
      "ffprobe -v error -count_frames -show_entries stream=nb_read_frames,width,height,avg_frame_rate -of "
      "csv=p=0 ball.mp4");
  EXPECT_EQ(probe.out, "100,80,30/1,4\n") << probe.err;
}

TEST_F(Render, InterruptedVideoHoldsTheFramesThatWereDone) {
  if (shell("ffprobe -version").exit_code != 0) GTEST_SKIP() << "ffmpeg is not installed";
  // A signal may come within the first frame: later ones come until a frame was done.
  int frames = 0;
  for (int delay_ms = 0; frames < 2 && delay_ms < 20000; delay_ms = 2 * delay_ms + 50) {
    Background render({"render", "paper/fig6_ball", "--frames", "100000", "--size", "100x80", "--out",
                       "ball.mp4", "--set", "cloth[0].grid.cells=[8,8]"});
    ASSERT_TRUE(render.catches(SIGTERM)) << read_text("background.txt");
    std::this_thread::sleep_for(std::chrono::milliseconds(delay_ms));
    render.send(SIGTERM);
    EXPECT_EQ(render.wait(), 130) << read_text("background.txt");
    const Finished probe =
        shell("ffprobe -v error -count_frames -show_entries stream=nb_read_frames -of csv=p=0 ball.mp4");
    frames = std::atoi(probe.out.c_str());
    EXPECT_GE(frames, 1) << "the start at least" << probe.err;
  }
  EXPECT_GE(frames, 2) << "the start and a frame";
}

TEST_F(Render, InterruptedPictureIsOfTheLastFrameThatWasDone) {
  Background render(
      {"render", "paper/fig6_ball", "--frame", "100000", "--size", "100x80", "--out", "ball.png"});
  ASSERT_TRUE(render.catches(SIGTERM)) << read_text("background.txt");
  render.send(SIGTERM);
  EXPECT_EQ(render.wait(), 130) << read_text("background.txt");
  EXPECT_EQ(read_png("ball.png").width, 100);
}

TEST_F(Render, WritesNumberedFilesPerFrame) {
  EXPECT_EQ(shell("weft render paper/fig6_ball --frames 4 --every 2 --size 100x80 --out f_###.png" + kQuick)
                .exit_code,
            0);
  for (const char* file : {"f_000.png", "f_002.png", "f_004.png"}) EXPECT_EQ(read_png(file).width, 100);
  EXPECT_FALSE(fs::exists("f_001.png"));
  EXPECT_FALSE(fs::exists("f_###.png"));
}

/// The same but for rounding.
void expect_like(const Image& image, const Image& expected) {
  ASSERT_EQ(image.rgba.size(), expected.rgba.size());
  double sum = 0;
  for (std::size_t k = 0; k < image.rgba.size(); ++k) sum += std::abs(image.rgba[k] - expected.rgba[k]);
  EXPECT_LT(sum / static_cast<double>(image.rgba.size()), 0.5);
}

TEST_F(Render, ColoursClothByValues) {
  const std::string base = "weft render paper/fig6_ball --frame 4 --size 320x240 --fit cloth" + kQuick;
  EXPECT_EQ(shell(base + " --out plain.png").exit_code, 0);
  for (const std::string value : {"strain", "shear", "speed"}) {
    const Finished done = shell(base + " --color " + value + " --out " + value + ".png");
    EXPECT_EQ(done.exit_code, 0) << done.err;
    EXPECT_NE(read_png(value + ".png").rgba, read_png("plain.png").rgba);
  }
  ASSERT_EQ(shell("weft run paper/fig6_ball --frames 4 --out done" + kQuick).exit_code, 0);
  EXPECT_EQ(shell("weft render done --color speed --range 0,2 --out speeds.png").exit_code, 0);
  for (const std::string value : {"strain", "shear"}) {  // speeds are means over a frame
    const std::string words =
        "weft render done --size 320x240 --fit cloth --color " + value + " --out run.png";
    EXPECT_EQ(shell(words).exit_code, 0);
    expect_like(read_png("run.png"), read_png(value + ".png"));
  }
  expect_bad_input("weft render done --color contact --out a.png", "done has no forces of contacts");
  expect_bad_input(
      "weft render done/animation.glb --color strain --out a.png",
      "--color strain and shear require the run's scene: done/animation.glb contains positions only");
  expect_bad_input("weft render done --color speed --range 2,1 --out a.png", "--range: expected two values");
}

TEST_F(Render, LooksAtThePointThatWasAskedFor) {
  const auto middle = [&](const std::string& options) {
    const std::string file = "at.png";
    EXPECT_EQ(shell("weft render paper/fig6_ball --frame 0 --size 101x81 --transparent --out " + file +
                    options + kQuick)
                  .exit_code,
              0);
    return static_cast<int>(read_png(file).pixel(50, 40)[3]);
  };
  EXPECT_EQ(middle(" --look-at 0,9,0"), 0) << "above the scene";
  EXPECT_EQ(middle(" --fit cloth"), 255);
}

TEST_F(Render, DrawsSprings) {
  EXPECT_EQ(shell("weft render paper/fig4_vertical --frame 0 --springs --out springs.png" + kQuick).exit_code,
            0);
  EXPECT_TRUE(fs::exists("springs.png"));
}

TEST_F(Render, BadInputIsNamedBeforeAnythingIsSimulated) {
  expect_bad_input("weft render paper/fig6_ball --out film.avi", "film.avi: expected a file name ending in");
  expect_bad_input("weft render paper/fig6_ball --size big", "--size big: expected WIDTHxHEIGHT");
  expect_bad_input("weft render paper/fig6_ball --size 100000x100000", "each from 1 to 16384");
  expect_bad_input("weft render paper/fig6_ball --camera 0,95", "elevation between -90 and 90");
  expect_bad_input("weft render no/such/scene", "no/such/scene");
  expect_bad_input("mkdir d; weft render d", "d holds no run: there is no run.json");
  expect_bad_input("touch f; weft render paper/fig6_ball --out f/a.png", "f");
  if (fs::exists("/proc/version"))
    expect_bad_input("weft render paper/fig6_ball --out /proc/a.png", "/proc/a.png");
}

TEST_F(Render, AFrameThatIsNotThereIsNamed) {
  ASSERT_EQ(shell("weft run paper/fig3_horizontal --frames 2 --out done" + kQuick).exit_code, 0);
  expect_bad_input("weft render done --frame 7 --out a.png", "there is no frame 7; the last one is 2");
  EXPECT_EQ(shell("weft render done --springs --out springs.png").exit_code, 0);
  expect_bad_input("weft render done/animation.glb --springs --out a.png",
                   "--springs requires the run's scene: done/animation.glb contains positions only");
  expect_bad_input("weft render done --set scene.fps=3 --out a.png", "--set does not apply");
}

TEST_F(Render, WithoutFfmpegAVideoIsRefusedWithAdvice) {
  expect_bad_input("PATH=/nowhere weft render paper/fig6_ball --out a.mp4",
                   "requires ffmpeg, which is not installed");
}

TEST_F(App, RenderWithoutOpenGlSaysWhatToInstall) {
  const Finished done = shell("__EGL_VENDOR_LIBRARY_DIRS=/nowhere weft render paper/fig6_ball --out a.png");
  if (done.exit_code == 0) GTEST_SKIP() << "this EGL does not look for vendors";
  EXPECT_EQ(done.exit_code, 1);
  EXPECT_TRUE(contains(done.err, "libgl1-mesa-dri")) << done.err;
  EXPECT_FALSE(fs::exists("a.png"));
}

}  // namespace
}  // namespace weft::engine
