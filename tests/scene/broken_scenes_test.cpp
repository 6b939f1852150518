/// Typical mistakes in scene files, in tests/scene/broken. Each file lists the expected errors, in the order
/// of reporting:
///
///   # set: cloth[0].fabric.density=heavy        an override
///   # error: 7:3: unknown key "denisty"         line, column and a part of the message
///   # error: --set cloth[0].fabric.density: expected a number

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <sstream>

#include "weft/scene/scene_reader.h"

namespace weft::engine {
namespace {

using Lines = std::vector<std::string>;

std::string read(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

/// The rest of each line that begins with the mark.
Lines lines_marked(const std::string& text, const std::string& mark) {
  Lines marked;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    if (line.starts_with(mark)) marked.push_back(line.substr(mark.size()));
  }
  return marked;
}

/// "7:3: message" or "--set path: message", as in the comments.
std::string describe(const Diagnostic& d) {
  const bool has_place = d.line > 0;
  const std::string place = has_place ? std::to_string(d.line) + ":" + std::to_string(d.column) : d.file;
  return place + ": " + d.message;
}

Lines mistakes(const std::string& text, const Overrides& overrides = {}) {
  Lines found;
  try {
    parse_scene(text, "scene.toml", overrides);
  } catch (const SceneError& error) {
    for (const Diagnostic& d : error.diagnostics()) found.push_back(describe(d));
  }
  return found;
}

/// Whether line and column are equal and the message contains the expected part.
bool matches(const std::string& found, const std::string& expected) {
  const std::size_t message = expected.find(": ") + 2;
  return found.starts_with(expected.substr(0, message)) &&
         found.find(expected.substr(message)) != std::string::npos;
}

std::vector<std::filesystem::path> broken_files() {
  std::vector<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::directory_iterator(WEFT_SOURCE_DIR "/tests/scene/broken")) {
    if (entry.path().extension() == ".toml") files.push_back(entry.path());
  }
  std::sort(files.begin(), files.end());
  return files;
}

TEST(BrokenScenes, AreReportedWithExactlyTheMistakesTheyName) {
  EXPECT_GE(broken_files().size(), 36u);
  for (const std::filesystem::path& file : broken_files()) {
    SCOPED_TRACE(file.filename());
    const std::string text = read(file);
    const Lines expected = lines_marked(text, "# error: ");
    const Lines found = mistakes(text, lines_marked(text, "# set: "));
    EXPECT_FALSE(expected.empty());
    ASSERT_EQ(found.size(), expected.size()) << testing::PrintToString(found);
    for (std::size_t i = 0; i < found.size(); ++i) EXPECT_PRED2(matches, found[i], expected[i]);
  }
}

TEST(BrokenScenes, EmptyFileLacksSceneAndCloth) {
  for (const char* text : {"", "\n\n", "\xEF\xBB\xBF", "# nothing but a comment"}) {
    const Lines found = mistakes(text);
    ASSERT_EQ(found.size(), 2u) << text;
    EXPECT_EQ(found[0], "1:1: missing key \"scene\", expected [scene] with format = 1");
    EXPECT_EQ(found[1], "1:1: missing key \"cloth\", expected at least one [[cloth]]");
  }
}

TEST(BrokenScenes, BinaryFileIsNotToml) {
  const std::string picture("\x89PNG\r\n\x1a\n\0\0\0\rIHDR", 16);
  const std::string zeros(1000, '\0');
  for (const std::string& bytes :
       {picture, zeros, std::string("\xff\xfe[\0s\0c\0", 8), std::string("a = \xe2\x82")}) {
    const Lines found = mistakes(bytes);
    ASSERT_EQ(found.size(), 1u);
    EXPECT_NE(found[0].find("not TOML"), std::string::npos) << found[0];
  }
}

TEST(BrokenScenes, FileCutOffAnywhereIsAFewMistakesAtMost) {
  const std::string text = read(WEFT_SOURCE_DIR "/scenes/paper/fig6_ball.toml");
  for (std::size_t length = 0; length < text.size(); ++length) {
    const Lines found = mistakes(text.substr(0, length));
    EXPECT_LE(found.size(), 4u) << text.substr(0, length);
  }
}

TEST(BrokenScenes, AHundredThousandLevelsDoNotExhaustTheStack) {
  std::string keys = "a";
  for (int i = 0; i < 100000; ++i) keys += ".a";
  const std::string brackets(100000, '['), deeper = "nested more than 32 levels deep";
  for (const std::string& text :
       {"x = " + brackets, brackets, "[" + keys + "]", keys + " = 1", "x = { " + keys}) {
    const Lines found = mistakes(text);
    ASSERT_EQ(found.size(), 1u);
    EXPECT_NE(found[0].find(deeper), std::string::npos) << found[0];
  }
  const Lines path_too_long = mistakes("", {keys + "=1"}), value_too_deep = mistakes("", {"x=" + brackets});
  EXPECT_NE(path_too_long.back().find("expected path.to.key=value"), std::string::npos);
  EXPECT_EQ(value_too_deep.back().substr(0, 9), "--set x: ");
}

TEST(BrokenScenes, AllMistakesStandInTheErrorOnePerLine) {
  const SceneError error({{"a.toml", 3, 7, "x is wrong"}, {"--set y", 0, 0, "y is wrong"}});
  EXPECT_STREQ(error.what(), "a.toml:3:7: x is wrong\n--set y: y is wrong");
}

TEST(BrokenScenes, FileThatCannotBeReadIsNamed) {
  try {
    read_scene("no/such/scene.toml");
    FAIL() << "read a file that is not there";
  } catch (const SceneError& error) {
    EXPECT_STREQ(error.what(), "no/such/scene.toml: cannot be opened");
  }
  EXPECT_THROW(read_scene(WEFT_SOURCE_DIR "/tests"), SceneError);
}

}  // namespace
}  // namespace weft::engine
