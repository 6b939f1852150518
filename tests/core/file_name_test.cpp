#include "weft/core/file_name.h"

#include <gtest/gtest.h>

namespace weft::engine {
namespace {

TEST(FileNames, KeepWhatEveryFileSystemAllows) {
  FileNames names;
  EXPECT_EQ(names.add("t-shirt_2.left"), "t-shirt_2.left");
  EXPECT_EQ(names.add("a b/c\\d:e"), "a_b_c_d_e");
}

TEST(FileNames, AreDifferentForDifferentBodies) {
  FileNames names;
  EXPECT_EQ(names.add("a b"), "a_b");
  EXPECT_EQ(names.add("a_b"), "a_b_2");
  EXPECT_EQ(names.add("a_b_2"), "a_b_2_2");
  EXPECT_EQ(names.add("a/b"), "a_b_3");
}

}  // namespace
}  // namespace weft::engine
