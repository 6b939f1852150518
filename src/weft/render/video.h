#pragma once
/// Videos, encoded by the program ffmpeg.

#include <filesystem>
#include <string>

#include "weft/render/image.h"

namespace weft::engine {

/// Whether VideoWriter supports the file's extension: .mp4 (H.264), .webp (animated) or .gif.
bool is_video(const std::filesystem::path& file);

/// Throws InputError, with a remedy, if ffmpeg is not installed.
void require_ffmpeg(const std::filesystem::path& file);

/// Passes pictures of one size to ffmpeg, which ignores terminating signals. The file is replaced when
/// finish() returns; until then, and after any failure, an earlier one stays.
class VideoWriter {
 public:
  /// Throws InputError if ffmpeg cannot be started, or for an unsupported extension.
  VideoWriter(const std::filesystem::path& file, int width, int height, double frames_per_second);
  ~VideoWriter();

  VideoWriter(const VideoWriter&) = delete;
  VideoWriter& operator=(const VideoWriter&) = delete;

  /// Throws InputError if ffmpeg has failed.
  void add(const Image& image);

  /// Throws InputError if ffmpeg could not write the file.
  void finish();

 private:
  [[noreturn]] void fail(const std::string& reason);
  int wait();

  std::filesystem::path file_, part_;
  int to_ffmpeg_ = -1;  // its standard input
  int process_ = -1;
};

}  // namespace weft::engine
