#include "weft/io/mdd.h"

#include <array>
#include <bit>
#include <cstdint>
#include <string>

#include "weft/error.h"
#include "weft/io/byte_order.h"

namespace weft::engine {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kFramesAt = 0, kPointsAt = 4, kHeader = 8;

template <class Number>
void write(std::span<const Number> numbers, StagedFile& file) {
  std::string bytes;
  for (const Number number : numbers) append_bytes(number, std::endian::big, bytes);
  file.out() << bytes;
  file.flush();
}

[[noreturn]] void fail(const StagedFile& file, const std::string& message) {
  throw InputError(file.file().string() + ": " + message);
}

}  // namespace

MddWriter::MddWriter(StagedFile& file, int num_points, std::span<const float> times)
    : file_(file), num_floats_(3 * static_cast<std::size_t>(num_points)), num_frames_(times.size()) {
  const std::array<std::int32_t, 2> header = {static_cast<std::int32_t>(num_frames_), num_points};
  write<std::int32_t>(header, file_);
  write(times, file_);
}

void MddWriter::add_frame(std::span<const float> positions) {
  if (positions.size() != num_floats_)
    fail(file_, "a frame of " + std::to_string(positions.size()) + " coordinates, expected " +
                    std::to_string(num_floats_));
  if (num_written_ == num_frames_)
    fail(file_, "one frame more than the " + std::to_string(num_frames_) + " in the header");
  write(positions, file_);
  ++num_written_;
}

void MddWriter::finish() {
  if (num_written_ != num_frames_)
    fail(file_, std::to_string(num_written_) + " frames, expected " + std::to_string(num_frames_) +
                    ", the number in the header");
  file_.finish();
}

MddReader::MddReader(const fs::path& file) : PointCacheReader(file, "an MDD point cache", std::endian::big) {
  std::array<char, kHeader> header;
  read_header(header.data(), header.size());
  const auto count = [&](std::size_t byte) {
    return Count{number_from_bytes<std::int32_t>(&header[byte], std::endian::big), byte};
  };
  set_counts(count(kPointsAt), count(kFramesAt), kHeader, sizeof(float));
  times_ = read_floats(kHeader, static_cast<std::size_t>(num_frames()), "time");
}

MddCache read_mdd(const fs::path& file) {
  MddReader reader(file);
  return {.num_points = reader.num_points(), .times = reader.times(), .frames = reader.frames()};
}

}  // namespace weft::engine
