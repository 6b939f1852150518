#include "weft/pictures.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "weft/face/world_impl.h"
#include "weft/io/glb_reader.h"
#include "weft/pictures/painter.h"
#include "weft/pictures/public_camera.h"
#include "weft/render/depth_picture.h"
#include "weft/render/video.h"
#include "weft/run/film.h"

namespace weft {

using engine::Animation;

struct Recording::Impl {
  Animation animation;
};

struct RecordingAccess {
  static const Animation& animation(const Recording& recording) { return recording.impl_->animation; }
};

namespace {

constexpr int kMaxSamples = 16, kMaxSmooth = 2;

/// The world's present state as the only frame.
Animation make_still(const World& world) {
  Animation animation = engine::make_animation(WorldAccess::engine(world));
  engine::append_frame(engine::capture_frame(WorldAccess::engine(world)), animation);
  return animation;
}

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
  return {.has_ground = options.ground.has_value(),
          .ground = options.ground,
          .cloth_colors = options.cloth_colors,
          .smooth = options.smooth};
}

engine::RenderSettings settings_of(const RenderOptions& options) {
  const engine::RenderSettings standard;
  return {.samples = options.samples,
          .shadow_size = options.shadows ? standard.shadow_size : 0,
          .occlusion = options.shadows};
}

Camera frame_all(const Animation& animation, const Camera& like) {
  std::vector<int> frames(engine::count_frames(animation));
  std::iota(frames.begin(), frames.end(), 0);
  const engine::Camera camera = engine::to_engine(like);
  return engine::from_engine(engine::frame_scene(animation, frames, camera, engine::size_of(like).aspect()),
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

Recording::Recording(const std::string& glb_file)
    : impl_(std::make_shared<const Impl>(Impl{engine::read_glb(glb_file)})) {}
Recording::~Recording() = default;
Recording::Recording(const Recording&) = default;
Recording& Recording::operator=(const Recording&) = default;

int Recording::num_frames() const { return static_cast<int>(engine::count_frames(impl_->animation)); }
int Recording::num_cloths() const { return static_cast<int>(impl_->animation.cloths.size()); }
double Recording::frames_per_second() const { return impl_->animation.frames_per_second; }

Camera frame_camera(const World& world, const Camera& like) { return frame_all(make_still(world), like); }

Camera frame_camera(const Recording& recording, const Camera& like) {
  return frame_all(RecordingAccess::animation(recording), like);
}

struct OffscreenRenderer::Impl {
  std::optional<engine::Renderer> renderer;  // from the first picture in colour on

  Rendering render(const Animation& animation, int frame, const Camera& camera,
                   const RenderOptions& options) {
    require_valid(options, animation);
    engine::SceneStyle style = style_of(options);
    const engine::Camera view = engine::to_engine(camera);
    Rendering rendering{.width = camera.width, .height = camera.height};
    if (options.color) {
      const engine::Picture picture = engine::ScenePictures(animation, style).at(frame, view);
      add_colors(picture, settings_of(options), rendering);
    }
    style.smooth = {};
    const engine::ScenePictures triangles(animation, style);
    add_depths(triangles.at(frame, view), triangles.shown(), rendering);
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
  return impl_->render(make_still(world), 0, camera, options);
}

Rendering OffscreenRenderer::render(const Recording& recording, int frame, const Camera& camera,
                                    const RenderOptions& options) {
  if (frame < 0 || frame >= recording.num_frames())
    throw InputError("there is no frame " + std::to_string(frame) + "; the last one is " +
                     std::to_string(recording.num_frames() - 1));
  return impl_->render(RecordingAccess::animation(recording), frame, camera, options);
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
  const Animation& animation = RecordingAccess::animation(recording);
  require_valid(options, animation);
  if (!options.color) throw InputError(file + ": a video needs colours");
  if (every < 1)
    throw InputError(file + ": expected every 1st or a later frame, not " + std::to_string(every));
  if (!engine::is_video(file))
    throw InputError(file + ": expected a file name ending in .mp4, .webp or .gif");
  engine::require_ffmpeg(file);
  const engine::PaintSettings settings{.size = engine::size_of(camera),
                                       .camera = engine::to_engine(camera),
                                       .style = style_of(options),
                                       .render = settings_of(options)};
  engine::Painter(animation, settings, engine::make_offscreen_device()).write_video(file, every);
}

}  // namespace weft
