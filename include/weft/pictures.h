#pragma once
/// Pictures of worlds and of recorded runs, without a window: colours, depths and ids per pixel; videos.
/// Link weft::pictures.
///
///     weft::OffscreenRenderer renderer;
///     const weft::Camera camera = weft::frame_camera(world, {.position = {1, 1, 2}});
///     weft::write_picture("cloth.png", renderer.render(world, camera));
///
/// Depths and ids need no graphics. Colours need EGL and OpenGL 3.3, in software too (Mesa); without them
/// GraphicsError is thrown. Planes with normal +y are endless ground; others are drawn as squares of 4 m.

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "weft/error.h"
#include "weft/export.h"
#include "weft/vec.h"

namespace weft {

class World;

/// A perspective (pinhole) camera; +y is up in the picture. In a view straight up or down, the upper border
/// is towards +z or −z.
///
/// With a viewing direction z, x to the right, y down, and f = height / (2 tan(fov_deg / 2)) [pixels], a
/// point is seen at column width/2 + f x/z and row height/2 + f y/z. Pixel centres are at halves.
struct Camera {
  Vec3 position = {1, 1, 2};  // of the eye [m]
  Vec3 target = {};           // in the picture's middle; differs from position [m]
  double fov_deg = 32;        // vertical field of view, in (0, 180)
  int width = 640;            // 1 to 16384 [pixels]
  int height = 480;           // likewise
};

struct RenderOptions {
  bool color = true;    // false: depths and ids only, without graphics; rgb is empty
  bool shadows = true;  // of the sun, and ambient occlusion
  int samples = 4;      // per pixel of rgb, for smooth edges, 1 to 16; 1: none
  std::vector<std::array<double, 3>> cloth_colors = {};  // of the first cloths, linear red, green, blue in
                                                         // [0, 1]; others keep theirs, by default red
  std::optional<double> ground = {};  // height of a ground drawn in rgb only, where no plane is [m]
  std::optional<int> smooth = {};  // Loop subdivisions of cloth in rgb, 0 to 2, with rounded hems; empty: its
                                   // triangles, which depth and ids always show
};

/// A picture as arrays, in rows from the top. Depths and ids belong to pixel centres, rgb to whole pixels.
struct Rendering {
  int width = 0, height = 0;           // [pixels]
  std::vector<std::uint8_t> rgb = {};  // (height x width x 3) sRGB, or empty
  std::vector<float> depth = {};       // (height x width) distance along the viewing direction; infinity
                                       // where nothing is [m]
  std::vector<std::int32_t> ids = {};  // (height x width) n: cloth(n); num_cloths() + n: collider(n);
                                       // -1: nothing
};

/// A recorded run, whose frames stay on disk until they are drawn. Copies share it.
class WEFT_API Recording {
 public:
  /// `path`: the folder of a `weft run`, finished or not, or its animation.glb. Throws InputError if it cannot
  /// be read, is damaged, was not written by Weft, or has no cloth.
  explicit Recording(const std::string& path);
  ~Recording();
  Recording(const Recording&);
  Recording& operator=(const Recording&);

  int num_frames() const;  // with the start, frame 0; of a run that goes on it grows
  int num_cloths() const;
  double frames_per_second() const;

 private:
  friend struct RecordingAccess;  // library internals
  struct Impl;
  std::shared_ptr<Impl> impl_;
};

/// The camera with the direction, field of view and size of `like` that frames all cloths and finite
/// colliders, in all frames of a recording. Without any it is `like` itself. Throws InputError for an invalid
/// camera.
WEFT_API Camera frame_camera(const World& world, const Camera& like = {});
WEFT_API Camera frame_camera(const Recording& recording, const Camera& like = {});

/// Draws any number of pictures. OpenGL starts with the first one in colour. One object belongs to one
/// thread.
class WEFT_API OffscreenRenderer {
 public:
  OffscreenRenderer();
  ~OffscreenRenderer();
  OffscreenRenderer(OffscreenRenderer&&) noexcept;
  OffscreenRenderer& operator=(OffscreenRenderer&&) noexcept;

  /// The world as it is, or frame 0 to num_frames() − 1 of a recording. Throws InputError for an invalid
  /// camera, invalid options, a nonexistent frame and a file that cannot be read; GraphicsError for colours
  /// without EGL or OpenGL.
  Rendering render(const World& world, const Camera& camera, const RenderOptions& options = {});
  Rendering render(const Recording& recording, int frame, const Camera& camera,
                   const RenderOptions& options = {});

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// Writes rgb as a .png or .jpg file. Throws InputError for another ending, a picture without rgb, and a file
/// that cannot be written.
WEFT_API void write_picture(const std::string& file, const Rendering& picture);

/// Writes every `every`-th frame (>= 1) as a video that plays in the recording's time: .mp4, .webp or .gif.
/// Needs the program ffmpeg. Throws as OffscreenRenderer::render does, and InputError without ffmpeg and for a
/// file that cannot be written.
WEFT_API void write_video(const std::string& file, const Recording& recording, const Camera& camera,
                          const RenderOptions& options = {}, int every = 1);

}  // namespace weft
