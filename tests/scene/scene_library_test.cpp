#include "weft/scene/scene_library.h"

#include <gtest/gtest.h>

#include <cstdlib>
#include <fstream>

#include "tests/own_folder.h"
#include "weft/core/nearest_name.h"
#include "weft/error.h"

namespace weft::engine {
namespace {

namespace fs = std::filesystem;

const std::filesystem::path kScenes = WEFT_SOURCE_DIR "/scenes";

/// Sets $WEFT_SCENES during the test.
class SceneLibrary : public testing::Test {
 protected:
  void SetUp() override { set_folder(kScenes); }
  void TearDown() override { unsetenv("WEFT_SCENES"); }

  static void set_folder(const std::filesystem::path& folder) { setenv("WEFT_SCENES", folder.c_str(), 1); }

  static std::string failure(const std::string& name) {
    try {
      find_scene(name);
    } catch (const InputError& error) {
      return error.what();
    }
    return "no error";
  }
};

TEST_F(SceneLibrary, FindsScenesByName) {
  EXPECT_EQ(find_scene("paper/fig6_ball"), kScenes / "paper" / "fig6_ball.toml");
}

TEST_F(SceneLibrary, PrefersFilesThatExist) {
  const std::string file = WEFT_SOURCE_DIR "/tests/scene/broken/no_cloth.toml";
  EXPECT_EQ(find_scene(file), file);
}

TEST_F(SceneLibrary, ListsScenesByName) {
  const std::vector<ShippedScene> scenes = list_scenes();
  ASSERT_GE(scenes.size(), 17u);
  for (std::size_t i = 1; i < scenes.size(); ++i) EXPECT_LT(scenes[i - 1].name, scenes[i].name);
}

TEST_F(SceneLibrary, NamesTheNearestScene) {
  const std::string meant = "did you mean \"paper/fig6_ball\"?";
  EXPECT_NE(failure("paper/fig6_bal").find(meant), std::string::npos);
  EXPECT_NE(failure("fig6_ball").find(meant), std::string::npos);
  EXPECT_NE(failure("something else").find("available: "), std::string::npos);
}

TEST_F(SceneLibrary, FolderFromTheEnvironmentMustExist) {
  set_folder("no/such/folder");
  EXPECT_THROW(scene_folder(), InputError);
}

TEST_F(SceneLibrary, FallsBackToTheSourceTree) {
  unsetenv("WEFT_SCENES");
  EXPECT_TRUE(std::filesystem::equivalent(scene_folder(), kScenes));
}

TEST(NearestName, CountsInsertionsDeletionsReplacementsAndSwaps) {
  EXPECT_EQ(edit_distance("density", "density", 3), 0);
  EXPECT_EQ(edit_distance("denisty", "density", 3), 1);
  EXPECT_EQ(edit_distance("desity", "density", 3), 1);
  EXPECT_EQ(edit_distance("densityy", "density", 3), 1);
  EXPECT_EQ(edit_distance("dansity", "density", 3), 1);
  EXPECT_EQ(edit_distance("", "abc", 3), 3);
  EXPECT_EQ(edit_distance("abcdef", "uvwxyz", 3), 4);
}

TEST(NearestName, KeepsSilentWhereNothingIsNear) {
  const std::vector<std::string> names = {"grid", "mesh", "g", "color"};
  EXPECT_EQ(find_nearest("gird", names), "grid");
  EXPECT_EQ(find_nearest("colour", names), "color");
  EXPECT_EQ(find_nearest("h", names), "");
  EXPECT_EQ(find_nearest("elephant", names), "");
}

/// Folders and empty files in a temporary folder of the test.
class SceneFolder : public testing::Test {
 protected:
  fs::path folder(const char* name) const {
    fs::create_directories(root_ / name);
    return root_ / name;
  }

  fs::path file(const char* name) const {
    fs::create_directories((root_ / name).parent_path());
    std::ofstream(root_ / name) << ' ';
    return root_ / name;
  }

  const fs::path root_ = make_own_folder();
};

TEST_F(SceneFolder, IsBesideTheLibraryBeforeTheProgram) {
  const fs::path library = file("a/lib/x86_64-linux-gnu/libweft.so"), program = file("b/bin/app");
  const fs::path of_program = folder("b/share/weft/scenes");
  EXPECT_EQ(find_scene_folder(library, program), of_program);
  const fs::path of_library = folder("a/share/weft/scenes");
  EXPECT_EQ(find_scene_folder(library, program), of_library);
  EXPECT_EQ(find_scene_folder({}, program), of_program);
}

TEST_F(SceneFolder, OfTheSourceTreeIsTheLastResort) {
  const fs::path program = file("tree/build/release/bin/weft");
  folder("tree/scenes");
  file("tree/include/weft/weft.h");
  EXPECT_EQ(find_scene_folder(program, program), root_ / "tree/scenes");
  folder("tree/build/share/weft/scenes");
  EXPECT_EQ(find_scene_folder(program, program), root_ / "tree/build/share/weft/scenes");
}

}  // namespace
}  // namespace weft::engine
