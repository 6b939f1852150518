/// MDD files are read back bit by bit, at once and frame by frame, and refused with the place of the damage.

#include "weft/io/mdd.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <fstream>
#include <limits>

#include "tests/own_folder.h"
#include "tests/read_text.h"
#include "weft/core/random.h"
#include "weft/error.h"

namespace weft::engine {
namespace {

namespace fs = std::filesystem;

/// Two frames of two points at 0 and 0.5 s.
const std::string kGood(
    "\0\0\0\2\0\0\0\2"
    "\0\0\0\0\x3F\0\0\0"
    "\x3F\x80\0\0\x40\0\0\0\x40\x40\0\0\x40\x80\0\0\x40\xA0\0\0\x40\xC0\0\0"
    "\xBF\x80\0\0\xC0\0\0\0\xC0\x40\0\0\xC0\x80\0\0\xC0\xA0\0\0\xC0\xC0\0\0",
    64);
const std::vector<float> kFirst = {1, 2, 3, 4, 5, 6}, kSecond = {-1, -2, -3, -4, -5, -6};

class Mdd : public testing::Test {
 protected:
  void write(const std::string& bytes) const { std::ofstream(file_, std::ios::binary) << bytes; }

  std::string written() const { return read_text(file_); }

  /// The error message for these bytes, without the file's name.
  std::string failure(const std::string& bytes) const {
    write(bytes);
    try {
      read_mdd(file_);
    } catch (const InputError& error) {
      const std::string message = error.what(), begin = file_.string() + ": ";
      EXPECT_TRUE(message.starts_with(begin)) << message;
      return message.substr(begin.size());
    }
    return "no error";
  }

  const fs::path folder_ = make_own_folder();
  const fs::path file_ = folder_ / "sheet.mdd";
};

/// The bytes with a number at this byte, big-endian.
template <class Number>
std::string with(std::string bytes, std::size_t at, Number number) {
  auto bits = std::bit_cast<std::uint32_t>(number);
  for (std::size_t k = 4; k-- > 0; bits >>= 8) bytes[at + k] = static_cast<char>(bits);
  return bytes;
}

TEST_F(Mdd, HasTheFormatsBytes) {
  StagedFile staged(file_);
  MddWriter writer(staged, 2, std::vector<float>{0, 0.5F});
  writer.add_frame(kFirst);
  writer.add_frame(kSecond);
  writer.finish();
  staged.replace();
  EXPECT_EQ(written(), kGood);
}

TEST_F(Mdd, ReadsTheFormatsBytes) {
  write(kGood + "behind");
  const MddCache cache = read_mdd(file_);
  EXPECT_EQ(cache.num_points, 2);
  EXPECT_EQ(cache.times, (std::vector<float>{0, 0.5F}));
  EXPECT_EQ(cache.frames, (std::vector<std::vector<float>>{kFirst, kSecond}));
}

TEST_F(Mdd, FramesAreReadOneByOneInAnyOrder) {
  write(kGood);
  MddReader reader(file_);
  EXPECT_EQ(reader.num_points(), 2);
  EXPECT_EQ(reader.num_frames(), 2);
  EXPECT_EQ(reader.times(), (std::vector<float>{0, 0.5F}));
  PointCacheReader& any = reader;
  EXPECT_EQ(any.frame(1), kSecond);
  EXPECT_EQ(any.frame(0), kFirst);
  EXPECT_EQ(any.frame(1), kSecond);
}

TEST_F(Mdd, KeepsEveryBit) {
  Random random(1);
  const auto number = [&] {
    while (true) {
      const auto candidate = std::bit_cast<float>(static_cast<std::uint32_t>(random.next()));
      if (std::isfinite(candidate)) return candidate;
    }
  };
  constexpr std::size_t kFrames = 20, kFloats = 3 * 33;
  std::vector<float> times(kFrames);
  for (float& time : times) time = number();
  std::vector<std::vector<float>> frames(kFrames, std::vector<float>(kFloats));
  StagedFile staged(file_);
  MddWriter writer(staged, kFloats / 3, times);
  for (std::vector<float>& frame : frames) {
    for (float& coordinate : frame) coordinate = number();
    writer.add_frame(frame);
  }
  writer.finish();
  staged.replace();
  const auto have_same_bits = [](const std::vector<float>& a, const std::vector<float>& b) {
    return a.size() == b.size() && std::equal(a.begin(), a.end(), b.begin(), [](float x, float y) {
             return std::bit_cast<std::uint32_t>(x) == std::bit_cast<std::uint32_t>(y);
           });
  };
  const MddCache read = read_mdd(file_);
  EXPECT_TRUE(have_same_bits(read.times, times));
  ASSERT_EQ(read.frames.size(), kFrames);
  for (std::size_t f = 0; f < kFrames; ++f) EXPECT_TRUE(have_same_bits(read.frames[f], frames[f]));
}

TEST_F(Mdd, AnEmptyCacheIsRead) {
  write(with(kGood, 0, std::int32_t{0}).substr(0, 8));
  EXPECT_TRUE(read_mdd(file_).frames.empty());
}

TEST_F(Mdd, DamageIsRefusedWithThePlace) {
  EXPECT_EQ(failure(kGood), "no error");
  constexpr std::int32_t kMax = 2147483647, kMin = -kMax - 1;
  constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  const std::vector<std::pair<std::string, std::string>> cases = {
      {with(kGood, 0, std::int32_t{-1}), "byte 0: -1 frames, expected 0 or more"},
      {with(kGood, 0, kMin), "byte 0: -2147483648 frames, expected 0 or more"},
      {with(kGood, 0, kMax), "byte 0: 2147483647 frames of 2 points, but the file holds 2"},
      {with(kGood, 0, std::int32_t{3}), "byte 0: 3 frames of 2 points, but the file holds 2"},
      {with(kGood, 4, std::int32_t{0}), "byte 4: 0 points, expected 1 or more"},
      {with(kGood, 4, kMin), "byte 4: -2147483648 points, expected 1 or more"},
      {with(kGood, 4, kMax), "byte 0: 2 frames of 2147483647 points, but the file holds 0"},
      {with(with(kGood, 0, kMax), 4, kMax),
       "byte 0: 2147483647 frames of 2147483647 points, but the file holds 0"},
      {with(kGood, 12, kNan), "byte 12: the time is not a finite number"},
      {with(kGood, 8, -kInfinity), "byte 8: the time is not a finite number"},
      {with(kGood, 16, kNan), "byte 16: the position is not a finite number"},
      {with(kGood, 60, kInfinity), "byte 60: the position is not a finite number"},
  };
  for (const auto& [bytes, message] : cases) EXPECT_EQ(failure(bytes), message);
}

TEST_F(Mdd, TruncatedFileIsRefusedAtEveryLength) {
  for (std::size_t length = 0; length < kGood.size(); ++length) {
    const std::string expected =
        length < 8 ? "byte " + std::to_string(length) + ": the file ends, expected a header of 8 bytes"
                   : "byte 0: 2 frames of 2 points, but the file holds " + std::to_string((length - 8) / 28);
    EXPECT_EQ(failure(kGood.substr(0, length)), expected);
  }
}

TEST_F(Mdd, MissingFileAndFolderAreRefused) {
  EXPECT_THROW(read_mdd(folder_ / "missing.mdd"), InputError);
  EXPECT_THROW(read_mdd(folder_), InputError);
}

TEST_F(Mdd, PartialFileIsRefused) {
  StagedFile staged(file_);
  MddWriter writer(staged, 2, std::vector<float>{0, 0.5F});
  writer.add_frame(kFirst);
  EXPECT_THROW(read_mdd(folder_ / ".sheet.mdd.partial"), InputError);
}

TEST_F(Mdd, WriterRefusesFramesThatTheHeaderDoesNotHave) {
  StagedFile staged(file_);
  MddWriter writer(staged, 2, std::vector<float>{0});
  const auto failure_of = [&](const auto& call) {
    try {
      call();
    } catch (const InputError& error) {
      return std::string(error.what()).substr(file_.string().size());
    }
    return std::string("no error");
  };
  EXPECT_EQ(failure_of([&] { writer.finish(); }), ": 0 frames, expected 1, the number in the header");
  EXPECT_EQ(failure_of([&] { writer.add_frame(std::vector<float>(3)); }),
            ": a frame of 3 coordinates, expected 6");
  EXPECT_EQ(failure_of([&] { writer.add_frame(kFirst); }), "no error");
  EXPECT_EQ(failure_of([&] { writer.add_frame(kFirst); }), ": one frame more than the 1 in the header");
  EXPECT_EQ(failure_of([&] { writer.finish(); }), "no error");
}

TEST_F(Mdd, FullDiskIsAnErrorWithTheFilesName) {
  StagedFile full("/dev/full");
  try {
    MddWriter writer(full, 1, std::vector<float>{0});
    FAIL();
  } catch (const InputError& error) {
    EXPECT_STREQ(error.what(), "/dev/full cannot be written: No space left on device");
  }
}

}  // namespace
}  // namespace weft::engine
