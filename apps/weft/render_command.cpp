#include <fmt/core.h>
#include <unistd.h>

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
#include "weft/pictures/painter.h"
#include "weft/render/video.h"
#include "weft/run/film.h"
#include "weft/run/playback.h"
#include "weft/run/scene_run.h"
#include "weft/scene/scene_library.h"
#include "weft/scene/scene_reader.h"
#include "weft/scene/scene_world.h"

namespace weft::engine::app {
namespace {

namespace fs = std::filesystem;

struct RenderRequest {
  std::string scene;  // a scene, the folder of a run, or its .glb file
  fs::path out = "weft.png";
  std::vector<int> frames;  // of pictures; of a video the last one; empty: the scene's last one
  int columns = 0;          // of a contact sheet; 0: as many as pictures, at most 4
  int every = 1;            // of a video: every so many frames
  std::string size = "1280x720";
  std::vector<double> camera;      // azimuth, elevation, zoom
  std::vector<double> look_at;     // empty: the middle of what is framed
  std::optional<double> distance;  // of the eye from look_at, in place of the framing [m]
  bool fits_cloth = false;
  std::optional<int> smooth;
  std::optional<ParticleValue> color;
  std::vector<double> range;  // of the colours' values; empty: of the frames that are drawn
  bool transparent = false, springs = false;
  int threads = 0;
  Overrides overrides;
};

struct Footage {
  std::unique_ptr<FrameSource> frames;
  RunOutcome outcome;
};

/// Frames written by `weft run`, or simulated now.
class Source {
 public:
  explicit Source(const RenderRequest& request) : request_(request) {
    const fs::path path = request.scene;
    if (fs::is_directory(path) || path.extension() == ".glb") {
      file_ = path;
    } else {
      scene_ = read_scene(find_scene(request.scene), request.overrides);
    }
    if (scene_) return;
    if (!request.overrides.empty())
      throw InputError("--set does not apply to " + file_.string() + ": it is already simulated");
    if (request.color == ParticleValue::contact)
      throw InputError("--color contact requires a scene: " + file_.string() + " has no forces of contacts");
    if (!request.springs && (!request.color || *request.color == ParticleValue::speed)) return;
    run_ = open_frames_and_world(file_);
    if (!run_.world)
      throw InputError(
          std::string(request.springs ? "--springs requires" : "--color strain and shear require") +
          " the run's scene: " + run_.why_not);
  }

  /// At least up to the last requested frame, unless the simulation ends before.
  Footage get() {
    if (!scene_) return {frames_of_run(), RunOutcome::done};
    RunOptions options{.threads = choose_threads(request_.threads),
                       .check_passages = false,
                       .keep_going = [] { return !interrupted(); }};
    if (!request_.frames.empty())
      options.frames = *std::max_element(request_.frames.begin(), request_.frames.end());
    if (options.frames == 0) options.frames = 1;
    ProgressBar bar(scene_->name);
    auto film = std::make_unique<FilmSpool>(request_.out, request_.color);
    const RunReport report = run_scene(*scene_, options, {film.get()}, [&](const Progress& progress) {
      bar.update(progress);
      return !interrupted();
    });
    bar.clear();
    for (const std::string& warning : report.warnings) say("warning: " + warning);
    if (report.outcome == RunOutcome::failed) say("the simulation failed at " + report.failure);
    return {std::move(film), report.outcome};
  }

  std::vector<SpringsToDraw> springs() const {
    if (!request_.springs) return {};
    return run_.world ? springs_of(run_.world->world())
                      : springs_of(build_world(*scene_, make_jobs(1)).world);
  }

 private:
  static std::vector<SpringsToDraw> springs_of(const World& world) {
    std::vector<SpringsToDraw> springs;
    for (int c = 0; c < world.num_cloths(); ++c) springs.push_back({c, world.model(world.cloth(c)).topology});
    return springs;
  }

  /// With the values to colour by.
  std::unique_ptr<FrameSource> frames_of_run() {
    if (!run_.frames) run_.frames = open_frames(file_);
    if (request_.color == ParticleValue::speed) return std::make_unique<FramesWithSpeeds>(*run_.frames);
    if (request_.color) return std::make_unique<FramesWithValues>(*run_.frames, *run_.world, *request_.color);
    return std::move(run_.frames);
  }

  const RenderRequest& request_;
  std::optional<SceneDesc> scene_;
  fs::path file_;       // or folder, without a scene
  FramesAndWorld run_;  // its frames, with a world if that is needed
};

PaintSettings paint_settings(const RenderRequest& request) {
  PaintSettings settings{.size = parse_size(request.size)};
  settings.style.transparent = request.transparent;
  if (request.camera.size() > 0) settings.view.azimuth_deg = request.camera[0];
  if (request.camera.size() > 1) settings.view.elevation_deg = request.camera[1];
  if (request.camera.size() > 2) settings.zoom = request.camera[2];
  settings.framed = request.fits_cloth ? Framed::cloth : Framed::everything;
  if (!request.look_at.empty())
    settings.look_at = Vec3(request.look_at[0], request.look_at[1], request.look_at[2]);
  settings.style.smooth = request.smooth;
  if (!request.range.empty() && !(request.range[0] < request.range[1]))
    throw InputError("--range: expected two values in ascending order, as in 0,2.5");
  if (!(std::abs(settings.view.azimuth_deg) <= 360 && std::abs(settings.view.elevation_deg) < 90 &&
        settings.zoom > 0)) {
    throw InputError(
        "--camera: expected azimuth from -360 to 360, elevation between -90 and 90 (degrees), zoom above 0");
  }
  if (request.distance) {
    if (!settings.look_at || request.camera.size() > 2)
      throw InputError(
          "--distance is from the point of --look-at, and takes the place of the zoom: write both "
          "without a zoom, as in --camera 30,20 --look-at 0,1,0 --distance 3");
    settings.camera = settings.view;
    settings.camera->target = *settings.look_at;
    settings.camera->distance = *request.distance;
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

/// Frames of a video or sequence, or the pictures.
std::vector<int> drawn_frames(const RenderRequest& request, RunOutcome outcome, int last) {
  if (!is_video(request.out) && !is_sequence(request.out))
    return choose_frames(request.frames, outcome, last);
  std::vector<int> frames;
  for (int frame = 0; frame <= last; frame += request.every) frames.push_back(frame);
  return frames;
}

/// Reports the drawing of many pictures on a terminal.
class DrawingProgress {
 public:
  void update(int drawn, int all) {
    if (!is_terminal_) return;
    fmt::print(stderr, "\rdrawn {} of {} pictures", drawn, all);
    if (drawn == all) fmt::print(stderr, "\r\x1b[K");
    std::fflush(stderr);
  }

 private:
  bool is_terminal_ = isatty(STDERR_FILENO) != 0;
};

/// Renders the available frames, even if the simulation failed or was interrupted; returns its outcome.
RunOutcome render(const RenderRequest& request) {
  require_picture(request.out);
  PaintSettings settings = paint_settings(request);
  Source source(request);
  auto device = make_offscreen_device();  // first: fails before simulating on machines without graphics
  if (request.out.has_parent_path()) make_folder(request.out.parent_path());
  if (!is_sequence(request.out)) require_writable(request.out);
  if (is_video(request.out)) require_ffmpeg(request.out);
  catch_interrupts();
  const auto [film, outcome] = source.get();
  settings.style.springs = source.springs();
  if (request.color) {
    const int last = film->num_frames() - 1;
    const std::vector<int> drawn = drawn_frames(request, outcome, last);
    require_frames(drawn, last);
    settings.legend = label_of(*request.color).text();
    settings.style.range =
        request.range.empty() ? find_range(*film, drawn) : std::array{request.range[0], request.range[1]};
  }
  Painter painter(*film, settings, std::move(device));
  const bool was_interrupted = interrupted();  // while simulating
  DrawingProgress progress;
  const auto go_on = [&](int drawn, int all) {
    progress.update(drawn, all);
    return interrupted() == was_interrupted;
  };
  if (is_video(request.out)) {
    painter.write_video(request.out, request.every, go_on);
  } else if (is_sequence(request.out)) {
    painter.write_sequence(request.out, request.every, go_on);
  } else {
    const std::vector<int> frames = choose_frames(request.frames, outcome, painter.last_frame());
    painter.write_pictures(request.out, frames, request.columns);
  }
  if (interrupted()) fmt::print("interrupted: partial results kept\n");
  fmt::print("written {}\n", request.out.string());
  return interrupted() ? RunOutcome::interrupted : outcome;
}

std::map<std::string, ParticleValue> values_by_word() {
  std::map<std::string, ParticleValue> values;
  for (const ParticleValue value : kParticleValues) values[label_of(value).word] = value;
  return values;
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
  command
      ->add_option(
          "--out", request->out,
          "A .png, .jpg, .mp4, .webp or .gif file; frame_####.png: a file per frame, with its number")
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
  command->add_option("--every", request->every, "For a video or files per frame: draw every N-th frame")
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
  command->add_option("--look-at", request->look_at, "Point in the picture's middle, as in 0,1.2,0 (metres)")
      ->delimiter(',')
      ->expected(3)
      ->type_name("X,Y,Z");
  command
      ->add_option("--distance", request->distance,
                   "Distance of the eye from the point of --look-at, in metres")
      ->check(CLI::PositiveNumber)
      ->type_name("D");
  command
      ->add_option_function<std::string>(
          "--fit", [request](const std::string& what) { request->fits_cloth = what == "cloth"; },
          "The camera frames everything, or only the cloth")
      ->check(CLI::IsMember({"all", "cloth"}))
      ->type_name("all|cloth");
  command
      ->add_option("--smooth", request->smooth,
                   "Loop subdivisions of drawn cloth, 0 to 2 (default: by its number of triangles)")
      ->check(CLI::Range(0, 2))
      ->type_name("N");
  command
      ->add_option("--color", request->color,
                   "Colour cloth by the strain of its threads, its shear, its speed or the pressure of "
                   "contacts, with a legend")
      ->transform(CLI::CheckedTransformer(values_by_word()))
      ->type_name("strain|shear|speed|contact");
  command
      ->add_option(
          "--range", request->range,
          "Values of the first and the last colour, as in 0,5 (default: of the frames that are drawn)")
      ->delimiter(',')
      ->expected(2)
      ->type_name("A,B");
  command->add_flag("--transparent", request->transparent, "Transparent background, without sky and ground");
  command->add_flag("--springs", request->springs, "Draw particles and springs instead of cloth");
  command->add_option("--threads", request->threads, "Threads of the simulation (default: all processors)")
      ->check(CLI::Range(1, 1024))
      ->type_name("T");
  add_set_option(*command, request->overrides);
  command->callback([request, &exit_code] { exit_code = exit_code_of(render(*request)); });
}

}  // namespace weft::engine::app
