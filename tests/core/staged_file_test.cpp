#include "weft/core/staged_file.h"

#include <gtest/gtest.h>

#include <fstream>
#include <functional>
#include <iterator>
#include <string>

#include "tests/own_folder.h"
#include "weft/error.h"

namespace weft::engine {
namespace {

namespace fs = std::filesystem;

/// Each test has an empty folder.
class StagedFiles : public testing::Test {
 protected:
  void SetUp() override { folder_ = make_own_folder(); }

  fs::path path(const char* name) const { return folder_ / name; }

  std::string read(const char* name) const {
    std::ifstream in(path(name), std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
  }

  void write(const char* name, const std::string& text) const { std::ofstream(path(name)) << text; }

  long num_files() const { return std::distance(fs::directory_iterator(folder_), {}); }

  fs::path folder_;
};

std::string error_of(const std::function<void()>& write) {
  try {
    write();
  } catch (const InputError& error) {
    return error.what();
  }
  return "no error";
}

TEST_F(StagedFiles, KeepTheOldContentUntilTheyReplaceIt) {
  write("a.txt", "old");
  StagedFile staged(path("a.txt"));
  staged.out() << "new";
  EXPECT_EQ(read("a.txt"), "old");
  staged.finish();
  EXPECT_EQ(read("a.txt"), "old");
  EXPECT_EQ(read(".a.txt.partial"), "new") << "aside, in the same folder";
  staged.replace();
  EXPECT_EQ(read("a.txt"), "new");
  EXPECT_EQ(num_files(), 1);
}

TEST_F(StagedFiles, LeaveNothingWhenTheyAreGivenUp) {
  write("a.txt", "old");
  { StagedFile(path("a.txt")).out() << "new"; }
  { StagedFile(path("b.txt")).out() << "new"; }
  EXPECT_EQ(read("a.txt"), "old");
  EXPECT_EQ(num_files(), 1);
}

TEST_F(StagedFiles, OverwriteWhatAKilledProgramLeft) {
  write(".a.txt.partial", "longer than the new content");
  write_file(path("a.txt"), "new");
  EXPECT_EQ(read("a.txt"), "new");
  EXPECT_EQ(num_files(), 1);
}

TEST_F(StagedFiles, KeepLinksAndPermissions) {
  fs::create_directories(path("elsewhere"));
  write("elsewhere/a.txt", "old");
  fs::permissions(path("elsewhere/a.txt"), fs::perms::owner_read | fs::perms::owner_write);
  fs::create_symlink("elsewhere/a.txt", path("link.txt"));
  write_file(path("link.txt"), "new");
  EXPECT_TRUE(fs::is_symlink(path("link.txt")));
  EXPECT_EQ(read("elsewhere/a.txt"), "new");
  EXPECT_EQ(fs::status(path("elsewhere/a.txt")).permissions(),
            fs::perms::owner_read | fs::perms::owner_write);
}

TEST_F(StagedFiles, NameTheFileAndTheReason) {
  const fs::path missing = path("missing") / "a.txt";
  EXPECT_EQ(error_of([&] { write_file(missing, "new"); }),
            missing.string() + " cannot be written: No such file or directory");
  fs::create_directories(path("folder.txt/occupied"));
  EXPECT_EQ(error_of([&] { write_file(path("folder.txt"), "new"); }),
            path("folder.txt").string() + " cannot be written: Is a directory");
  EXPECT_EQ(num_files(), 1) << "nothing is left aside";
}

TEST_F(StagedFiles, TellOfAFullDevice) {
  if (!fs::exists("/dev/full")) GTEST_SKIP() << "there is no /dev/full";
  const std::string expected = "/dev/full cannot be written: No space left on device";
  EXPECT_EQ(error_of([] { write_file("/dev/full", "few letters"); }), expected);
  EXPECT_EQ(error_of([] { write_file("/dev/full", std::string(1 << 20, 'x')); }), expected);
  EXPECT_TRUE(fs::is_character_file("/dev/full")) << "it is written directly, not replaced";
}

TEST_F(StagedFiles, AreTestedForWritabilityWithoutATrace) {
  write("a.txt", "old");
  require_writable(path("a.txt"));
  require_writable(path("b.txt"));
  EXPECT_EQ(read("a.txt"), "old");
  EXPECT_EQ(num_files(), 1);
  fs::create_directories(path(".a.txt.partial/occupied"));  // the partial file cannot be written
  EXPECT_EQ(error_of([&] { require_writable(path("a.txt")); }),
            path("a.txt").string() + " cannot be written: Is a directory");
  EXPECT_EQ(read("a.txt"), "old");
}

}  // namespace
}  // namespace weft::engine
