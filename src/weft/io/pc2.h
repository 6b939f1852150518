#pragma once
/// PC2 point caches: positions of the same points at every frame, as Blender's Mesh Cache and Maya read them.
///
///     header       "POINTCACHE2\0", int32 version (1), int32 points, float start frame, float sample rate,
///                  int32 samples: 32 bytes, little-endian
///     each sample  float32 x, y, z of every point

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "weft/core/staged_file.h"
#include "weft/io/point_cache_reader.h"

namespace weft::engine {

/// Writes a file frame by frame. The partial file is complete after every frame, because positions precede the
/// header's number of samples: a concurrent reader finds whole frames only.
class Pc2Writer {
 public:
  /// Writes the header. `num_points` is 1 or more; the file must outlive this. Every function throws
  /// InputError with the file's name and the system's reason if the file cannot be written.
  ///
  /// `num_frames`: continues a file of that many frames, which has their size_of().
  Pc2Writer(StagedFile& file, int num_points, int num_frames = 0);

  /// Length of a file of so many frames [bytes].
  static std::uintmax_t size_of(int num_points, int num_frames);

  /// Appends a frame: (num_points) x, y, z; world coordinates, y up [m].
  void add_frame(std::span<const float> positions);

  /// StagedFile::finish(); replace() is left to the caller.
  void finish() { file_.finish(); }

  int num_frames() const { return num_frames_; }

 private:
  void write_count();

  StagedFile& file_;
  std::size_t num_floats_;  // per frame
  std::int32_t num_frames_ = 0;
};

/// A PC2 file, read frame by frame. Bytes behind its last frame are ignored.
class Pc2Reader : public PointCacheReader {
 public:
  explicit Pc2Reader(const std::filesystem::path& file);

  float start_frame() const { return start_frame_; }  // time of the first frame [frames]
  float sample_rate() const { return sample_rate_; }  // frames between two of the file, > 0 [1]

 private:
  float start_frame_ = 0, sample_rate_ = 1;
};

/// Contents of a PC2 file.
struct PointCache {
  int num_points = 0;                      // >= 1
  float start_frame = 0;                   // time of the first sample [frames]
  float sample_rate = 1;                   // frames between two samples, > 0 [1]
  std::vector<std::vector<float>> frames;  // (num_points) x, y, z each
};

/// Reads a file; bytes behind its last frame are ignored. Throws InputError ("FILE: byte 16: …") for a damaged
/// one. Needs no more memory than the file's size.
PointCache read_pc2(const std::filesystem::path& file);

}  // namespace weft::engine
