#include "weft/render/video.h"

#include <gtest/gtest.h>

#include <unistd.h>

#include <array>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <fstream>

#include "weft/error.h"

namespace weft::engine {
namespace {

namespace fs = std::filesystem;

const fs::path kFolder = WEFT_OUTPUT_DIR;

bool has_ffmpeg() {
  try {
    require_ffmpeg("video");
    return true;
  } catch (const InputError&) {
    return false;
  }
}

Image make_image(int shade) {
  Image image(64, 48);
  std::fill(image.rgba.begin(), image.rgba.end(), static_cast<std::uint8_t>(shade));
  return image;
}

std::string output_of(const std::string& command) {
  std::string text;
  FILE* pipe = popen(command.c_str(), "r");
  std::array<char, 256> buffer{};
  while (fgets(buffer.data(), static_cast<int>(buffer.size()), pipe)) text += buffer.data();
  pclose(pipe);
  return text;
}

std::string read(const fs::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

class Video : public testing::TestWithParam<const char*> {
 protected:
  void SetUp() override {
    if (!has_ffmpeg()) GTEST_SKIP() << "ffmpeg is not installed";
    fs::create_directories(kFolder);
  }
};

TEST_P(Video, HasAsManyFramesAsWereAdded) {
  const fs::path file = kFolder / (std::string("shades.") + GetParam());
  VideoWriter video(file, 64, 48, 20);
  for (int k = 0; k < 12; ++k) video.add(make_image(20 * k));
  video.finish();
  const std::string content = read(file);
  EXPECT_GT(content.size(), 100u);
  EXPECT_FALSE(fs::exists(file.string() + ".part"));
  if (std::string(GetParam()) == "webp") {  // ffprobe 5 does not read animated WebP
    int frames = 0;
    for (std::size_t at = 0; (at = content.find("ANMF", at)) != std::string::npos; ++at) ++frames;
    EXPECT_EQ(frames, 12);
  } else {
    EXPECT_EQ(output_of("ffprobe -v error -count_frames -show_entries stream=nb_read_frames -of csv=p=0 '" +
                        file.string() + "'"),
              "12\n");
  }
}

INSTANTIATE_TEST_SUITE_P(AllKinds, Video, testing::Values("mp4", "webp", "gif"),
                         [](const auto& kind) { return std::string(kind.param); });

TEST(VideoErrors, KeepsAnEarlierFileUnlessFinished) {
  if (!has_ffmpeg()) GTEST_SKIP() << "ffmpeg is not installed";
  fs::create_directories(kFolder);
  const fs::path file = kFolder / "kept.mp4";
  std::ofstream(file) << "earlier";
  {
    VideoWriter video(file, 64, 48, 20);
    video.add(make_image(7));
  }  // not finished
  EXPECT_EQ(read(file), "earlier");
  EXPECT_FALSE(fs::exists(file.string() + ".part"));
}

TEST(VideoErrors, SignalsToTheWholeGroupLeaveFfmpegAtWork) {
  if (!has_ffmpeg()) GTEST_SKIP() << "ffmpeg is not installed";
  fs::create_directories(kFolder);
  const fs::path file = kFolder / "signalled.mp4";
  VideoWriter video(file, 64, 48, 20);
  const std::string children = "/proc/self/task/" + std::to_string(getpid()) + "/children";
  if (!fs::exists(children)) GTEST_SKIP() << "the system does not tell child processes";
  const int ffmpeg = std::atoi(read(children).c_str());
  ASSERT_GT(ffmpeg, 0);
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) kill(ffmpeg, signal);
  for (int k = 0; k < 12; ++k) video.add(make_image(20 * k));
  video.finish();
  EXPECT_GT(fs::file_size(file), 100u);
}

TEST(VideoErrors, IsNamed) {
  if (!has_ffmpeg()) GTEST_SKIP() << "ffmpeg is not installed";
  EXPECT_THROW(VideoWriter("film.avi", 64, 48, 20), InputError);
  const auto write_nowhere = [] {
    VideoWriter video(kFolder / "no such folder" / "a.mp4", 64, 48, 20);
    for (int k = 0; k < 200; ++k) video.add(make_image(k));
    video.finish();
  };
  EXPECT_THROW(write_nowhere(), InputError) << "and the program goes on";
}

TEST(VideoErrors, WithoutFfmpegSaysWhatToInstall) {
  const std::string path = std::getenv("PATH");
  setenv("PATH", "/nowhere", 1);
  std::string said;
  try {
    require_ffmpeg("film.mp4");
  } catch (const InputError& error) {
    said = error.what();
  }
  setenv("PATH", path.c_str(), 1);
  EXPECT_NE(said.find("film.mp4 requires ffmpeg"), std::string::npos) << said;
  EXPECT_NE(said.find("install"), std::string::npos) << said;
}

}  // namespace
}  // namespace weft::engine
