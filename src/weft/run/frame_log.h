#pragma once
/// Frames of an animation on disk, one after the other, all of the same size.

#include <cstdint>
#include <filesystem>
#include <fstream>

#include "weft/core/spool_file.h"
#include "weft/core/staged_file.h"
#include "weft/io/animation.h"

namespace weft::engine {

/// The frames of a log, read in any order. It may grow meanwhile.
class FrameLogReader {
 public:
  /// `like`: a frame of the animation.
  FrameLogReader(std::filesystem::path log, AnimationFrame like);

  int num_frames();                       // complete ones, now
  const AnimationFrame& read(int frame);  // valid until the next call; throws InputError

 private:
  std::filesystem::path log_;
  AnimationFrame frame_;
  std::uintmax_t size_;  // of a frame [bytes]
  std::ifstream in_;
};

/// Frames until a file is made of them. Every error is an InputError with the name of the file that
/// the frames are for, and the system's reason.
class FrameLog {
 public:
  /// `like`: a frame of the animation. Keeps the first `num_frames` of the log, which must have them; writes to
  /// `log`, for `file`.
  FrameLog(const std::filesystem::path& file, const std::filesystem::path& log, AnimationFrame like,
           int num_frames = 0);

  void append(const AnimationFrame& frame);
  void sync() { file_.sync(); }

  /// Calls `receive(frame)` for every frame, in order.
  template <class Receive>
  void read(const Receive& receive) {
    FrameLogReader reader(log_, like_);
    for (int k = 0; k < num_frames_; ++k) receive(reader.read(k));
  }

 private:
  std::filesystem::path log_;
  AnimationFrame like_;
  StagedFile file_;
  int num_frames_;
};

/// Frames in a temporary file, which is gone with this. Every error is an InputError.
class FrameSpool {
 public:
  /// For the file `target`; beside it if that folder can be written.
  explicit FrameSpool(const std::filesystem::path& target) : file_(target) {}

  void append(AnimationFrame frame);
  int num_frames() const { return num_frames_; }
  AnimationFrame read(int frame);

 private:
  SpoolFile file_;
  AnimationFrame like_;
  int num_frames_ = 0;
};

}  // namespace weft::engine
