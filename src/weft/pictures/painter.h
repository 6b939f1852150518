#pragma once
/// Animations as picture files, for `weft render` and `weft demo`.

#include <filesystem>
#include <functional>
#include <vector>

#include "weft/pictures/scene_picture.h"
#include "weft/render/renderer.h"

namespace weft::engine {

/// Checks that files of this kind are supported: .png, .jpg, or a video. Throws InputError, with the
/// supported kinds, otherwise.
void require_picture(const std::filesystem::path& file);

struct PaintSettings {
  PictureSize size;
  Camera view;                   // orientation only; the position follows from the scene
  double zoom = 1;               // > 1: closer [1]
  std::optional<Camera> camera;  // in place of view and zoom
  SceneStyle style;
  RenderSettings render;
};

/// Draws frames of an animation, which must outlive this. All frames of one file share a camera, which shows
/// everything in them.
class Painter {
 public:
  /// Throws GraphicsError without graphics, InputError for an animation without cloth.
  Painter(const Animation& animation, const PaintSettings& settings, std::unique_ptr<Device> device);

  /// One frame, or several as a contact sheet with so many columns (0: at most four). Throws InputError for
  /// nonexistent frames.
  void write_pictures(const std::filesystem::path& file, const std::vector<int>& frames, int columns);

  /// Every `every`-th frame, until the end or until `is_stopped` returns true.
  void write_video(const std::filesystem::path& file, int every,
                   const std::function<bool()>& is_stopped = {});

  int last_frame() const { return last_; }

 private:
  Camera frame(const std::vector<int>& frames) const;
  Image draw(int frame, const Camera& camera);

  const Animation& animation_;
  PaintSettings settings_;
  Renderer renderer_;
  ScenePictures pictures_;
  int last_;
};

}  // namespace weft::engine
