#pragma once
/// The command line program, run from a shell.

#include <gtest/gtest.h>
#include <sys/wait.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>

#include "tests/read_text.h"

namespace weft::engine {

namespace fs = std::filesystem;

inline nlohmann::json read_json(const fs::path& file) { return nlohmann::json::parse(read_text(file)); }

inline bool contains(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

/// Results of a command.
struct Finished {
  int exit_code = -1;
  std::string out, err;
};

/// Each test runs in its own empty folder.
class App : public testing::Test {
 protected:
  void SetUp() override {
    const fs::path folder =
        fs::path(WEFT_OUTPUT_DIR) / testing::UnitTest::GetInstance()->current_test_info()->name();
    fs::remove_all(folder);
    fs::create_directories(folder);
    fs::current_path(folder);
  }

  /// Runs a shell command, in which "weft" is the program.
  static Finished shell(const std::string& command) {
    const std::string line =
        "weft() { '" WEFT_PROGRAM "' \"$@\"; }\n{ " + command + "\n} > stdout.txt 2> stderr.txt";
    const int status = std::system(line.c_str());
    return {WIFEXITED(status) ? WEXITSTATUS(status) : -1, read_text("stdout.txt"), read_text("stderr.txt")};
  }

  /// Bad input: exit code 2, nothing on standard output, and these words on standard error.
  static void expect_bad_input(const std::string& command, const std::string& words) {
    const Finished done = shell(command);
    EXPECT_EQ(done.exit_code, 2) << command;
    EXPECT_EQ(done.out, "") << command;
    EXPECT_TRUE(contains(done.err, words)) << command << "\nsaid: " << done.err << "expected: " << words;
  }
};

}  // namespace weft::engine
