/// PC2 files are read back bit by bit, whole at every time, and refused with the place of the damage.

#include "weft/io/pc2.h"

#include <gtest/gtest.h>

#include <atomic>
#include <bit>
#include <cstring>
#include <fstream>
#include <limits>
#include <thread>

#include "tests/own_folder.h"
#include "tests/read_text.h"
#include "weft/error.h"

namespace weft::engine {
namespace {

namespace fs = std::filesystem;

class Pc2 : public testing::Test {
 protected:
  /// Two frames of two points.
  std::string good_bytes() const {
    StagedFile staged(file_);
    Pc2Writer writer(staged, 2);
    writer.add_frame(std::vector<float>{1, 2, 3, 4, 5, 6});
    writer.add_frame(std::vector<float>{-1, -2, -3, -4, -5, -6});
    writer.finish();
    staged.replace();
    return read_text(file_);
  }

  /// The error message for these bytes; every message is one line that begins with the file.
  std::string failure(const std::string& bytes) const {
    std::ofstream(file_, std::ios::binary) << bytes;
    try {
      read_pc2(file_);
    } catch (const InputError& error) {
      const std::string message = error.what();
      EXPECT_TRUE(message.starts_with(file_.string() + ": ")) << message;
      EXPECT_EQ(message.find('\n'), message.npos) << message;
      return message;
    }
    return "no error";
  }

  const fs::path folder_ = make_own_folder();
  const fs::path file_ = folder_ / "sheet.pc2";
  const fs::path partial_ = folder_ / ".sheet.pc2.partial";
};

template <class Number>
std::string with(std::string bytes, std::size_t at, Number number) {
  return bytes.replace(at, sizeof number, reinterpret_cast<const char*>(&number), sizeof number);
}

bool contains(const std::string& text, const std::string& part) { return text.find(part) != text.npos; }

TEST_F(Pc2, HasTheFormatsBytes) {
  const std::string bytes = good_bytes();
  ASSERT_EQ(bytes.size(), 32u + 2 * 2 * 12);
  const std::string header("POINTCACHE2\0\1\0\0\0\2\0\0\0\0\0\0\0\0\0\x80\x3F\2\0\0\0", 32);
  EXPECT_EQ(bytes.substr(0, 32), header);
  float fifth = 0;
  std::memcpy(&fifth, bytes.data() + 32 + 4 * 4, sizeof fifth);
  EXPECT_EQ(fifth, 5);
}

TEST_F(Pc2, KeepsEveryBit) {
  using Limits = std::numeric_limits<float>;
  const std::vector<std::vector<float>> frames = {
      {0.0F, -0.0F, Limits::denorm_min(), Limits::max(), Limits::lowest(), Limits::min()},
      {0.1F, 1.0F / 3, -1e-30F, 16777217.0F, 3.14159274F, 1e30F}};
  StagedFile staged(file_);
  Pc2Writer writer(staged, 2);
  for (const std::vector<float>& frame : frames) writer.add_frame(frame);
  EXPECT_EQ(writer.num_frames(), 2);
  writer.finish();
  staged.replace();
  const PointCache read = read_pc2(file_);
  EXPECT_EQ(read.num_points, 2);
  EXPECT_EQ(read.start_frame, 0);
  EXPECT_EQ(read.sample_rate, 1);
  ASSERT_EQ(read.frames.size(), 2u);
  for (std::size_t f = 0; f < 2; ++f) {
    for (std::size_t k = 0; k < 6; ++k)
      EXPECT_EQ(std::bit_cast<std::uint32_t>(read.frames[f][k]), std::bit_cast<std::uint32_t>(frames[f][k]));
  }
}

TEST_F(Pc2, ReaderFindsTheFramesThatAreAdded) {
  StagedFile staged(file_);
  Pc2Writer writer(staged, 1);
  EXPECT_EQ(read_pc2(partial_).frames.size(), 0u);
  for (int k = 0; k < 5; ++k) {
    const auto value = static_cast<float>(k);
    writer.add_frame(std::vector<float>(3, value));
    const PointCache read = read_pc2(partial_);
    ASSERT_EQ(read.frames.size(), static_cast<std::size_t>(k) + 1);
    EXPECT_EQ(read.frames.back(), std::vector<float>(3, value));
  }
}

TEST_F(Pc2, ReaderBesideTheWriterFindsWholeFramesOnly) {
  constexpr int kFrames = 200, kPoints = 5000;
  StagedFile staged(file_);
  Pc2Writer writer(staged, kPoints);
  std::atomic<bool> is_done = false;
  int num_reads = 0, num_wrong = 0;
  std::thread reader([&] {
    while (!is_done) {
      const PointCache read = read_pc2(partial_);
      ++num_reads;
      for (std::size_t f = 0; f < read.frames.size(); ++f)
        num_wrong += read.frames[f] != std::vector<float>(3 * kPoints, static_cast<float>(f + 1));
    }
  });
  for (int f = 0; f < kFrames; ++f)
    writer.add_frame(std::vector<float>(3 * kPoints, static_cast<float>(f + 1)));
  is_done = true;
  reader.join();
  EXPECT_EQ(num_wrong, 0) << "in " << num_reads << " reads";
}

TEST_F(Pc2, IgnoresAnUnfinishedFrame) {
  const std::string bytes = good_bytes();
  std::ofstream(file_, std::ios::binary) << bytes + "1234567";
  EXPECT_EQ(read_pc2(file_).frames.size(), 2u);
}

TEST_F(Pc2, DamagedHeaderIsRefusedWithThePlace) {
  const std::string good = good_bytes();
  EXPECT_EQ(failure(good), "no error");
  EXPECT_TRUE(contains(failure(with(good, 0, 'Q')), "byte 0: expected POINTCACHE2"));
  EXPECT_TRUE(contains(failure(with(good, 11, 'x')), "byte 0: "));
  EXPECT_TRUE(contains(failure(with(good, 12, std::int32_t{2})), "byte 12: version 2, expected version 1"));
  EXPECT_TRUE(contains(failure(with(good, 16, std::int32_t{0})), "byte 16: 0 points"));
  EXPECT_TRUE(
      contains(failure(with(good, 16, std::int32_t{-2147483647 - 1})), "byte 16: -2147483648 points"));
  EXPECT_TRUE(contains(failure(with(good, 20, std::numeric_limits<float>::quiet_NaN())), "byte 20: "));
  EXPECT_TRUE(contains(failure(with(good, 24, 0.0F)), "byte 24: the sample rate"));
  EXPECT_TRUE(contains(failure(with(good, 28, std::int32_t{-1})), "byte 28: -1 frames"));
}

TEST_F(Pc2, CountsThatTheFileCannotHoldAreRefused) {
  const std::string good = good_bytes();
  constexpr std::int32_t kMost = 2147483647;
  EXPECT_TRUE(contains(failure(with(good, 28, kMost)),
                       "byte 28: 2147483647 frames of 2 points, but the file holds 2"));
  EXPECT_TRUE(contains(failure(with(good, 16, kMost)), "2 frames of 2147483647 points"));
  EXPECT_TRUE(contains(failure(with(with(good, 16, kMost), 28, kMost)), "but the file holds 0"));
}

TEST_F(Pc2, TruncatedFileIsRefusedAtEveryLength) {
  const std::string good = good_bytes();
  for (std::size_t length = 0; length < good.size(); ++length) {
    const std::string message = failure(good.substr(0, length));
    const std::string place = length < 32 ? "byte " + std::to_string(length) + ": " : "byte 28: ";
    EXPECT_TRUE(contains(message, place)) << length << ": " << message;
  }
}

TEST_F(Pc2, NonFinitePositionIsRefusedWithItsPlace) {
  const std::string bad = with(good_bytes(), 32 + 4 * 7, std::numeric_limits<float>::infinity());
  EXPECT_TRUE(contains(failure(bad), "byte 60: the position is not a finite number"));
}

TEST_F(Pc2, MissingFileAndFolderAreRefused) {
  EXPECT_THROW(read_pc2(folder_ / "missing.pc2"), InputError);
  EXPECT_THROW(read_pc2(folder_), InputError);
}

TEST_F(Pc2, FramesAreReadOneByOneInAnyOrder) {
  const std::string bytes = with(with(good_bytes(), 20, 5.5F), 24, 0.5F);
  std::ofstream(file_, std::ios::binary) << bytes + "1234567";  // an unfinished frame
  Pc2Reader reader(file_);
  EXPECT_EQ(reader.num_points(), 2);
  EXPECT_EQ(reader.num_frames(), 2);
  EXPECT_EQ(reader.start_frame(), 5.5F);
  EXPECT_EQ(reader.sample_rate(), 0.5F);
  const std::vector<float> first = {1, 2, 3, 4, 5, 6}, second = {-1, -2, -3, -4, -5, -6};
  EXPECT_EQ(reader.frame(1), second);
  EXPECT_EQ(reader.frame(0), first);
  EXPECT_EQ(reader.frame(1), second);
}

TEST_F(Pc2, DamagedFrameLeavesTheOthersReadable) {
  const std::string bytes = with(good_bytes(), 32 + 4 * 2, std::numeric_limits<float>::quiet_NaN());
  std::ofstream(file_, std::ios::binary) << bytes;
  Pc2Reader reader(file_);
  EXPECT_THROW(reader.frame(0), InputError);
  EXPECT_EQ(reader.frame(1)[0], -1);
  fs::resize_file(file_, 32 + 24);
  EXPECT_THROW(reader.frame(1), InputError);
  fs::resize_file(file_, 32 + 48);
  EXPECT_EQ(reader.frame(1)[0], 0);
}

TEST_F(Pc2, FullDiskIsAnErrorWithTheFilesName) {
  StagedFile full("/dev/full");
  try {
    Pc2Writer writer(full, 1);
    FAIL();
  } catch (const InputError& error) {
    EXPECT_STREQ(error.what(), "/dev/full cannot be written: No space left on device");
  }
}

TEST_F(Pc2, FrameOfAnotherSizeIsRefused) {
  StagedFile staged(file_);
  Pc2Writer writer(staged, 2);
  EXPECT_THROW(writer.add_frame(std::vector<float>(3)), InputError);
  EXPECT_EQ(read_pc2(partial_).frames.size(), 0u);
}

}  // namespace
}  // namespace weft::engine
