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
  Camera view;      // orientation only; the position follows from the scene
  double zoom = 1;  // > 1: closer [1]
  Framed framed = Framed::everything;
  std::optional<Vec3> look_at;   // in the picture's middle, in place of the framed middle [m]
  std::optional<Camera> camera;  // in place of all of these
  SceneStyle style;              // `smooth` empty: chosen by the number of triangles
  bool finds_ground = true;      // without style.ground: below all frames
  std::string legend;            // of values, with their unit, as in "speed [m/s]"
  RenderSettings render;
};

/// Throws InputError for frames after the last one.
void require_frames(const std::vector<int>& frames, int last);

/// Whether the file's name has places for a frame's number, as in "frame_####.png".
bool is_sequence(const std::filesystem::path& file);

/// The file of a frame: "frame_0012.png" for "frame_####.png".
std::filesystem::path numbered_picture(const std::filesystem::path& file, int frame);

/// Draws frames of an animation, which must outlive this, one after the other. All frames of one file share a
/// camera, which shows everything in them.
class Painter {
 public:
  /// Throws GraphicsError without graphics, InputError for an animation without cloth.
  Painter(FrameSource& frames, const PaintSettings& settings, std::unique_ptr<Device> device);

  /// One frame, or several as a contact sheet with so many columns (0: at most four). Throws InputError for
  /// nonexistent frames.
  void write_pictures(const std::filesystem::path& file, const std::vector<int>& frames, int columns);

  /// Every `every`-th frame, until the end or until `go_on`, called with the number of drawn and of all
  /// pictures, returns false.
  using GoOn = std::function<bool(int drawn, int all)>;
  void write_video(const std::filesystem::path& file, int every, const GoOn& go_on = {});

  /// The same as numbered files: '#' in the name stand for the digits of the frame's number.
  void write_sequence(const std::filesystem::path& file, int every, const GoOn& go_on = {});

  int last_frame() const { return last_; }

 private:
  Camera frame(const std::vector<int>& frames) const;
  Image draw(int frame, const Camera& camera);
  std::vector<int> every(int step) const;

  FrameSource& source_;
  PaintSettings settings_;
  Renderer renderer_;
  ScenePictures pictures_;
  int last_;
};

}  // namespace weft::engine
