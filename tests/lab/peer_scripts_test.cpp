/// Scripts of other engines, replaced by shell scripts.

#include "lab/comparisons/peer_scripts.h"

#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>

namespace weft::engine::lab {
namespace {

namespace fs = std::filesystem;

/// Replaces Python by a shell script with this `body`, in which $2 … are the arguments of the script.
void make_python(const std::string& body) {
  const std::string test = testing::UnitTest::GetInstance()->current_test_info()->name();
  fs::create_directories(WEFT_OUTPUT_DIR);
  const fs::path program = fs::path(WEFT_OUTPUT_DIR) / (test + "'s python");
  std::ofstream(program) << "#!/bin/sh\n" << body << "\n";
  fs::permissions(program, fs::perms::owner_all);
  setenv("WEFT_PYTHON", program.c_str(), 1);
}

/// Two particles, two frames, an argument: twelve floats into $4.
std::optional<PeerRun> run_two() { return run_peer({Interpreter::python, "any.py", "7"}, 2, 2); }

const std::string kWrite = R"(printf '\000\000\200\077%.0s' 1 2 3 4 5 6 7 8 9 10 11 12 > "$4")";
const std::string kTell = R"(echo '{"engine": "Loom '$2 $3'", "cpu_ms_per_frame": 1.5}')";

TEST(PeerScripts, GiveBackWhatTheyPrintAndLeave) {
  make_python("echo Hello\n" + kWrite + "\n" + kTell + "\necho Bye");
  const auto run = run_two();
  ASSERT_TRUE(run);
  EXPECT_EQ(run->engine, "Loom 7 2");  // its argument, and the number of frames
  EXPECT_EQ(run->cpu_ms, 1.5);
  EXPECT_EQ(run->frames, std::vector(2, std::vector<float>(6, 1.0F)));
}

TEST(PeerScripts, AreEmptyWhereSomethingIsMissing) {
  make_python(kWrite + "\n" + kTell + "\nexit 1");
  EXPECT_FALSE(run_two());
  make_python(kWrite);
  EXPECT_FALSE(run_two());
  make_python("printf 1234 > \"$4\"\n" + kTell);
  EXPECT_FALSE(run_two());
  setenv("WEFT_PYTHON", "/no/such/python", 1);
  EXPECT_FALSE(run_two());
}

}  // namespace
}  // namespace weft::engine::lab
