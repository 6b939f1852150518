#pragma once
/// A device that draws nothing, and checks everything: for tests on machines without OpenGL.

#include <string>
#include <vector>

#include "weft/render/device.h"

namespace weft::engine {

/// Throws std::logic_error, saying what is wrong, for calls that OpenGL would refuse or silently get wrong:
/// uniforms that the program does not have, lacks, or has as another type, numbers that are not finite,
/// indices out of range, a texture that is being drawn to, targets of unequal sizes.
class MockDevice : public Device {
 public:
  /// What was asked for, in order: "pass shadow", "draw depth", "resolve colour picture", "read picture".
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
  std::vector<int> geometries_;  // triangles of each
  int pass_ = -1;                // target that is drawn to
  int num_drawn_ = 0;
  std::vector<std::string> log_;
};

}  // namespace weft::engine
