#include "weft/io/pc2.h"

#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <limits>

#include "weft/error.h"

namespace weft::engine {
namespace {

namespace fs = std::filesystem;

constexpr std::array<char, 12> kMagic = {'P', 'O', 'I', 'N', 'T', 'C', 'A', 'C', 'H', 'E', '2', '\0'};
constexpr std::int32_t kVersion1 = 1;

struct Header {
  std::array<char, 12> magic = kMagic;
  std::int32_t version = kVersion1;
  std::int32_t num_points = 0;
  float start_frame = 0, sample_rate = 1;
  std::int32_t num_samples = 0;
};
static_assert(sizeof(Header) == 32);

constexpr std::streamoff kCountAt = offsetof(Header, num_samples);

}  // namespace

std::uintmax_t Pc2Writer::size_of(int num_points, int num_frames) {
  return sizeof(Header) + std::uintmax_t{3 * sizeof(float)} * num_points * num_frames;
}

Pc2Writer::Pc2Writer(StagedFile& file, int num_points, int num_frames)
    : file_(file), num_floats_(3 * static_cast<std::size_t>(num_points)), num_frames_(num_frames) {
  const Header header{.num_points = num_points, .num_samples = num_frames};
  file_.out().seekp(0);
  file_.out().write(reinterpret_cast<const char*>(&header), sizeof header);
  file_.flush();
}

void Pc2Writer::add_frame(std::span<const float> positions) {
  if (positions.size() != num_floats_)
    throw InputError(file_.file().string() + ": a frame of " + std::to_string(positions.size()) +
                     " coordinates, expected " + std::to_string(num_floats_));
  if (num_frames_ == std::numeric_limits<std::int32_t>::max())
    throw InputError(file_.file().string() + ": a PC2 point cache has at most 2147483647 frames");
  file_.out().seekp(0, std::ios::end);
  file_.out().write(reinterpret_cast<const char*>(positions.data()),
                    static_cast<std::streamsize>(positions.size_bytes()));
  file_.flush();
  ++num_frames_;
  write_count();
}

void Pc2Writer::write_count() {
  file_.out().seekp(kCountAt);
  file_.out().write(reinterpret_cast<const char*>(&num_frames_), sizeof num_frames_);
  file_.flush();
}

Pc2Reader::Pc2Reader(const fs::path& file)
    : PointCacheReader(file, "a PC2 point cache", std::endian::little) {
  Header header;
  read_header(&header, sizeof header);
  if (header.magic != kMagic) fail(0, "expected POINTCACHE2, the first word of a PC2 point cache");
  if (header.version != kVersion1)
    fail(offsetof(Header, version), "version " + std::to_string(header.version) + ", expected version 1");
  if (!std::isfinite(header.start_frame))
    fail(offsetof(Header, start_frame), "the start frame is not a finite number");
  if (!(header.sample_rate > 0) || !std::isfinite(header.sample_rate))
    fail(offsetof(Header, sample_rate), "the sample rate is not a number above 0");
  start_frame_ = header.start_frame;
  sample_rate_ = header.sample_rate;
  set_counts({header.num_points, offsetof(Header, num_points)},
             {header.num_samples, offsetof(Header, num_samples)}, sizeof header, 0);
}

PointCache read_pc2(const fs::path& file) {
  Pc2Reader reader(file);
  return {.num_points = reader.num_points(),
          .start_frame = reader.start_frame(),
          .sample_rate = reader.sample_rate(),
          .frames = reader.frames()};
}

}  // namespace weft::engine
