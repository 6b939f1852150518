#pragma once
/// A device that checks all calls and draws nothing: for tests on machines without OpenGL.

#include <string>
#include <vector>

#include "weft/render/device.h"

namespace weft::engine {

/// Throws std::logic_error, with the reason, for calls that OpenGL would reject or silently mishandle:
/// uniforms that are unknown to the program, missing, or of another type, non-finite numbers, indices out of
/// range, a texture that is also the render target, targets of unequal sizes.
class MockDevice : public Device {
 public:
  /// Calls in order: "pass shadow", "draw depth", "resolve colour picture", "read picture".
  const std::vector<std::string>& log() const { return log_; }

  /// Triangles, lines and dots drawn since the last pass began [1].
  int num_drawn() const { return num_drawn_; }

  TargetId target(std::string_view name, const TargetDesc& desc) override;
  GeometryId upload(std::span<const float> vertices, std::span<const Triangle> triangles) override;
  void forget_geometry() override { geometries_.clear(); }
  void begin_pass(TargetId target) override;
  void draw(const DrawCall& call) override;
  void resolve(TargetId from, TargetId to) override;
  Image read(TargetId target) override;  // all zeros
  void show(TargetId target, const WindowPart& part) override;

 private:
  struct Target {
    std::string name;
    TargetDesc desc;
  };

  const Target& at(TargetId id) const;
  void check_uniforms(const DrawCall& call) const;

  std::vector<Target> targets_;
  std::vector<int> geometries_;  // number of triangles of each
  int pass_ = -1;                // current render target
  int num_drawn_ = 0;
  std::vector<std::string> log_;
};

}  // namespace weft::engine
