#pragma once
/// Folders of tests, for files of WEFT_OUTPUT_DIR.

#include <gtest/gtest.h>

#include <filesystem>

namespace weft::engine {

/// Makes the running test's own folder, empty: tests run at the same time. Its files stay, to be looked at.
inline std::filesystem::path make_own_folder() {
  const testing::TestInfo& test = *testing::UnitTest::GetInstance()->current_test_info();
  const std::filesystem::path folder =
      std::filesystem::path(WEFT_OUTPUT_DIR) / test.test_suite_name() / test.name();
  std::filesystem::remove_all(folder);
  std::filesystem::create_directories(folder);
  return folder;
}

}  // namespace weft::engine
