/// The examples and defaults of the manual on scene files are correct.

#include <gtest/gtest.h>

#include <fstream>
#include <iterator>
#include <string>

#include "weft/scene/scene_reader.h"

namespace weft::engine {
namespace {

TEST(Manual, ItsSceneFileIsGood) {
  std::ifstream in(std::string(WEFT_SOURCE_DIR) + "/docs/manual/scenes.md");
  const std::string page{std::istreambuf_iterator<char>(in), {}};
  const auto begin = page.find("```toml\n") + 8, end = page.find("```", begin);
  ASSERT_NE(end, std::string::npos);
  const SceneDesc scene = parse_scene(page.substr(begin, end - begin), "docs/manual/scenes.md");
  EXPECT_EQ(scene.cloths.at(0).pins.size(), 4u);
  EXPECT_EQ(scene.colliders.size(), 4u);

  // The values shown as usual are the defaults.
  const SceneDesc defaults;
  EXPECT_EQ(scene.gravity, defaults.gravity);
  EXPECT_EQ(scene.solver.implicit_euler.tolerance, defaults.solver.implicit_euler.tolerance);
  EXPECT_EQ(scene.solver.newton.iterations, defaults.solver.newton.iterations);
  EXPECT_EQ(scene.solver.newton.quality, defaults.solver.newton.quality);
  EXPECT_EQ(scene.solver.implicit_euler.iterations, defaults.solver.implicit_euler.iterations);
  EXPECT_EQ(scene.solver.integrator, defaults.solver.integrator);
  EXPECT_EQ(scene.cloths[0].material.structural, ClothMaterial{}.structural);
  EXPECT_EQ(scene.cloths[0].material.thickness, ClothMaterial{}.thickness);
  EXPECT_EQ(scene.cloths[0].material.friction, ClothMaterial{}.friction);
}

std::string read_page(const std::string& name) {
  std::ifstream in(std::string(WEFT_SOURCE_DIR) + "/docs/" + name);
  return {std::istreambuf_iterator<char>(in), {}};
}

TEST(Manual, ItsFirstSceneIsGood) {
  const std::string page = read_page("manual/getting_started.md");
  const auto begin = page.find("```toml\n") + 8, end = page.find("```", begin);
  ASSERT_NE(end, std::string::npos);
  const SceneDesc scene = parse_scene(page.substr(begin, end - begin), "docs/manual/getting_started.md");
  EXPECT_EQ(scene.cloths.at(0).name, "curtain");
  EXPECT_EQ(scene.colliders.size(), 1u);
}

TEST(Manual, ListsEveryKeyTheReaderKnows) {
  EXPECT_EQ(read_page("reference/scene_keys.md"), describe_scene_keys())
      << "run `weft check --keys > docs/reference/scene_keys.md`, and describe new keys in "
         "docs/manual/scenes.md";
}

TEST(Manual, ExplainsEveryKeyThatItLists) {
  const std::string manual = read_page("manual/scenes.md"), keys = describe_scene_keys();
  int count = 0;
  for (auto at = keys.find("| `"); at != std::string::npos; at = keys.find("| `", at + 1), ++count) {
    const auto begin = at + 3, end = keys.find('`', begin);
    const std::string key = keys.substr(begin, end - begin);
    EXPECT_NE(manual.find(key), std::string::npos) << key << " is not in docs/manual/scenes.md";
  }
  EXPECT_GT(count, 60);
}

}  // namespace
}  // namespace weft::engine
