/// A fabric by name with changed numbers.

#include <gtest/gtest.h>

#include "weft/error.h"
#include "weft/fabric.h"
#include "weft/scene/scene_reader.h"

namespace weft::engine {
namespace {

SceneDesc scene_with(const std::string& fabric) {
  return parse_scene(
      "[scene]\nformat = 1\n[[cloth]]\ngrid = { size = [1, 1], cells = [4, 4] }\nfabric = " + fabric + "\n",
      "scene.toml");
}

/// The reader's error message; empty: none.
std::string error_of(const std::string& fabric) {
  try {
    scene_with(fabric);
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

TEST(FabricBase, GivesWhatATableLeavesOut) {
  const SceneDesc scene = scene_with("{ base = \"denim\", thickness = 0.0003 }");
  const Fabric denim = find_fabric("denim");
  ASSERT_TRUE(scene.cloths[0].fabric);
  EXPECT_EQ(scene.cloths[0].fabric->name, "denim");
  EXPECT_EQ(scene.cloths[0].fabric->numbers.c11, denim.c11);
  EXPECT_EQ(scene.cloths[0].material.density, denim.density);
  EXPECT_EQ(scene.cloths[0].material.thickness, 0.0003);
  EXPECT_NE(denim.thickness, 0.0003);
}

TEST(FabricBase, OfAnotherNameIsAnsweredWithTheNearest) {
  const std::string error = error_of("{ base = \"denmi\", thickness = 0.0003 }");
  EXPECT_NE(error.find("did you mean \"denim\"?"), std::string::npos) << error;
}

TEST(FabricBase, ThatDoesNotGoWithTheNumbersIsToldOf) {
  const std::string error = error_of("{ base = \"denim\", thickness = 0.00001 }");
  EXPECT_NE(error.find("base: its density"), std::string::npos) << error;
}

TEST(FabricBase, HasNoSprings) {
  EXPECT_THROW(scene_with("{ base = \"denim\", spring_bend = 1 }"), InputError);
}

}  // namespace
}  // namespace weft::engine
