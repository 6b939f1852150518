/// What the manual says about scene files is true.

#include <gtest/gtest.h>

#include <fstream>
#include <iterator>
#include <string>

#include "weft/scene/scene_reader.h"

namespace weft {
namespace {

TEST(Manual, ItsSceneFileIsGood) {
  std::ifstream in(std::string(WEFT_SOURCE_DIR) + "/docs/scenes.md");
  const std::string page{std::istreambuf_iterator<char>(in), {}};
  const auto begin = page.find("```toml\n") + 8, end = page.find("```", begin);
  ASSERT_NE(end, std::string::npos);
  const SceneDesc scene = parse_scene(page.substr(begin, end - begin), "docs/scenes.md");
  EXPECT_EQ(scene.cloths.at(0).pins.size(), 4u);
  EXPECT_EQ(scene.colliders.size(), 4u);

  // The values it shows as usual are the defaults.
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

}  // namespace
}  // namespace weft
