#include "weft/io/point_cache_reader.h"

#include <cmath>
#include <system_error>
#include <utility>

#include "weft/error.h"
#include "weft/io/byte_order.h"
#include "weft/io/input_file.h"

namespace weft::engine {

namespace fs = std::filesystem;

PointCacheReader::PointCacheReader(const fs::path& file, std::string_view kind, std::endian order)
    : file_(file), in_(open_input(file, kind)), order_(order) {}

void PointCacheReader::fail(std::size_t byte, const std::string& message) const {
  throw InputError(file_.string() + ": byte " + std::to_string(byte) + ": " + message);
}

void PointCacheReader::read_header(void* to, std::size_t size) {
  in_.read(static_cast<char*>(to), static_cast<std::streamsize>(size));
  if (!in_)
    fail(static_cast<std::size_t>(in_.gcount()),
         "the file ends, expected a header of " + std::to_string(size) + " bytes");
}

void PointCacheReader::set_counts(const Count& points, const Count& frames, std::size_t header,
                                  std::size_t table) {
  if (points.value < 1) fail(points.byte, std::to_string(points.value) + " points, expected 1 or more");
  if (frames.value < 0) fail(frames.byte, std::to_string(frames.value) + " frames, expected 0 or more");
  num_points_ = points.value;
  num_frames_ = frames.value;
  first_frame_ = header + table * static_cast<std::size_t>(num_frames_);

  std::error_code error;
  const std::uintmax_t size = fs::file_size(file_, error);  // of a file that may grow meanwhile
  if (error) throw InputError(file_.string() + ": cannot be read: " + error.message());
  const std::size_t bytes_per_frame = table + 3 * sizeof(float) * static_cast<std::size_t>(num_points_);
  const std::uintmax_t num_whole = (size - header) / bytes_per_frame;
  if (std::cmp_less(num_whole, num_frames_))
    fail(frames.byte, std::to_string(num_frames_) + " frames of " + std::to_string(num_points_) +
                          " points, but the file holds " + std::to_string(num_whole));
}

std::vector<float> PointCacheReader::read_floats(std::size_t byte, std::size_t count,
                                                 const std::string& noun) {
  std::vector<float> numbers(count);
  in_.clear();  // of an earlier failure
  in_.seekg(static_cast<std::streamoff>(byte));
  in_.read(reinterpret_cast<char*>(numbers.data()), static_cast<std::streamsize>(sizeof(float) * count));
  if (!in_) fail(byte, "cannot be read");
  for (std::size_t k = 0; k < count; ++k) {
    numbers[k] = number_from_bytes<float>(reinterpret_cast<const char*>(&numbers[k]), order_);
    if (!std::isfinite(numbers[k])) fail(byte + sizeof(float) * k, "the " + noun + " is not a finite number");
  }
  return numbers;
}

std::vector<float> PointCacheReader::frame(int k) {
  const std::size_t num_floats = 3 * static_cast<std::size_t>(num_points_);
  return read_floats(first_frame_ + sizeof(float) * num_floats * static_cast<std::size_t>(k), num_floats,
                     "position");
}

std::vector<std::vector<float>> PointCacheReader::frames() {
  std::vector<std::vector<float>> frames;
  for (int k = 0; k < num_frames_; ++k) frames.push_back(frame(k));
  return frames;
}

}  // namespace weft::engine
