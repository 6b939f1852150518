/// `weft bench` and `weft study` from a shell: exit codes, output and files.

#include "tests/app/program.h"

namespace weft::engine {
namespace {

class Laboratory : public App {};

TEST_F(Laboratory, StudyPrintsOneJsonObjectAndLeavesPictureAndData) {
  const Finished done = shell("weft study shear --fabric silk --json --out lab");
  EXPECT_EQ(done.exit_code, 0) << done.err;
  const nlohmann::json json = nlohmann::json::parse(done.out);
  EXPECT_NEAR(json["g"].get<double>(), 14, 0.3);
  EXPECT_EQ(json["units"]["g"], "N/m");
  EXPECT_EQ(read_json("lab/study.json"), json);
  EXPECT_EQ(read_text("lab/specimen.png").substr(1, 3), "PNG");
  EXPECT_TRUE(contains(read_text("lab/specimen.obj"), "v "));
  EXPECT_TRUE(contains(shell("weft study cantilever --fabric denim --direction bias").out, "bending_length"));
  expect_bad_input("weft study drape --fabric slik", "did you mean \"silk\"?");
  expect_bad_input("weft study drape", "--fabric");
}

TEST_F(Laboratory, BenchMeasures) {
  const Finished done =
      shell("weft bench integrators --sizes 8 --threads 1 --seconds 0.01 --integrators paper");
  EXPECT_EQ(done.exit_code, 0) << done.err;
  EXPECT_TRUE(contains(done.out, "paper")) << done.out;
}

TEST_F(Laboratory, BenchFrontierWritesItsPointsAndKeepsItsReferences) {
  const std::string command =
      "weft bench frontier --sizes 8 --rings 3 --frames 12 --methods newton,xpbd --cache kept --out results";
  const Finished done = shell(command);
  EXPECT_EQ(done.exit_code, 0) << done.err;
  EXPECT_TRUE(contains(done.out, "sheet 8²: 64 particles")) << done.out;
  EXPECT_TRUE(contains(done.out, "disc of 37, at an error of 0.045 m")) << done.out;
  EXPECT_TRUE(contains(read_text("results/frontier.csv"), "sheet 8²,64,xpbd,\"50 substeps\",")) << done.out;
  EXPECT_TRUE(contains(read_text("results/frontier.svg"), "<title>newton, default</title>"));
  EXPECT_TRUE(contains(done.err, "computing the reference")) << done.err;
  EXPECT_EQ(shell(command).err, "") << "the second time it reads what it has kept";
  expect_bad_input("weft bench frontier --methods magic", "magic");
}

TEST_F(Laboratory, BenchScalingFitsAnExponent) {
  const Finished done = shell("weft bench scaling --sizes 4,8 --threads 1 --steps 2");
  EXPECT_EQ(done.exit_code, 0) << done.err;
  EXPECT_TRUE(contains(done.out, "| 64 |")) << done.out;
  EXPECT_TRUE(contains(done.out, "1 thread: time grows like n^")) << done.out;
}

TEST_F(Laboratory, BenchRandomCountsWhatWentWrong) {
  const Finished done = shell("weft bench random --scenes 5 --first 86 --steps 20");
  EXPECT_EQ(done.exit_code, 0) << done.err;
  EXPECT_TRUE(contains(done.out, "newton, 5 scenes of 20 steps: 0 became infinite")) << done.out;
}

TEST_F(Laboratory, BenchRandomContactWritesAndChecksScenes) {
  const Finished done = shell("weft bench random --contact --scenes 2 --first 2 --steps 5 --out scenes");
  EXPECT_EQ(done.exit_code, 0) << done.err;
  EXPECT_TRUE(contains(done.out, "2 scenes of 5 frames")) << done.out;
  EXPECT_TRUE(contains(done.out, "0 refused; 0 with intersections")) << done.out;
  EXPECT_EQ(shell("weft check scenes/seed_3.toml").exit_code, 0);
}

TEST_F(Laboratory, BenchComparesWaysToFindPairs) {
  const Finished done =
      shell("weft bench collision --sizes 200,1000 --cells 4 --threads 1,2 --seconds 0.001");
  EXPECT_EQ(done.exit_code, 0) << done.out << done.err;
  for (const char* word : {"rest", "folded", "heap", "sheets"})
    EXPECT_TRUE(contains(done.out, word)) << done.out;
  EXPECT_FALSE(contains(done.out, "ERROR")) << done.out;
}

TEST_F(Laboratory, BadInputExitsWithTwoAndTellsWhatWasExpected) {
  expect_bad_input("weft study drpae", "weft study has no command \"drpae\"; did you mean \"drape\"?");
  expect_bad_input("weft bench integrators --integrators magic", "magic");
  expect_bad_input("weft bench integrators --sizes 0", "--sizes");
}

TEST_F(Laboratory, TellsHowToUseIt) {
  for (const char* command : {"bench", "bench integrators", "study", "study drape"}) {
    const Finished done = shell(std::string("weft ") + command + " --help");
    EXPECT_EQ(done.exit_code, 0) << command;
    EXPECT_TRUE(contains(done.out, "Usage: weft")) << command << done.out;
  }
}

}  // namespace
}  // namespace weft::engine
