#pragma once
/// Renderer: draws pictures. The stages, and their inputs:
///
///     shadow     depth seen from the sun
///     surfaces   normals, colours and materials of what each pixel shows, with its depth
///     sunlight   visible share of the sun at each pixel
///     occlusion  visible share of the sky at each point, from depths and normals; then smoothed
///     lit        each pixel's surface in the light, once
///     colour     the lit surfaces, lines, dots, sky; several samples per pixel
///     resolve    one sample per pixel

#include <memory>

#include "weft/render/device.h"
#include "weft/render/picture.h"

namespace weft::engine {

struct RenderSettings {
  int samples = 4;         // per pixel, for antialiasing; 1: none
  int shadow_size = 2048;  // of the shadow map; 0: no shadows [pixels]
  bool occlusion = true;   // ambient occlusion
};

class Renderer {
 public:
  explicit Renderer(std::unique_ptr<Device> device, const RenderSettings& settings = {});
  ~Renderer();

  /// Draws the picture and returns the image.
  Image draw(const Picture& picture, PictureSize size);

  /// Draws the picture, and shows it in a part of the device's window.
  void show(const Picture& picture, PictureSize size, const WindowPart& part);

  void set_settings(const RenderSettings& settings) { settings_ = settings; }

 private:
  struct Stage;

  TargetId compose(const Picture& picture, PictureSize size);

  std::unique_ptr<Device> device_;
  RenderSettings settings_;
};

}  // namespace weft::engine
