#pragma once
/// The seam between what is drawn and what draws it: OpenGL, or a mock that checks every call.

#include <cstdint>
#include <memory>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "weft/render/camera.h"
#include "weft/render/image.h"
#include "weft/render/picture.h"

namespace weft::engine {

/// This machine cannot draw: what is missing, and what to do.
class GraphicsError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Programs of the graphics card; their sources are in shaders.h.
enum class Program { depth, occlusion, blur, sky, fabric, solid, ground, line, dot };

/// A picture in the device's memory that passes draw to and read from.
struct TargetDesc {
  enum class Format { depth, gray, color };

  Format format = Format::color;
  int width = 0, height = 0;  // > 0 [pixels]
  int samples = 1;            // per pixel; more than one cannot be read by programs

  bool operator==(const TargetDesc&) const = default;
};

struct TargetId {
  int index = -1;
};

struct GeometryId {
  int index = -1;
};

/// A target as a texture, read as it is or compared with a depth (for shadows).
struct Texture {
  TargetId target;
  bool compares = false;
};

using UniformValue = std::variant<int, float, Eigen::Vector2f, Eigen::Vector3f, Eigen::Matrix4f, Texture>;

struct Uniform {
  std::string_view name;
  UniformValue value;
};

/// A vertex as programs see it: position, normal, fabric coordinates.
constexpr int kFloatsPerVertex = 8;

/// Nothing but a triangle that covers the target.
struct WholeTarget {};

/// Four corners for each line (two ends) or dot (one place), three floats a place.
struct Instances {
  std::span<const float> places;
};

struct DrawCall {
  Program program = Program::depth;
  std::vector<Uniform> uniforms;  // all that the program has, in any order
  std::variant<WholeTarget, GeometryId, Instances> what;
};

/// From the window's lower left corner [pixels].
struct WindowPart {
  int x = 0, y = 0;
  PictureSize size;
};

class Device {
 public:
  virtual ~Device() = default;

  /// The same description asked for again with the same `name` gives the same target.
  virtual TargetId target(std::string_view name, const TargetDesc& desc) = 0;

  /// Vertices (n x kFloatsPerVertex) and triangles; valid until forget_geometry().
  virtual GeometryId upload(std::span<const float> vertices, std::span<const Triangle> triangles) = 0;
  virtual void forget_geometry() = 0;

  /// From now on draws to `target`, which is emptied first: farthest depth, transparent black.
  virtual void begin_pass(TargetId target) = 0;
  virtual void draw(const DrawCall& call) = 0;

  /// Averages the samples of `from` into `to`, of the same size.
  virtual void resolve(TargetId from, TargetId to) = 0;

  /// What is in a colour target of one sample.
  virtual Image read(TargetId target) = 0;

  /// Copies a colour target to a part of the window, larger or smaller, where there is a window.
  virtual void show(TargetId target, const WindowPart& part) = 0;
};

/// OpenGL 3.3 or later in the context that is current on this thread, and stays so. Throws GraphicsError.
std::unique_ptr<Device> make_gl_device();

/// OpenGL without a display, through EGL; its own context is made current on this thread. Throws
/// GraphicsError where there is no EGL or no OpenGL 3.3.
std::unique_ptr<Device> make_offscreen_device();

}  // namespace weft::engine
