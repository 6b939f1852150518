#include "weft/pictures.h"

#include <algorithm>
#include <cmath>
#include <mutex>
#include <numeric>

#include "weft/face/world_impl.h"
#include "weft/pictures/painter.h"
#include "weft/pictures/public_camera.h"
#include "weft/render/depth_picture.h"
#include "weft/render/video.h"
#include "weft/run/film.h"
#include "weft/run/playback.h"

namespace weft {

using engine::Animation;

struct Recording::Impl final : engine::FrameSource {
  explicit Impl(const std::string& path) : file(engine::open_frames(path)) {}

  const Animation& meshes() const override { return file->meshes(); }
  int num_frames() override {
    const std::lock_guard lock(mutex);
    return file->num_frames();
  }
  engine::AnimationFrame read(int frame) override {
    const std::lock_guard lock(mutex);
    return file->read(frame);
  }

  std::mutex mutex;  // of file's frames
  std::unique_ptr<engine::FrameSource> file;
};

struct RecordingAccess {
  static engine::FrameSource& frames(const Recording& recording) { return *recording.impl_; }
};

namespace {

constexpr int kMaxSamples = 16, kMaxSmooth = 2;

/// The world's present state as the only frame.
class Still final : public engine::FrameSource {
 public:
  explicit Still(const World& world)
      : world_(WorldAccess::engine(world)), meshes_(engine::make_animation(world_)) {}

  const Animation& meshes() const override { return meshes_; }
  int num_frames() override { return 1; }
  engine::AnimationFrame read(int) override { return engine::capture_frame(world_); }

 private:
  const engine::World& world_;
  Animation meshes_;
};

void require_valid(const RenderOptions& options, const Animation& animation) {
  if (options.samples < 1 || options.samples > kMaxSamples)
    throw InputError("samples of a picture: expected 1 to " + std::to_string(kMaxSamples) + ", not " +
                     std::to_string(options.samples));
  if (options.cloth_colors.size() > animation.cloths.size())
    throw InputError("there are " + std::to_string(options.cloth_colors.size()) + " colours for " +
                     std::to_string(animation.cloths.size()) + " cloths");
  for (const engine::Color& color : options.cloth_colors) {
    if (!std::all_of(color.begin(), color.end(), [](double c) { return c >= 0 && c <= 1; }))
      throw InputError("a cloth's colour: expected red, green and blue from 0 to 1");
  }
  if (options.smooth && (*options.smooth < 0 || *options.smooth > kMaxSmooth))
    throw InputError("subdivisions of a picture: expected 0 to " + std::to_string(kMaxSmooth) + ", not " +
                     std::to_string(*options.smooth));
  if (options.ground && !std::isfinite(*options.ground))
    throw InputError("the height of the ground is not finite");
}

engine::SceneStyle style_of(const RenderOptions& options) {
  return {.ground = options.ground, .cloth_colors = options.cloth_colors, .smooth = options.smooth};
}

engine::RenderSettings settings_of(const RenderOptions& options) {
  const engine::RenderSettings standard;
  return {.samples = options.samples,
          .shadow_size = options.shadows ? standard.shadow_size : 0,
          .occlusion = options.shadows};
}

Camera frame_all(engine::FrameSource& source, const Camera& like) {
  std::vector<int> frames(source.num_frames());
  std::iota(frames.begin(), frames.end(), 0);
  const engine::Camera camera = engine::to_engine(like);
  return engine::from_engine(engine::frame_scene(source, frames, camera, engine::size_of(like).aspect()),
                             like);
}

void add_depths(const engine::Picture& picture, const std::vector<int>& shown, Rendering& rendering) {
  const bool is_ground_a_body = shown.back() >= 0;
  engine::DepthPicture depths =
      engine::draw_depths(picture.meshes, is_ground_a_body ? picture.ground : std::nullopt, picture.camera,
                          {rendering.width, rendering.height});
  for (std::int32_t& index : depths.index) index = index < 0 ? -1 : shown[index];
  rendering.depth = std::move(depths.depth);
  rendering.ids = std::move(depths.index);
}

}  // namespace

Recording::Recording(const std::string& path) : impl_(std::make_shared<Impl>(path)) {}
Recording::~Recording() = default;
Recording::Recording(const Recording&) = default;
Recording& Recording::operator=(const Recording&) = default;

int Recording::num_frames() const { return impl_->num_frames(); }
int Recording::num_cloths() const { return static_cast<int>(impl_->meshes().cloths.size()); }
double Recording::frames_per_second() const { return impl_->meshes().frames_per_second; }

Camera frame_camera(const World& world, const Camera& like) {
  Still still(world);
  return frame_all(still, like);
}

Camera frame_camera(const Recording& recording, const Camera& like) {
  return frame_all(RecordingAccess::frames(recording), like);
}

struct OffscreenRenderer::Impl {
  std::optional<engine::Renderer> renderer;  // from the first picture in colour on

  Rendering render(engine::FrameSource& source, int number, const Camera& camera,
                   const RenderOptions& options) {
    const Animation& meshes = source.meshes();
    require_valid(options, meshes);
    engine::SceneStyle style = style_of(options);
    const engine::Camera view = engine::to_engine(camera);
    const engine::AnimationFrame frame = source.read(number);
    Rendering rendering{.width = camera.width, .height = camera.height};
    if (options.color) {
      const engine::Picture picture = engine::ScenePictures(meshes, frame, style).at(frame, view);
      add_colors(picture, settings_of(options), rendering);
    }
    style.smooth = {};
    const engine::ScenePictures triangles(meshes, frame, style);
    add_depths(triangles.at(frame, view), triangles.shown(frame), rendering);
    return rendering;
  }

  void add_colors(const engine::Picture& picture, const engine::RenderSettings& settings,
                  Rendering& rendering) {
    if (!renderer) renderer.emplace(engine::make_offscreen_device());
    renderer->set_settings(settings);
    const engine::Image image = renderer->draw(picture, {rendering.width, rendering.height});
    rendering.rgb.reserve(image.rgba.size() / 4 * 3);
    for (std::size_t i = 0; i < image.rgba.size(); i += 4)
      rendering.rgb.insert(rendering.rgb.end(), &image.rgba[i], &image.rgba[i] + 3);
  }
};

OffscreenRenderer::OffscreenRenderer() : impl_(std::make_unique<Impl>()) {}
OffscreenRenderer::~OffscreenRenderer() = default;
OffscreenRenderer::OffscreenRenderer(OffscreenRenderer&&) noexcept = default;
OffscreenRenderer& OffscreenRenderer::operator=(OffscreenRenderer&&) noexcept = default;

Rendering OffscreenRenderer::render(const World& world, const Camera& camera, const RenderOptions& options) {
  Still still(world);
  return impl_->render(still, 0, camera, options);
}

Rendering OffscreenRenderer::render(const Recording& recording, int frame, const Camera& camera,
                                    const RenderOptions& options) {
  if (frame < 0 || frame >= recording.num_frames())
    throw InputError("there is no frame " + std::to_string(frame) + "; the last one is " +
                     std::to_string(recording.num_frames() - 1));
  return impl_->render(RecordingAccess::frames(recording), frame, camera, options);
}

void write_picture(const std::string& file, const Rendering& picture) {
  if (!engine::is_picture(file)) throw InputError(file + ": expected a file name ending in .png or .jpg");
  engine::Image image(picture.width, picture.height);
  if (picture.rgb.empty() || picture.rgb.size() != image.rgba.size() / 4 * 3)
    throw InputError(file + ": the picture has no rgb of its width and height");
  for (std::size_t i = 0; 4 * i < image.rgba.size(); ++i) {
    std::copy_n(&picture.rgb[3 * i], 3, &image.rgba[4 * i]);
    image.rgba[4 * i + 3] = 255;
  }
  engine::write_image(file, image);
}

void write_video(const std::string& file, const Recording& recording, const Camera& camera,
                 const RenderOptions& options, int every) {
  engine::FrameSource& frames = RecordingAccess::frames(recording);
  require_valid(options, frames.meshes());
  if (!options.color) throw InputError(file + ": a video needs colours");
  if (every < 1)
    throw InputError(file + ": expected every 1st or a later frame, not " + std::to_string(every));
  if (!engine::is_video(file))
    throw InputError(file + ": expected a file name ending in .mp4, .webp or .gif");
  engine::require_ffmpeg(file);
  const engine::PaintSettings settings{.size = engine::size_of(camera),
                                       .camera = engine::to_engine(camera),
                                       .style = style_of(options),
                                       .finds_ground = false,
                                       .render = settings_of(options)};
  engine::Painter(frames, settings, engine::make_offscreen_device()).write_video(file, every);
}

}  // namespace weft
