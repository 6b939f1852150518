#include "apps/common/progress.h"

#include <gtest/gtest.h>

#include <vector>

namespace weft::engine::app {
namespace {

/// Log lines of a run with these frame times [s].
std::vector<std::string> lines(const std::vector<double>& frame_seconds) {
  ProgressLog log("scene");
  std::vector<std::string> lines;
  const int num_frames = static_cast<int>(frame_seconds.size());
  double spent = 0;
  for (int frame = 1; frame <= num_frames; ++frame) {
    spent += frame_seconds[frame - 1];
    const std::string line =
        log.line({frame, num_frames, spent, spent / frame * (num_frames - frame)}, spent);
    if (!line.empty()) lines.push_back(line);
  }
  return lines;
}

TEST(ProgressLog, TellsEveryTenSecondsWhereTheRunIs) {
  const std::vector<std::string> told = lines(std::vector<double>(70, 0.5));
  EXPECT_EQ(told,
            (std::vector<std::string>{"scene: frame 20 of 70, 25 s left", "scene: frame 40 of 70, 15 s left",
                                      "scene: frame 60 of 70, 5.0 s left"}));
}

TEST(ProgressLog, SaysNothingOfShortRuns) {
  EXPECT_TRUE(lines(std::vector<double>(100, 0.09)).empty());
  EXPECT_TRUE(lines({3, 3, 3, 3}).empty()) << "the last frame needs no line";
}

TEST(ProgressLog, TellsHowLongASlowFrameTook) {
  EXPECT_EQ(lines({4, 26, 1, 8, 1, 100}),
            (std::vector<std::string>{"scene: frame 2 of 6, 1 min 0 s left; the last frame took 26 s",
                                      "scene: frame 5 of 6, 8.0 s left"}));
}

}  // namespace
}  // namespace weft::engine::app
