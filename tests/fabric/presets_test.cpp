/// The named fabrics.

#include "weft/fabric.h"

#include <gtest/gtest.h>

#include <set>

#include "weft/error.h"

namespace weft::engine {
namespace {

std::string complaint(std::string_view name) {
  try {
    find_fabric_preset(name);
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

TEST(Presets, AreFifteenPossibleFabricsWithASourceForEachNumber) {
  std::set<std::string> names;
  for (const FabricPreset& preset : fabric_presets()) {
    EXPECT_TRUE(find_mistakes(preset.fabric).empty()) << preset.name;
    EXPECT_TRUE(names.insert(preset.name).second) << preset.name;
    const FabricSources& s = preset.sources;
    for (const std::string& source :
         {s.density, s.stretch, s.shear, s.bending, s.damping, s.thickness, s.friction}) {
      EXPECT_FALSE(source.empty()) << preset.name;
    }
  }
  EXPECT_EQ(names.size(), 15u);
}

TEST(Presets, AreWithinWhatRealFabricsAre) {
  // 5 and 95 % quantiles of 618 fabrics (Feng et al. 2022): density 0.030 and 0.494 kg/m², bending along warp
  // 1.1e-6 and 116e-6 N·m; leather is a little heavier.
  for (const FabricPreset& preset : fabric_presets()) {
    EXPECT_GT(preset.fabric.density, 0.03) << preset.name;
    EXPECT_LT(preset.fabric.density, 0.55) << preset.name;
    EXPECT_GT(preset.fabric.bend_warp, 1.1e-6) << preset.name;
    EXPECT_LT(preset.fabric.bend_warp, 116e-6) << preset.name;
  }
}

TEST(Presets, HoldTheMeasuredNumbers) {
  const Fabric& denim = find_fabric("11oz_black_denim");
  EXPECT_EQ(denim.density, 0.324);
  EXPECT_EQ(denim.c11, 410.7);
  EXPECT_EQ(denim.c22, 2027.8);
  EXPECT_EQ(denim.c12, 20.5);
  EXPECT_EQ(denim.g, 53.4);
  EXPECT_EQ(denim.bend_warp, 1e-6 * 16.05);
  EXPECT_EQ(denim.bend_bias, 1e-6 * 18.35);
  EXPECT_EQ(denim.bend_weft, 1e-6 * 24.24);
  EXPECT_EQ(find_fabric("gray_interlock").c12, -29.4);
}

TEST(Presets, NavySweaterIsMadePositiveDefiniteAndSaysSo) {
  const FabricPreset& navy = find_fabric_preset("navy_sparkle_sweat");
  EXPECT_EQ(navy.fabric.c12, 0);
  EXPECT_NE(navy.sources.stretch.find("-39.8"), std::string::npos);
}

TEST(Presets, NamesMayBeWrittenWithHyphensSpacesAndCapitals) {
  EXPECT_EQ(find_fabric_preset("Cotton Shirting").name, "cotton_shirting");
  EXPECT_EQ(find_fabric_preset("gray-interlock").name, "gray_interlock");
}

TEST(Presets, UnknownNameIsAnsweredWithTheNearestOne) {
  EXPECT_EQ(complaint("denin"), "unknown fabric \"denin\"; did you mean \"denim\"?");
  EXPECT_EQ(complaint("chain mail").find("unknown fabric \"chain mail\"; available: silk, cotton_shirting"),
            0u);
}

}  // namespace
}  // namespace weft::engine
