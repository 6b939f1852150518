#pragma once
/// Reader for animations: the .glb files that write_glb writes.

#include <filesystem>
#include <memory>
#include <span>
#include <string>

#include "weft/io/animation.h"

namespace weft::engine {

/// The animation in a file: cloths by their particles, bodies with their poses and exact shapes. Frames stay in
/// the file until they are read.
///
/// Numbers keep their precision: positions and moving poses are floats, shapes and resting poses doubles. A
/// cloth's later frames are stored as differences from the first, so that their last bits may be lost. A
/// coordinate that moved by d has an error of at most half the last place of d (3e-8 m for a metre).
///
/// All functions throw InputError, naming the file, if it cannot be read, is damaged, or was not written by
/// Weft.
class GlbFrames final : public FrameSource {
 public:
  explicit GlbFrames(const std::filesystem::path& file);

  /// From the file's bytes, which must outlive this; `name` is the file name in messages.
  GlbFrames(std::span<const unsigned char> bytes, std::string name);
  ~GlbFrames() override;

  const Animation& meshes() const override;
  int num_frames() override;
  AnimationFrame read(int frame) override;

 private:
  class Reader;
  std::string name_;
  std::unique_ptr<Reader> reader_;
};

/// The whole animation.
Animation read_glb(const std::filesystem::path& file);

/// The same from the file's bytes; `name` is the file name in messages. Never reads another file.
Animation parse_glb(std::span<const unsigned char> bytes, const std::string& name);

}  // namespace weft::engine
