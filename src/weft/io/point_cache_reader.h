#pragma once
/// Point caches: positions of the same points at every frame, read frame by frame.

#include <bit>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <string>
#include <string_view>
#include <vector>

namespace weft::engine {

/// An open point cache; its frames stay in the file. Every error is an InputError ("FILE: byte N: …").
class PointCacheReader {
 public:
  virtual ~PointCacheReader() = default;
  PointCacheReader(const PointCacheReader&) = delete;
  PointCacheReader& operator=(const PointCacheReader&) = delete;

  int num_points() const { return num_points_; }  // >= 1
  int num_frames() const { return num_frames_; }  // at the time of opening

  /// Frame k in [0, num_frames()): (num_points) x, y, z. Throws for positions that are not finite.
  std::vector<float> frame(int k);

  /// All frames. Throws likewise.
  std::vector<std::vector<float>> frames();

 protected:
  /// A number of the header and its position in the file.
  struct Count {
    std::int32_t value;
    std::size_t byte;
  };

  /// Opens the file. `kind` is the expected kind of file in messages, `order` the byte order of its numbers.
  PointCacheReader(const std::filesystem::path& file, std::string_view kind, std::endian order);

  /// Reads the first bytes of the file.
  void read_header(void* to, std::size_t size);

  /// Sets the counts, after a check that the file is large enough. Its parts are the header, `table` bytes
  /// for each frame, and the frames without gaps. Further bytes are ignored.
  void set_counts(const Count& points, const Count& frames, std::size_t header, std::size_t table);

  /// Reads numbers that begin at this byte. Throws for one that is not finite; `noun` is its name.
  std::vector<float> read_floats(std::size_t byte, std::size_t count, const std::string& noun);

  [[noreturn]] void fail(std::size_t byte, const std::string& message) const;

 private:
  std::filesystem::path file_;
  std::ifstream in_;
  std::endian order_;
  int num_points_ = 0, num_frames_ = 0;
  std::size_t first_frame_ = 0;  // [bytes]
};

}  // namespace weft::engine
