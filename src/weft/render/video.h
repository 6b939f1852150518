#pragma once
/// Moving pictures, made by the program ffmpeg.

#include <filesystem>
#include <string>

#include "weft/render/image.h"

namespace weft::engine {

/// Whether the file's ending is one that VideoWriter knows: .mp4 (H.264), .webp (animated) or .gif.
bool is_video(const std::filesystem::path& file);

/// Throws InputError, with what to do, if there is no ffmpeg among the programs.
void require_ffmpeg(const std::filesystem::path& file);

/// Takes pictures of one size and hands them to ffmpeg, which signals that end programs do not end. The file
/// appears when finish() has returned; until then, and if anything fails, an earlier one stays.
class VideoWriter {
 public:
  /// Throws InputError if ffmpeg cannot be started, or the file's ending is not known.
  VideoWriter(const std::filesystem::path& file, int width, int height, double frames_per_second);
  ~VideoWriter();

  VideoWriter(const VideoWriter&) = delete;
  VideoWriter& operator=(const VideoWriter&) = delete;

  /// Throws InputError if ffmpeg has given up.
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
