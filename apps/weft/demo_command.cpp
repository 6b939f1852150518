#include <fmt/core.h>

#include <memory>

#include "apps/common/progress.h"
#include "commands.h"
#include "run_command.h"
#include "summary.h"
#include "view_command.h"
#include "weft/pictures/painter.h"
#include "weft/render/video.h"
#include "weft/run/playback.h"

namespace weft::engine::app {
namespace {

namespace fs = std::filesystem;

/// Scenes of the paper's Figures 3 to 6, each with a version in real fabric.
const std::vector<std::string> kScenes = {
    "paper/fig3_horizontal", "paper/fig3_horizontal_real", "paper/fig4_vertical", "paper/fig4_vertical_real",
    "paper/fig5_falling",    "paper/fig5_falling_real",    "paper/fig6_ball",     "paper/fig6_ball_real",
};

const PictureSize kSize{1280, 720};
constexpr int kEvery = 2;  // frames of the videos

/// A picture of the last frame and a video, in the run's folder.
void paint(const fs::path& folder) {
  const std::unique_ptr<FrameSource> frames = open_frames(folder);
  Painter painter(*frames, {.size = kSize, .view = {}, .style = {}, .legend = {}}, make_offscreen_device());
  painter.write_pictures(folder / "picture.png", {painter.last_frame()}, 1);
  const fs::path video = folder / "video.mp4";
  require_ffmpeg(video);
  painter.write_video(video, kEvery, [](int, int) { return !interrupted(); });
}

/// Optional pictures: a failure is reported once and does not stop the demo.
class Pictures {
 public:
  void paint(const fs::path& folder) {
    if (!error_.empty()) return;
    try {
      app::paint(folder);
    } catch (const std::runtime_error& error) {
      error_ = error.what();
    }
  }

  void report_error() const {
    if (!error_.empty()) fmt::print("\nPictures or videos were not written: {}\n", error_);
  }

 private:
  std::string error_;
};

/// Optional window: a failure does not stop the demo.
void show_window() {
  const std::string scene = "paper/fig6_ball_real";
  fmt::print("\nThe last scene in a window: grab the cloth; H for help, Q to close it (weft view {}).\n",
             scene);
  std::fflush(stdout);
  try {
    view({.scene = scene});
  } catch (const std::runtime_error& error) {
    fmt::print("No window: {}\n", error.what());
  }
}

int run_demo(const fs::path& out) {
  fmt::print("The paper's four scenes, each also with real fabric (_real).\n\n{}", table_head());
  Pictures pictures;
  for (const std::string& scene : kScenes) {
    const FinishedRun run =
        run_to_files({.scene = scene, .options = {.threads = 0, .folder = (out / scene).string()}});
    fmt::print("{}", table_line(run.report));
    std::fflush(stdout);
    for (const std::string& warning : run.report.warnings) fmt::print("  warning: {}\n", warning);
    if (run.report.outcome == RunOutcome::failed) fmt::print("  failed at {}\n", run.report.failure);
    if (run.report.outcome != RunOutcome::done) return exit_code_of(run.report.outcome);
    pictures.paint(out / scene);
    if (interrupted()) return kInterrupted;
  }
  fmt::print(
      "\nEach scene's picture.png, video.mp4, animation.glb (for any glTF viewer) and report.json are in "
      "{}.\n",
      (out / "paper").string());
  pictures.report_error();
  if (has_spectator()) show_window();
  return kDone;
}

}  // namespace

void add_demo_command(CLI::App& app, int& exit_code) {
  auto out = std::make_shared<fs::path>("out");
  CLI::App* command = app.add_subcommand("demo", "Simulate the paper's scenes, each also with real fabric");
  command->add_option("--out", *out, "Folder for the results")->type_name("DIR")->capture_default_str();
  command->callback([out, &exit_code] { exit_code = run_demo(*out); });
}

}  // namespace weft::engine::app
