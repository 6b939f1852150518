#pragma once
/// Graphics device interface: OpenGL, or a mock that checks every call.

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "weft/error.h"
#include "weft/render/camera.h"
#include "weft/render/image.h"
#include "weft/render/picture.h"

namespace weft::engine {

/// GPU programs; their sources are in shaders.h.
enum class Program { depth, fabric, solid, sun, occlusion, blur, light, surface, sky, line, dot };

/// A render target in the device's memory, to draw to and read from.
struct TargetDesc {
  /// depth: depths only. pair: two half floats. surface: four floats, and depths that programs can read.
  /// color: sRGB and alpha, with depths.
  enum class Format { depth, pair, surface, color };

  Format format = Format::color;
  int width = 0, height = 0;  // > 0 [pixels]
  int samples = 1;            // per pixel; programs can read only single-sample targets

  bool operator==(const TargetDesc&) const = default;
};

struct TargetId {
  int index = -1;
};

struct GeometryId {
  int index = -1;
};

/// A target as a texture: its colours or numbers, its depths, or comparisons with its depths (for shadows).
struct Texture {
  enum class Part { colors, depths, comparisons };

  TargetId target;
  Part part = Part::colors;
};

using UniformValue = std::variant<int, float, Eigen::Vector2f, Eigen::Vector3f, Eigen::Matrix4f, Texture>;

struct Uniform {
  std::string_view name;
  UniformValue value;
};

/// Vertex layout of the programs: position, normal, fabric coordinates, value.
constexpr int kFloatsPerVertex = 9;

/// Only a triangle that covers the target.
struct WholeTarget {};

/// Four corners for each line (two ends) or dot (one position), three floats per position.
struct Instances {
  std::span<const float> places;
};

struct DrawCall {
  Program program = Program::depth;
  std::vector<Uniform> uniforms;  // all uniforms of the program, in any order
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

  /// Repeated calls with the same description and `name` return the same target.
  virtual TargetId target(std::string_view name, const TargetDesc& desc) = 0;

  /// Vertices (n x kFloatsPerVertex) and triangles; valid until forget_geometry().
  virtual GeometryId upload(std::span<const float> vertices, std::span<const Triangle> triangles) = 0;
  virtual void forget_geometry() = 0;

  /// Starts drawing to `target`, cleared to the farthest depth and transparent black.
  virtual void begin_pass(TargetId target) = 0;
  virtual void draw(const DrawCall& call) = 0;

  /// Averages the samples of `from` into `to`, of the same size.
  virtual void resolve(TargetId from, TargetId to) = 0;

  /// Contents of a colour target of one sample.
  virtual Image read(TargetId target) = 0;

  /// Copies a colour target to a part of the window, scaled, if there is a window.
  virtual void show(TargetId target, const WindowPart& part) = 0;
};

/// OpenGL 3.3 or later in the context that is current on this thread, and must stay so. Throws GraphicsError.
std::unique_ptr<Device> make_gl_device();

/// Offscreen OpenGL through EGL; makes its own context current on this thread. Throws GraphicsError without
/// EGL or OpenGL 3.3.
std::unique_ptr<Device> make_offscreen_device();

}  // namespace weft::engine
