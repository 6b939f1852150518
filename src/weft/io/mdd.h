#pragma once
/// MDD point caches of LightWave: positions of the same points at every frame, as in Blender.
///
///     header       int32 frames, int32 points: 8 bytes, big-endian like every number of the file
///     times        float32 of every frame [s]
///     each frame   float32 x, y, z of every point

#include <filesystem>
#include <span>
#include <vector>

#include "weft/core/staged_file.h"
#include "weft/io/point_cache_reader.h"

namespace weft::engine {

/// Writes a file frame by frame. Readers refuse the partial file, because its header counts all frames.
class MddWriter {
 public:
  /// Writes the header and the times of all frames [s]. `num_points` is 1 or more; the file must outlive
  /// this. Every function throws InputError with the file's name and the system's reason if the file cannot be
  /// written.
  MddWriter(StagedFile& file, int num_points, std::span<const float> times);

  /// Appends a frame: (num_points) x, y, z; world coordinates, y up [m]. Throws InputError for a frame of
  /// another size, and for more frames than times.
  void add_frame(std::span<const float> positions);

  /// StagedFile::finish(); replace() is left to the caller. Throws InputError for fewer frames than times.
  void finish();

 private:
  StagedFile& file_;
  std::size_t num_floats_;  // per frame
  std::size_t num_frames_;
  std::size_t num_written_ = 0;  // frames
};

/// An MDD file, read frame by frame. Bytes behind its last frame are ignored.
class MddReader : public PointCacheReader {
 public:
  explicit MddReader(const std::filesystem::path& file);

  const std::vector<float>& times() const { return times_; }  // (num_frames), finite, in any order [s]

 private:
  std::vector<float> times_;
};

/// Contents of an MDD file.
struct MddCache {
  int num_points = 0;                      // >= 1
  std::vector<float> times;                // (num_frames), finite, in any order [s]
  std::vector<std::vector<float>> frames;  // (num_points) x, y, z each
};

/// Reads a file; bytes behind its last frame are ignored. Throws InputError ("FILE: byte 4: …") for a damaged
/// one. Needs no more memory than the file's size.
MddCache read_mdd(const std::filesystem::path& file);

}  // namespace weft::engine
