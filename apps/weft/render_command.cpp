#include <fmt/core.h>

#include <algorithm>
#include <memory>

#include "commands.h"
#include "common.h"
#include "progress.h"
#include "weft/core/error.h"
#include "weft/io/glb_reader.h"
#include "weft/lab/scene_picture.h"
#include "weft/render/renderer.h"
#include "weft/render/video.h"
#include "weft/run/runner.h"
#include "weft/scene/scene_library.h"
#include "weft/scene/scene_reader.h"
#include "weft/scene/scene_world.h"

namespace weft::app {
namespace {

namespace fs = std::filesystem;

constexpr int kSheetGap = 6;  // between the pictures of a contact sheet [pixels]

struct RenderRequest {
  std::string scene;  // a scene, a .glb file, or a folder with animation.glb
  fs::path out = "weft.png";
  std::vector<int> frames;  // of pictures; of a video the last one; empty: the last one of the scene
  int columns = 0;          // of a contact sheet; 0: as many as pictures, at most 4
  int every = 1;            // of a video: each so manieth frame
  std::string size = "1280x720";
  std::vector<double> camera;  // azimuth, elevation, zoom
  bool transparent = false, springs = false;
  int threads = 0;
  Overrides overrides;
};

/// An animation that was written by `weft run`, or one that is simulated now.
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
      throw InputError("--set has no meaning for " + file_.string() + ", which is done");
    if (request.springs)
      throw InputError("--springs needs a scene: " + file_.string() + " does not tell its springs");
  }

  /// At least up to the last frame that is wanted.
  Animation get() const {
    if (!scene_) return read_glb(file_);
    RunOptions options{.threads = request_.threads > 0 ? request_.threads : num_processors()};
    if (!request_.frames.empty())
      options.frames = *std::max_element(request_.frames.begin(), request_.frames.end());
    if (options.frames == 0) options.frames = 1;
    ProgressBar bar(scene_->name);
    catch_interrupts();
    RunResult result = run_scene(*scene_, options, [&](const Progress& progress) {
      bar.update(progress);
      return !interrupted();
    });
    bar.clear();
    for (const std::string& warning : result.report.warnings) fmt::print(stderr, "warning: {}\n", warning);
    if (result.report.outcome == RunOutcome::failed)
      fmt::print(stderr, "the simulation failed at {}\n", result.report.failure);
    return std::move(result.animation);
  }

  std::vector<SpringsToDraw> springs() const {
    std::vector<SpringsToDraw> springs;
    if (!request_.springs) return springs;
    const SceneWorld built = build_world(*scene_, make_jobs(1));
    for (int c = 0; c < built.world.num_cloths(); ++c)
      springs.push_back({c, built.world.model({c}).topology});
    return springs;
  }

 private:
  const RenderRequest& request_;
  std::optional<SceneDesc> scene_;
  fs::path file_;
};

Camera wanted_view(const RenderRequest& request) {
  Camera camera;
  if (request.camera.size() > 0) camera.azimuth_deg = request.camera[0];
  if (request.camera.size() > 1) camera.elevation_deg = request.camera[1];
  return camera;
}

class Painter {
 public:
  Painter(const RenderRequest& request, const Animation& animation, std::vector<SpringsToDraw> springs,
          std::unique_ptr<Device> device)
      : request_(request),
        animation_(animation),
        size_(parse_size(request.size)),
        renderer_(std::move(device)),
        pictures_(animation,
                  {.transparent = request.transparent, .ground = {}, .springs = std::move(springs)}),
        last_(num_frames(animation) - 1) {
    if (last_ < 0) throw InputError("there is no cloth to draw");
    camera_ = frame_scene(animation, 0, last_, wanted_view(request), size_.aspect());
    if (request.camera.size() > 2) camera_.zoom(1 / request.camera[2]);
  }

  void write() {
    if (is_video(request_.out))
      write_video();
    else
      write_pictures();
  }

 private:
  Image draw(int frame) { return renderer_.draw(pictures_.at(frame, camera_), size_); }

  void write_pictures() {
    std::vector<int> frames = request_.frames;
    if (frames.empty()) frames = {last_};
    std::vector<Image> images;
    for (const int frame : frames) {
      if (frame > last_)
        throw InputError("there is no frame " + std::to_string(frame) + "; the last one is " +
                         std::to_string(last_));
      images.push_back(draw(frame));
    }
    const int columns =
        request_.columns > 0 ? request_.columns : std::min<int>(4, static_cast<int>(images.size()));
    write_png(request_.out, images.size() == 1 ? images[0] : make_contact_sheet(images, columns, kSheetGap));
  }

  void write_video() {
    VideoWriter video(request_.out, size_.width, size_.height, animation_.frames_per_second / request_.every);
    for (int frame = 0; frame <= last_ && !interrupted(); frame += request_.every) video.add(draw(frame));
    video.finish();
  }

  const RenderRequest& request_;
  const Animation& animation_;
  PictureSize size_;
  Renderer renderer_;
  ScenePictures pictures_;
  int last_;
  Camera camera_;
};

void render(const RenderRequest& request) {
  parse_size(request.size);
  if (request.out.extension() != ".png" && !is_video(request.out))
    throw InputError("--out " + request.out.string() +
                     ": expected a name that ends in .png, .mp4, .webp or .gif");
  const Source source(request);
  auto device = make_offscreen_device();  // now: no reason to simulate where nothing can be drawn
  if (request.out.has_parent_path()) fs::create_directories(request.out.parent_path());
  require_writable(request.out);
  if (is_video(request.out)) require_ffmpeg(request.out);
  const Animation animation = source.get();
  Painter(request, animation, source.springs(), std::move(device)).write();
  fmt::print("written {}\n", request.out.string());
}

}  // namespace

void add_render_command(CLI::App& app, int& exit_code) {
  auto request = std::make_shared<RenderRequest>();
  CLI::App* command =
      app.add_subcommand("render", "Draw a scene: a picture, a contact sheet or a video; no display needed");
  command
      ->add_option("SCENE", request->scene, "A scene, or what weft run left: a folder or its animation.glb")
      ->required();
  command->add_option("--out", request->out, "A .png, .mp4, .webp or .gif file")
      ->type_name("FILE")
      ->capture_default_str();
  command
      ->add_option("--frame,--frames", request->frames,
                   "Frame to draw, 0 being the start (default: the last); several, as in 0,20,40, make a "
                   "contact sheet; of "
                   "a video the last one")
      ->delimiter(',')
      ->check(CLI::Range(0, 1000000))
      ->type_name("N");
  command->add_option("--columns", request->columns, "Pictures side by side in a contact sheet")
      ->check(CLI::Range(1, 100))
      ->type_name("N");
  command->add_option("--every", request->every, "Of a video: every so many frames")
      ->check(CLI::Range(1, 1000))
      ->type_name("N")
      ->capture_default_str();
  command->add_option("--size", request->size, "Of each picture, in pixels")
      ->type_name("WxH")
      ->capture_default_str();
  command
      ->add_option("--camera", request->camera,
                   "Azimuth, elevation (degrees) and zoom, as in 30,20,1.5; the camera frames the scene")
      ->delimiter(',')
      ->expected(1, 3)
      ->type_name("A,E,Z");
  command->add_flag("--transparent", request->transparent, "Neither sky nor ground");
  command->add_flag("--springs", request->springs, "Draw particles and springs instead of cloth");
  command->add_option("--threads", request->threads, "Threads of the simulation (default: all processors)")
      ->check(CLI::Range(1, 1024))
      ->type_name("T");
  command->add_option("--set", request->overrides, "Change a value, as in --set solver.integrator=desbrun")
      ->type_name("KEY=VALUE")
      ->take_all()
      ->allow_extra_args(false);
  command->callback([request, &exit_code] {
    render(*request);
    exit_code = kDone;
  });
}

}  // namespace weft::app
