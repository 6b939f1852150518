#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <memory>

#include "apps/common/command_line.h"
#include "apps/common/progress.h"
#include "commands.h"
#include "run_command.h"
#include "weft/core/make_folder.h"
#include "weft/core/staged_file.h"
#include "weft/error.h"
#include "weft/io/glb_reader.h"
#include "weft/pictures/painter.h"
#include "weft/render/video.h"
#include "weft/run/film.h"
#include "weft/run/scene_run.h"
#include "weft/scene/scene_library.h"
#include "weft/scene/scene_reader.h"
#include "weft/scene/scene_world.h"

namespace weft::engine::app {
namespace {

namespace fs = std::filesystem;

struct RenderRequest {
  std::string scene;  // a scene, a .glb file, or a folder with animation.glb
  fs::path out = "weft.png";
  std::vector<int> frames;  // of pictures; of a video the last one; empty: the scene's last one
  int columns = 0;          // of a contact sheet; 0: as many as pictures, at most 4
  int every = 1;            // of a video: every so many frames
  std::string size = "1280x720";
  std::vector<double> camera;  // azimuth, elevation, zoom
  bool transparent = false, springs = false;
  int threads = 0;
  Overrides overrides;
};

struct Footage {
  Animation animation;
  RunOutcome outcome;
};

/// An animation written by `weft run`, or simulated now.
class Source {
 public:
  explicit Source(const RenderRequest& request) : request_(request) {
    const fs::path path = request.scene;
    if (fs::is_directory(path)) {
      file_ = path / "animation.glb";
    } else if (path.extension() == ".glb") {
      file_ = path;
    } else {
      scene_ = read_scene(find_scene(request.scene), request.overrides);
    }
    if (scene_) return;
    if (!request.overrides.empty())
      throw InputError("--set does not apply to " + file_.string() + ": it is already simulated");
    if (request.springs)
      throw InputError("--springs requires a scene: " + file_.string() + " does not contain springs");
  }

  /// At least up to the last requested frame, unless the simulation ends before.
  Footage get() const {
    if (!scene_) return {read_glb(file_), RunOutcome::done};
    RunOptions options{.threads = choose_threads(request_.threads),
                       .check_passages = false,
                       .keep_going = [] { return !interrupted(); }};
    if (!request_.frames.empty())
      options.frames = *std::max_element(request_.frames.begin(), request_.frames.end());
    if (options.frames == 0) options.frames = 1;
    ProgressBar bar(scene_->name);
    FilmSink film;
    const RunReport report = run_scene(*scene_, options, {&film}, [&](const Progress& progress) {
      bar.update(progress);
      return !interrupted();
    });
    bar.clear();
    for (const std::string& warning : report.warnings) say("warning: " + warning);
    if (report.outcome == RunOutcome::failed) say("the simulation failed at " + report.failure);
    return {film.take(), report.outcome};
  }

  std::vector<SpringsToDraw> springs() const {
    std::vector<SpringsToDraw> springs;
    if (!request_.springs) return springs;
    const SceneWorld built = build_world(*scene_, make_jobs(1));
    for (int c = 0; c < built.world.num_cloths(); ++c)
      springs.push_back({c, built.world.model(built.world.cloth(c)).topology});
    return springs;
  }

 private:
  const RenderRequest& request_;
  std::optional<SceneDesc> scene_;
  fs::path file_;
};

PaintSettings paint_settings(const RenderRequest& request) {
  PaintSettings settings{.size = parse_size(request.size)};
  settings.style.transparent = request.transparent;
  if (request.camera.size() > 0) settings.view.azimuth_deg = request.camera[0];
  if (request.camera.size() > 1) settings.view.elevation_deg = request.camera[1];
  if (request.camera.size() > 2) settings.zoom = request.camera[2];
  if (!(std::abs(settings.view.azimuth_deg) <= 360 && std::abs(settings.view.elevation_deg) < 90 &&
        settings.zoom > 0)) {
    throw InputError(
        "--camera: expected azimuth from -360 to 360, elevation between -90 and 90 (degrees), zoom above 0");
  }
  return settings;
}

/// The requested frames that the simulation has reached; its last one if it reached none, or none was
/// requested.
std::vector<int> choose_frames(std::vector<int> frames, RunOutcome outcome, int last) {
  if (outcome != RunOutcome::done) std::erase_if(frames, [&](int frame) { return frame > last; });
  if (frames.empty()) frames = {last};
  return frames;
}

/// Renders the available frames, even if the simulation failed or was interrupted; returns its outcome.
RunOutcome render(const RenderRequest& request) {
  require_picture(request.out);
  PaintSettings settings = paint_settings(request);
  const Source source(request);
  auto device = make_offscreen_device();  // first: fails before simulating on machines without graphics
  if (request.out.has_parent_path()) make_folder(request.out.parent_path());
  require_writable(request.out);
  if (is_video(request.out)) require_ffmpeg(request.out);
  catch_interrupts();
  const auto [animation, outcome] = source.get();
  settings.style.springs = source.springs();
  Painter painter(animation, settings, std::move(device));
  if (is_video(request.out)) {
    const bool was_interrupted = interrupted();  // while simulating
    painter.write_video(request.out, request.every, [&] { return interrupted() != was_interrupted; });
  } else {
    const std::vector<int> frames = choose_frames(request.frames, outcome, painter.last_frame());
    painter.write_pictures(request.out, frames, request.columns);
  }
  if (interrupted()) fmt::print("interrupted: partial results kept\n");
  fmt::print("written {}\n", request.out.string());
  return interrupted() ? RunOutcome::interrupted : outcome;
}

}  // namespace

void add_render_command(CLI::App& app, int& exit_code) {
  auto request = std::make_shared<RenderRequest>();
  CLI::App* command =
      app.add_subcommand("render", "Draw a scene: a picture, a contact sheet or a video; no display needed");
  command
      ->add_option("SCENE", request->scene,
                   "A scene, or results of weft run: the folder or its animation.glb")
      ->required();
  command->add_option("--out", request->out, "A .png, .jpg, .mp4, .webp or .gif file")
      ->type_name("FILE")
      ->capture_default_str();
  command
      ->add_option("--frame,--frames", request->frames,
                   "Frame to draw, 0 being the start (default: the last); several, as in 0,20,40, make a "
                   "contact sheet; for "
                   "a video, its last frame")
      ->delimiter(',')
      ->check(CLI::Range(0, 1000000))
      ->type_name("N");
  command->add_option("--columns", request->columns, "Columns of a contact sheet")
      ->check(CLI::Range(1, 100))
      ->type_name("N");
  command->add_option("--every", request->every, "For a video: draw every N-th frame")
      ->check(CLI::Range(1, 1000))
      ->type_name("N")
      ->capture_default_str();
  command->add_option("--size", request->size, "Picture size in pixels")
      ->type_name("WxH")
      ->capture_default_str();
  command
      ->add_option("--camera", request->camera,
                   "Azimuth, elevation (degrees) and zoom, as in 30,20,1.5; the camera frames the scene")
      ->delimiter(',')
      ->expected(1, 3)
      ->type_name("A,E,Z");
  command->add_flag("--transparent", request->transparent, "Transparent background, without sky and ground");
  command->add_flag("--springs", request->springs, "Draw particles and springs instead of cloth");
  command->add_option("--threads", request->threads, "Threads of the simulation (default: all processors)")
      ->check(CLI::Range(1, 1024))
      ->type_name("T");
  add_set_option(*command, request->overrides);
  command->callback([request, &exit_code] { exit_code = exit_code_of(render(*request)); });
}

}  // namespace weft::engine::app
