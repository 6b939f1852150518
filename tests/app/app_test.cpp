/// The command line program from a shell: exit codes, output and files.

#include <algorithm>
#include <regex>
#include <set>
#include <sstream>
#include <string>
#include <thread>

#include "tests/app/background.h"
#include "tests/app/program.h"
#include "weft/error.h"
#include "weft/io/animation.h"
#include "weft/io/glb_writer.h"
#include "weft/io/mdd.h"
#include "weft/io/mesh_files.h"
#include "weft/io/obj_reader.h"
#include "weft/io/pc2.h"

namespace weft::engine {
namespace {

const fs::path kShippedScenes = WEFT_SOURCE_DIR "/scenes";
const fs::path kBrokenScenes = WEFT_SOURCE_DIR "/tests/scene/broken";

TEST_F(App, RunWritesAnimationAndReport) {
  const Finished done = shell("weft run paper/fig6_ball --frames 3 --out results");
  EXPECT_EQ(done.exit_code, 0) << done.err;
  EXPECT_EQ(done.err, "") << "no bar where there is no terminal";
  for (const char* file : {"results/animation.glb", "results/cloth.pc2", "results/cloth.mesh.obj",
                           "results/as_run", "results/report.json", "results/run.json"})
    EXPECT_TRUE(contains(done.out, file)) << done.out;
  EXPECT_EQ(read_text("results/animation.glb").substr(0, 4), "glTF");
  const nlohmann::json report = read_json("results/report.json");
  EXPECT_EQ(report["scene"], "paper/fig6_ball");
  EXPECT_EQ(report["outcome"], "done");
  EXPECT_EQ(report["frames"], 3);
  const nlohmann::json run = read_json("results/run.json");
  EXPECT_EQ(run["frames"], 3);
  EXPECT_EQ(run["cloths"][0]["positions"], "cloth.pc2");
  EXPECT_EQ(run["cloths"][0]["mesh"], "cloth.mesh.obj");
  EXPECT_EQ(read_pc2("results/cloth.pc2").frames.size(), 4u);
}

TEST_F(App, RunTakesAFileAndWritesIntoOutAndTheScenesName) {
  fs::copy_file(kShippedScenes / "paper/fig6_ball.toml", "mine.toml");
  EXPECT_EQ(shell("weft run mine.toml --frames 1").exit_code, 0);
  EXPECT_TRUE(fs::exists("out/mine/animation.glb"));
  EXPECT_TRUE(fs::exists("out/mine/report.json"));
}

TEST_F(App, RunReplacesTheFilesOfAnEarlierRun) {
  fs::create_directories("results");
  for (const char* file : {"results/animation.glb", "results/report.json", "results/notes.txt"}) {
    std::ofstream(file) << "written before";
  }
  EXPECT_EQ(shell("weft run paper/fig6_ball --frames 1 --out results").exit_code, 0);
  EXPECT_EQ(read_text("results/animation.glb").substr(0, 4), "glTF");
  EXPECT_EQ(read_json("results/report.json")["frames"], 1);
  EXPECT_EQ(read_text("results/notes.txt"), "written before") << "what is not Weft's is left alone";
}

TEST_F(App, BadInputLeavesTheFilesOfAnEarlierRun) {
  fs::create_directories("results");
  for (const char* file : {"results/animation.glb", "results/report.json"})
    std::ofstream(file) << "written before";
  expect_bad_input("weft run paper/fig6_ball --out results --set solver.integrator=magic", "magic");
  expect_bad_input("weft run paper/fig6_ball --out results --report no/such/folder.json",
                   "no/such/folder.json");
  EXPECT_EQ(read_text("results/animation.glb"), "written before");
  EXPECT_EQ(read_text("results/report.json"), "written before");
}

TEST_F(App, ReportOptionWritesTheReportOnceMore) {
  EXPECT_EQ(shell("weft run paper/fig6_ball --frames 1 --out results --report results/copy.json").exit_code,
            0);
  EXPECT_EQ(read_text("results/copy.json"), read_text("results/report.json"));
  EXPECT_EQ(shell("weft run paper/fig6_ball --frames 1 --report /dev/stdout | grep -c state_hash").out,
            "1\n");
  // Here standard output is a file.
  const Finished both = shell("weft run paper/fig6_ball --frames 1 --out results --report /dev/stdout");
  const std::string report = read_text("results/report.json");
  EXPECT_EQ(both.out.substr(0, report.size()), report);
  EXPECT_TRUE(contains(both.out.substr(report.size()), "written "));
}

TEST_F(App, ReportThatCannotBeWrittenLosesNothing) {
  const Finished done = shell("weft run paper/fig6_ball --frames 1 --out results --report /dev/full");
  EXPECT_EQ(done.exit_code, 2);
  EXPECT_EQ(done.err, "/dev/full cannot be written: No space left on device\n");
  EXPECT_EQ(read_json("results/report.json")["frames"], 1);
  EXPECT_EQ(read_text("results/animation.glb").substr(0, 4), "glTF");
}

TEST_F(App, ResultsThatCannotBeWrittenLeaveTheFilesOfAnEarlierRun) {
  fs::create_directories("results");
  for (const char* file : {"results/animation.glb", "results/report.json"})
    std::ofstream(file) << "written before";
  const Finished done = shell("ulimit -f 16; weft run paper/fig6_ball --frames 3 --out results");
  EXPECT_EQ(done.exit_code, 2);
  EXPECT_EQ(done.err, "results/animation.glb cannot be written: File too large\n");
  EXPECT_EQ(read_text("results/animation.glb"), "written before");
  EXPECT_EQ(read_text("results/report.json"), "written before");
  EXPECT_EQ(shell("ulimit -f 128; weft run paper/fig6_ball --frames 12 --out results --no-glb").err,
            "results/cloth.pc2 cannot be written: File too large\n");
  EXPECT_EQ(read_text("results/animation.glb"), "written before");
  EXPECT_EQ(std::distance(fs::directory_iterator("results"), {}), 2) << "nothing is left aside";
}

TEST_F(App, AuditSaysWhatEnergyIsLeftOver) {
  const Finished audited = shell("weft run paper/fig6_ball --frames 2 --out audited --audit");
  EXPECT_EQ(audited.exit_code, 0) << audited.err;
  EXPECT_TRUE(contains(audited.out, "  audit        ")) << audited.out;
  EXPECT_EQ(read_json("audited/report.json")["energy"]["left_over"].size(), 2u);
  EXPECT_FALSE(contains(shell("weft run paper/fig6_ball --frames 2 --out plain").out, "  audit "));
  EXPECT_EQ(read_json("plain/report.json")["state_hash"], read_json("audited/report.json")["state_hash"]);
}

TEST_F(App, RunNamesProblemsLastAndFailsForThemWhereStrict) {
  const std::string run =
      "weft run contact/ball_and_floor --frames 40 --set 'cloth[0].grid.cells=[16,16]' --set solver.contact=";
  const Finished through = shell(run + "false");
  EXPECT_EQ(through.exit_code, 0) << through.err;
  EXPECT_TRUE(contains(through.out, "problem: cloth \"cloth\": ")) << through.out;
  EXPECT_TRUE(contains(through.out, "inside collider \"")) << through.out;
  EXPECT_TRUE(contains(through.out, "set solver.contact = true (penetration")) << through.out;
  EXPECT_EQ(shell(run + "false --strict").exit_code, 1);
  const Finished lies = shell(run + "true --strict");
  EXPECT_EQ(lies.exit_code, 0) << lies.out;
  EXPECT_FALSE(contains(lies.out, "problem:")) << lies.out;
}

TEST_F(App, SetChangesValuesOfTheScene) {
  EXPECT_EQ(shell("weft run paper/fig6_ball --frames 1 --out results --set solver.integrator=explicit "
                  "--set cloth[0].grid.cells='[4, 4]'")
                .exit_code,
            0);
  EXPECT_EQ(read_json("results/report.json")["integrator"], "explicit");
  EXPECT_EQ(read_json("results/report.json")["particles"], 25);
}

TEST_F(App, FabricsListsNamesAndShowsOne) {
  const Finished list = shell("weft fabrics");
  EXPECT_EQ(list.exit_code, 0);
  EXPECT_TRUE(contains(list.out, "silk "));
  EXPECT_TRUE(contains(list.out, "11oz_black_denim "));
  const Finished denim = shell("weft fabrics 11oz_black_denim");
  EXPECT_TRUE(contains(denim.out, "c11       = 410.7      # [N/m] measured: Wang, O'Brien")) << denim.out;
  expect_bad_input("weft fabrics slik", "did you mean \"silk\"?");
}

TEST_F(App, FabricsPrintsJsonWithUnitsAndSources) {
  ASSERT_EQ(shell("weft fabrics gray-interlock --json > one.json; weft fabrics --json > all.json").exit_code,
            0);
  const nlohmann::json one = read_json("one.json");
  EXPECT_EQ(one["c12"], -29.4);
  EXPECT_EQ(one["units"]["bend_warp"], "N·m");
  EXPECT_TRUE(one["sources"]["g"].is_string());
  EXPECT_EQ(read_json("all.json")["fabrics"].size(), 15u);
}

TEST_F(App, FabricThatIsShownIsAFabricFile) {
  ASSERT_EQ(
      shell("weft fabrics wool_suiting > wool.toml && weft fabrics wool.toml --json > wool.json").exit_code,
      0);
  EXPECT_EQ(read_json("wool.json")["c11"], 1225.0);
}

TEST_F(App, ThreadsDoNotChangeTheResult) {
  EXPECT_EQ(
      shell("for t in 1 2; do weft run paper/fig6_ball --frames 2 --threads $t --out $t; done").exit_code, 0);
  EXPECT_EQ(read_json("1/report.json")["state_hash"], read_json("2/report.json")["state_hash"]);
  EXPECT_EQ(read_json("2/report.json")["threads"], 2);
}

TEST_F(App, FailedSimulationExitsWithOneAndSaysWhichClothWhenAndWhy) {
  const Finished done = shell(
      "weft run paper/fig3_horizontal_real --out results --set cloth[0].name=sail "
      "--set solver.integrator=explicit --set solver.explicit.substeps=1");
  EXPECT_EQ(done.exit_code, 1) << done.err;
  const std::regex expected("failed at frame [0-9]+, cloth \"sail\": .*solver\\.explicit\\.substeps");
  EXPECT_TRUE(std::regex_search(done.out, expected)) << done.out;
  EXPECT_EQ(read_json("results/report.json")["outcome"], "failed");
  EXPECT_TRUE(fs::exists("results/animation.glb")) << "what was done before it failed is kept";
}

TEST_F(App, BadInputExitsWithTwoAndTellsWhatWasExpected) {
  const std::string broken = (kBrokenScenes / "typo_in_table_name.toml").string();
  expect_bad_input("weft run '" + broken + "'",
                   broken + ":5:3: unknown key \"cloht\"; did you mean \"cloth\"?");
  expect_bad_input("weft run paper/fig6_bal", "did you mean \"paper/fig6_ball\"?");
  expect_bad_input("weft run .", "no scene file");
  expect_bad_input("weft run", "SCENE");
  expect_bad_input("weft run paper/fig6_ball --fraims 3", "--fraims");
  expect_bad_input("weft run paper/fig6_ball --frames 0", "--frames");
  expect_bad_input("weft run paper/fig6_ball --frames many", "--frames");
  expect_bad_input("weft run", "SCENE");
  expect_bad_input("weft run --resume no/such/run", "no/such/run has no unfinished run to resume");
  expect_bad_input("weft run --resume no/such/run --frames 3", "--frames requires SCENE");
  expect_bad_input("weft run --resume no/such/run --set scene.fps=30", "--set requires SCENE");
  expect_bad_input("weft run paper/fig6_ball --threads 0", "--threads");
  expect_bad_input("weft run paper/fig6_ball --set solver", "expected path.to.key=value");
  expect_bad_input("weft run paper/fig6_ball --set solver.integratr=paper", "did you mean \"integrator\"?");
  expect_bad_input("weft", "--help");
  expect_bad_input("weft fly", "weft has no command \"fly\"; available: run, demo, ");
  expect_bad_input("weft rnu garment", "weft has no command \"rnu\"; did you mean \"run\"?");
  expect_bad_input("WEFT_SCENES=no/such/folder weft scenes", "no/such/folder");
}

TEST_F(App, UnwritablePlacesAreRefusedBeforeSimulating) {
  std::ofstream("file") << "not a folder";
  fs::create_directories("results/animation.glb/folder");
  // A million frames take hours. /proc is a folder that nobody can write to, including root.
  const std::string run = "timeout 60 '" WEFT_PROGRAM "' run paper/fig6_ball --frames 1000000 ";
  expect_bad_input(run + "--out file", "cannot create folder file: Not a directory");
  expect_bad_input(run + "--out file/results", "cannot create folder file/results: Not a directory");
  expect_bad_input(run + "--out /proc", "cannot create folder /proc/unfinished: ");
  expect_bad_input(run + "--out results", "results/animation.glb cannot be written: Is a directory");
  expect_bad_input(run + "--report no/such/report.json",
                   "no/such/report.json cannot be written: No such file");
  EXPECT_EQ(read_text("file"), "not a folder");
}

TEST_F(App, ConvertsMeshesAndPointCaches) {
  const std::string shirt = WEFT_SOURCE_DIR "/scenes/garments/tshirt.obj";
  EXPECT_EQ(shell("weft convert '" + shirt + "' out/tshirt.ply").out, "out/tshirt.ply\n");
  EXPECT_EQ(shell("weft convert out/tshirt.ply out/again.obj").exit_code, 0);
  const MeshFromFile obj = read_obj(shirt), ply = read_mesh("out/tshirt.ply"),
                     again = read_obj("out/again.obj");
  for (const MeshFromFile* read : {&ply, &again}) {
    EXPECT_EQ(read->mesh.positions, obj.mesh.positions);
    EXPECT_EQ(read->mesh.triangles, obj.mesh.triangles);
    EXPECT_EQ(read->uv, obj.uv);
  }
  EXPECT_TRUE(contains(shell("weft convert '" + shirt + "' big.obj --scale 1000").err, "m large; --scale"));

  shell("weft run two_layers --frames 3 --out run");
  EXPECT_EQ(shell("weft convert run out/two.mdd").out, "out/two_lower_sheet.mdd\nout/two_upper_sheet.mdd\n");
  const MddCache mdd = read_mdd("out/two_upper_sheet.mdd");
  const PointCache pc2 = read_pc2("run/upper_sheet.pc2");
  EXPECT_EQ(mdd.frames, pc2.frames);
  ASSERT_EQ(mdd.times.size(), 4u);
  EXPECT_EQ(mdd.times[3], 3 / 60.0f);
  EXPECT_EQ(shell("weft convert out/two_upper_sheet.mdd part.pc2 --frames 1:2 --up z").exit_code, 0);
  const PointCache part = read_pc2("part.pc2");
  ASSERT_EQ(part.frames.size(), 2u);
  EXPECT_EQ(part.frames[0][1], pc2.frames[1][2]);
  EXPECT_EQ(part.frames[0][2], -pc2.frames[1][1]);
  const Finished guessed = shell("weft convert part.pc2 part.mdd");
  EXPECT_TRUE(contains(guessed.err, "part.pc2 does not say its frames per second: 60 (--fps)"))
      << guessed.err;

  expect_bad_input("weft convert part.pc2 part.mdd --frames 1:2", "has the frames 0 to 1; it has not 1 to 2");
  expect_bad_input("weft convert part.pc2 part.mdd --frames 1-2", "expected FIRST:LAST");
  EXPECT_EQ(shell("weft convert run sheets.obj --frames 3:3").out,
            "sheets_lower_sheet_0003.obj\nsheets_upper_sheet_0003.obj\n");
  EXPECT_EQ(
      shell("weft convert run/upper_sheet.pc2 upper.ply --frames 3: --mesh run/upper_sheet.mesh.obj").out,
      "upper_0003.ply\n");
  EXPECT_EQ(read_mesh("upper_0003.ply").mesh.positions,
            read_obj("sheets_upper_sheet_0003.obj").mesh.positions);
  expect_bad_input("weft convert part.pc2 part.obj", "--mesh names the mesh of its points");
  expect_bad_input("weft convert part.pc2 part.fbx", "a point cache is written as .pc2 or .mdd");
  expect_bad_input("weft convert '" + shirt + "' shirt.fbx", "a mesh is written as .obj or .ply");
  expect_bad_input("weft convert run run.usdc", "USD files are converted by `python -m weft convert`");
  expect_bad_input("weft convert out out.mdd", "out holds no run: there is no run.json");
}

/// Waits until a run in the background has made a frame of its first cloth.
void wait_for_frame(const fs::path& folder) {
  for (int attempt = 0; attempt < 10000; ++attempt) {
    try {
      if (read_pc2(folder / "unfinished/cloth.pc2").frames.size() > 1) return;
    } catch (const InputError&) {  // not there yet
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  }
  ADD_FAILURE() << "no frame";
}

TEST_F(App, SignalsThatEndProgramsKeepWhatWasDone) {
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) {
    Background run({"run", "paper/fig6_ball", "--frames", "1000000", "--out", "results"});
    ASSERT_TRUE(run.catches(SIGTERM));
    wait_for_frame("results");
    run.send(signal);
    EXPECT_EQ(run.wait(), 130) << signal;
    EXPECT_TRUE(contains(read_text("background.txt"), "interrupted: partial results kept"));
    EXPECT_EQ(read_text("results/animation.glb").substr(0, 4), "glTF");
    const nlohmann::json report = read_json("results/report.json");
    EXPECT_EQ(report["outcome"], "interrupted");
    EXPECT_GT(report["frames"], 0);
    EXPECT_EQ(report["lowest_y"].size(), report["frames"]);
    EXPECT_EQ(read_json("results/run.json")["frames"], report["frames"]);
    fs::remove_all("results");
  }
}

TEST_F(App, SignalSentTwiceInARowCountsOnce) {
  Background run({"run", "paper/fig6_ball", "--frames", "1000000", "--out", "results"});
  ASSERT_TRUE(run.catches(SIGTERM));
  run.send(SIGTERM);
  run.send(SIGHUP);
  EXPECT_EQ(run.wait(), 130);
  EXPECT_EQ(read_json("results/report.json")["outcome"], "interrupted");
}

TEST_F(App, SignalEndsTheDemo) {
  Background demo({"demo", "--out", "results"});
  ASSERT_TRUE(demo.catches(SIGTERM));
  demo.send(SIGTERM);
  EXPECT_EQ(demo.wait(), 130);
  EXPECT_TRUE(contains(read_text("background.txt"), "ms/frame"));
  EXPECT_FALSE(fs::exists("results/paper/fig6_ball_real")) << "the scenes that follow are left alone";
}

TEST_F(App, IgnoredHangupStaysIgnored) {
  Background run({"run", "paper/fig6_ball", "--frames", "20", "--out", "results"}, SIG_IGN);
  ASSERT_TRUE(run.catches(SIGTERM));
  run.send(SIGHUP);
  EXPECT_EQ(run.wait(), 0);
  EXPECT_EQ(read_json("results/report.json")["frames"], 20);
}

TEST_F(App, KilledRunLeavesTheFilesOfAnEarlierRun) {
  ASSERT_EQ(shell("weft run paper/fig6_ball --frames 2 --out results").exit_code, 0);
  const std::string animation = read_text("results/animation.glb"), report = read_text("results/report.json");
  Background run({"run", "paper/fig6_ball", "--frames", "1000000", "--out", "results"});
  ASSERT_TRUE(run.catches(SIGTERM)) << "it simulates";
  run.send(SIGKILL);
  EXPECT_EQ(run.wait(), -1);
  EXPECT_EQ(read_text("results/animation.glb"), animation);
  EXPECT_EQ(read_text("results/report.json"), report);
}

TEST_F(App, StandardOutputThatCannotBeWrittenIsAnError) {
  for (const std::string command :
       {"weft scenes", "weft check --keys", "weft --help", "weft run --help", "weft --version"}) {
    for (const std::string where : {" > /dev/full", " >&-"}) {
      const Finished done = shell(command + where);
      EXPECT_EQ(done.exit_code, 2) << command << where;
      EXPECT_TRUE(done.err.starts_with("weft: standard output cannot be written")) << done.err;
      EXPECT_EQ(std::count(done.err.begin(), done.err.end(), '\n'), 1) << command << where << done.err;
    }
  }
  EXPECT_EQ(shell("weft run paper/fig6_ball --frames 1 --out results > /dev/full").exit_code, 2);
  EXPECT_EQ(read_json("results/report.json")["outcome"], "done") << "the results are files";
}

TEST_F(App, StandardErrorThatCannotBeWrittenIsNone) {
  const std::string run = "weft run paper/fig6_ball --frames 1 --threads 1024 --out results ";
  EXPECT_EQ(shell(run + "2> /dev/full").exit_code, 0);
  EXPECT_EQ(shell(run + "2>&-").exit_code, 0);
  EXPECT_EQ(read_text("results/animation.glb").substr(0, 4), "glTF");
  EXPECT_EQ(shell("weft run no/such/scene 2> /dev/full").exit_code, 2);
}

TEST_F(App, ThreadsAreAtMostFourForEachProcessor) {
  const Finished done = shell("weft run paper/fig6_ball --frames 1 --threads 1024 --out results");
  EXPECT_EQ(done.exit_code, 0);
  const int most = std::min(1024, 4 * static_cast<int>(std::max(1u, std::thread::hardware_concurrency())));
  EXPECT_EQ(read_json("results/report.json")["threads"], most);
  if (most == 1024) return;
  EXPECT_EQ(done.err, "--threads 1024: limited to " + std::to_string(most) + ", four per processor\n");
}

TEST_F(App, ScenesListsEverySceneWithItsDescription) {
  std::set<std::string> expected;
  for (const auto& entry : fs::recursive_directory_iterator(kShippedScenes)) {
    if (entry.path().extension() != ".toml") continue;
    expected.insert(entry.path().lexically_relative(kShippedScenes).replace_extension().generic_string());
  }
  ASSERT_GE(expected.size(), 8u);

  const Finished done = shell("weft scenes");
  EXPECT_EQ(done.exit_code, 0) << done.err;
  std::set<std::string> listed;
  std::istringstream lines(done.out);
  for (std::string line; std::getline(lines, line);) {
    std::istringstream words(line);
    std::string name, description;
    words >> name >> description;
    listed.insert(name);
    EXPECT_NE(description, "") << name;
  }
  EXPECT_EQ(listed, expected);
}

TEST_F(App, EarlyEndOfAPipeIsHarmless) {
  const Finished first_line = shell("weft scenes | head -n 1");
  EXPECT_EQ(first_line.exit_code, 0);
  EXPECT_EQ(std::count(first_line.out.begin(), first_line.out.end(), '\n'), 1);
  EXPECT_EQ(first_line.err, "");
  EXPECT_EQ(shell("weft scenes | true").err, "");
  EXPECT_EQ(shell("weft run paper/fig6_ball --frames 1 --out results | true").err, "");
  EXPECT_EQ(read_json("results/report.json")["outcome"], "done");
}

TEST_F(App, CheckFindsEveryShippedSceneGood) {
  const Finished done = shell(
      "for scene in $(weft scenes | cut -d' ' -f1); do weft check $scene || exit 3; done"
      " | grep -v 'funnel.*: has a border'");  // it is open on purpose
  EXPECT_EQ(done.exit_code, 0) << done.err;
  EXPECT_FALSE(contains(done.out, "warning")) << done.out;
}

TEST_F(App, CheckListsEveryMistakeWithItsPlace) {
  const fs::path file = kBrokenScenes / "out_of_range.toml";
  const Finished done = shell("weft check '" + file.string() + "'");
  EXPECT_EQ(done.exit_code, 2);

  const std::string mark = "# error: ";  // the file lists the expected errors
  std::string expected;
  std::istringstream lines(read_text(file));
  for (std::string line; std::getline(lines, line);) {
    if (line.starts_with(mark)) expected += file.string() + ":" + line.substr(mark.size()) + "\n";
  }
  EXPECT_GT(std::count(expected.begin(), expected.end(), '\n'), 10);
  EXPECT_EQ(done.err, expected);
}

TEST_F(App, CheckTakesTheValuesThatARunIsGiven) {
  EXPECT_EQ(shell("weft check paper/fig6_ball --set cloth[0].grid.cells=[4,4]").exit_code, 0);
  expect_bad_input("weft check paper/fig6_ball --set solver.integrator=magic", "magic");
  expect_bad_input("weft check paper/fig6_ball --tolerance 1", "--tolerance");
}

TEST_F(App, TellsItsVersionAndHowToUseIt) {
  EXPECT_EQ(shell("weft --version").out, WEFT_VERSION "\n");
  for (const char* command : {"", "run", "demo", "scenes", "check", "verify"}) {
    const Finished done = shell(std::string("weft ") + command + " --help");
    EXPECT_EQ(done.exit_code, 0) << command;
    EXPECT_TRUE(contains(done.out, "Usage: weft")) << command << done.out;
  }
}

TEST_F(App, VerifyFindsACleanRunClean) {
  EXPECT_EQ(shell("weft run paper/fig3_horizontal --frames 5 --out results").exit_code, 0);
  const Finished done = shell("weft verify results");
  EXPECT_EQ(done.exit_code, 0) << done.out << done.err;
  EXPECT_TRUE(contains(done.out, "6 frames; no intersections")) << done.out;
  EXPECT_TRUE(contains(done.out, "between frames, on linear paths: no tunnelling")) << done.out;
  const std::string of_file = shell("weft verify results/animation.glb").out;
  EXPECT_EQ(of_file.substr(of_file.find(": ")), done.out.substr(done.out.find(": ")));
}

TEST_F(App, VerifyAgreesWithTheReport) {
  EXPECT_EQ(shell("weft run paper/fig6_ball --frames 20 --out results").exit_code, 0);
  EXPECT_EQ(shell("weft verify results --tolerance 0.01").exit_code, 0);
  const Finished done = shell("weft verify results --tolerance 0.01 --json");
  EXPECT_EQ(done.exit_code, 0);
  const auto found = nlohmann::json::parse(done.out), report = read_json("results/report.json");
  EXPECT_EQ(found["frames"], 21) << "the start and twenty more";
  EXPECT_EQ(found["intersections"], report["intersections"]);
  // The file contains floats, and differences of floats: below a millionth of a metre.
  EXPECT_NEAR(found["penetration_max"], report["penetration_max"], 1e-6);
}

TEST_F(App, VerifyFindsPlantedCrossings) {
  weft::engine::Animation animation;
  weft::engine::AnimatedCloth sheet{.name = "sheet", .triangles = {{0, 1, 2}}, .frames = {}};
  sheet.frames.assign(3, {-1, 0, -1, 1, 0, -1, 0, 0, 2});
  weft::engine::AnimatedCloth blade{.name = "blade", .triangles = {{0, 1, 2}}, .frames = {}};
  for (const float tip : {0.1f, 0.1f, -0.1f}) blade.frames.push_back({0, 1, 0, 0.1f, 1, 0, 0, tip, 0.1f});
  animation.cloths = {sheet, blade};
  weft::engine::write_glb("planted.glb", animation);
  const Finished done = shell("weft verify planted.glb");
  EXPECT_EQ(done.exit_code, 1) << done.err;
  EXPECT_TRUE(
      contains(done.out, "3 frames; 1 frame with intersections, at most 1 pair of triangles in frame 2"))
      << done.out;
  EXPECT_TRUE(contains(done.out, "frame 2: cloth \"sheet\" triangle 0 intersects cloth \"blade\" triangle 0"))
      << done.out;
  EXPECT_EQ(shell("weft verify planted.glb --json | grep -c '\"clean\": false'").out, "1\n");
}

TEST_F(App, VerifyTellsWhatMayHavePassedAndFailsWhereAsked) {
  const std::string ribbons =
      "weft run contact/crossed_strips --frames 26 --out results --set solver.contact=false "
      "--set cloth[0].grid.cells=[40,8] --set cloth[1].grid.cells=[8,40]";
  const Finished run = shell(ribbons);
  EXPECT_EQ(run.exit_code, 0) << run.err;
  EXPECT_TRUE(contains(run.out, "crossings    0")) << run.out;
  EXPECT_TRUE(contains(run.out, ", first in frame 2")) << run.out;
  const Finished done = shell("weft verify results");
  EXPECT_EQ(done.exit_code, 0) << done.err;
  EXPECT_TRUE(contains(done.out, "on linear paths: possible tunnelling of ")) << done.out;
  EXPECT_EQ(shell("weft verify results --passages").exit_code, 1);
  EXPECT_EQ(shell(ribbons + " --no-passages").exit_code, 0);
  EXPECT_TRUE(read_json("results/report.json")["passages"].is_null());
}

TEST_F(App, VerifyRefusesWhatIsNoRun) {
  expect_bad_input("weft verify no/such/folder", "no/such/folder");
  fs::create_directories("empty");
  expect_bad_input("weft verify empty", "empty holds no run: there is no run.json");
  std::ofstream("words.glb") << "words";
  expect_bad_input("weft verify words.glb", "words.glb: is not a complete .glb file");
  for (const std::string tolerance : {"nan", "inf", "-1", "deep"})
    expect_bad_input("weft verify words.glb --tolerance=" + tolerance, tolerance + " is not a depth");
}

}  // namespace
}  // namespace weft::engine
