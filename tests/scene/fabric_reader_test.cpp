/// Fabric files, valid and invalid.

#include "weft/scene/fabric_reader.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "tests/own_folder.h"
#include "weft/error.h"

namespace weft::engine {
namespace {

const std::string kDenim =
    "density = 0.324\n"        // line 1
    "c11 = 410.7\n"            // 2
    "c22 = 2027.8\n"           // 3
    "c12 = 20.5\n"             // 4
    "g = 53.4\n"               // 5
    "bend_warp = 16.05e-6\n"   // 6
    "bend_weft = 24.24e-6\n"   // 7
    "bend_bias = 18.35e-6\n";  // 8

/// The file's mistakes, one per line.
std::string mistakes(const std::string& text) {
  try {
    parse_fabric(text, "mine.toml");
  } catch (const SceneError& error) {
    return error.what();
  }
  return "";
}

std::string replaced(std::string text, const std::string& what, const std::string& by) {
  return text.replace(text.find(what), what.size(), by);
}

TEST(FabricFile, GivesEveryNumberAndTheDefaultsOfTheRest) {
  const FabricPreset fabric = parse_fabric(kDenim, "folder/my_denim.toml");
  EXPECT_EQ(fabric.name, "my_denim");
  EXPECT_EQ(fabric.fabric.c22, 2027.8);
  EXPECT_EQ(fabric.fabric.bend_bias, 18.35e-6);
  EXPECT_EQ(fabric.fabric.damping, Fabric().damping);
  EXPECT_EQ(fabric.sources.damping, "default: not given");
  EXPECT_EQ(fabric.sources.shear, "given in folder/my_denim.toml");
}

TEST(FabricFile, TakesTheOptionalKeys) {
  const Fabric f =
      parse_fabric(kDenim +
                       "damping = 0.01\nthickness = 0.0008\nfriction = 0.5\nstrain_limit = 0.01\nstrength = 12000\n"
                       "bend_hysteresis_warp = 0.001\nbend_hysteresis_weft = 0.002\nbend_set = 500\n",
                   "denim.toml")
          .fabric;
  EXPECT_EQ(f.damping, 0.01);
  EXPECT_EQ(f.thickness, 0.0008);
  EXPECT_EQ(f.friction, 0.5);
  EXPECT_EQ(f.strain_limit, 0.01);
  EXPECT_EQ(f.strength, 12000);
  EXPECT_EQ(f.bend_hysteresis_warp, 0.001);
  EXPECT_EQ(f.bend_hysteresis_weft, 0.002);
  EXPECT_EQ(f.bend_set, 500);
}

TEST(FabricFile, TakesStretchCurves) {
  const Fabric f = parse_fabric(kDenim + "stretch_warp = [[0.01, 4], [0.05, 40]]\n", "denim.toml").fabric;
  ASSERT_EQ(f.stretch_warp.size(), 2u);
  EXPECT_EQ(f.stretch_warp[1].strain, 0.05);
  EXPECT_EQ(f.stretch_warp[1].tension, 40);
  EXPECT_TRUE(f.stretch_weft.empty());
}

TEST(FabricFile, RefusesCurvesThatAreNone) {
  const auto warp = [](const std::string& value) { return mistakes(kDenim + "stretch_warp = " + value); };
  EXPECT_NE(warp("3").find("9:16: stretch_warp: expected points of strain and tension"), std::string::npos);
  EXPECT_NE(warp("[[0.01, -4]]").find("9:24: stretch_warp[0][1]: expected a number above 0"),
            std::string::npos);
  EXPECT_NE(warp("[[0.02, 4], [0.01, 9]]").find("must increase from the origin"), std::string::npos);
  EXPECT_NE(warp("[[0.1, 400], [0.2, 401]]").find("is too flat"), std::string::npos);
}

TEST(FabricFile, UnknownKeyIsAnsweredWithTheNearestOne) {
  EXPECT_EQ(mistakes(replaced(kDenim, "bend_weft", "bend_wft")),
            "mine.toml:7:1: unknown key \"bend_wft\"; did you mean \"bend_weft\"?");
}

TEST(FabricFile, MissingKeysAreNamedWithTheirUnits) {
  EXPECT_EQ(mistakes(replaced(kDenim, "g = 53.4\n", "")),
            "mine.toml:1:1: missing key \"g\", expected a number in N/m");
}

TEST(FabricFile, WrongValuesAreReportedAtTheirPlaces) {
  EXPECT_EQ(mistakes(replaced(kDenim, "0.324", "\"0.324 kg/m²\"")),
            "mine.toml:1:11: density: expected a number above 0 in kg/m², found the string \"0.324 kg/m²\"; "
            "values are plain numbers in SI units, without unit and quotes");
  EXPECT_EQ(mistakes(replaced(kDenim, "410.7", "-5")),
            "mine.toml:2:7: c11: expected a number above 0 in N/m, found the number -5");
}

TEST(FabricFile, NumbersThatDoNotGoTogetherAreReportedAtTheOneToChange) {
  EXPECT_EQ(
      mistakes(replaced(kDenim, "c12 = 20.5", "c12 = 1000")),
      "mine.toml:4:7: c12: must be less than √(c11 c22) = 912.6 N/m in magnitude, is 1000: the membrane "
      "is not positive definite, so some stretching would release energy");
  EXPECT_NE(mistakes(replaced(kDenim, "0.324", "30")).find("mine.toml:1:11: density: must be at most 5.67"),
            std::string::npos);
}

TEST(FabricFile, IsPreferredToAPresetAndMissingOnesAreNamed) {
  const std::filesystem::path folder = make_own_folder();
  const std::filesystem::path file = folder / "mine.toml";
  std::ofstream(file) << kDenim;
  EXPECT_EQ(load_fabric(file.string()).fabric.c11, 410.7);
  EXPECT_EQ(load_fabric("silk").name, "silk");
  EXPECT_THROW(load_fabric("no/such/fabric.toml"), SceneError);
  EXPECT_THROW(load_fabric("slik"), InputError);
}

TEST(FabricFile, ThatIsNotTomlIsAMistakeAtItsPlace) {
  EXPECT_NE(mistakes("density 0.3").find("mine.toml:1:"), std::string::npos);
}

}  // namespace
}  // namespace weft::engine
