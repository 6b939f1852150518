/// The folder of a run: its files hold the frames of the run, and replace those of an earlier run as a whole.

#include "weft/run/run_folder.h"

#include <gtest/gtest.h>

#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <set>

#include "tests/read_text.h"
#include "tests/run/shipped.h"
#include "weft/error.h"
#include "weft/io/pc2.h"
#include "weft/run/film.h"
#include "weft/scene/scene_access.h"

namespace weft::engine {
namespace {

namespace fs = std::filesystem;

class RunFolder : public testing::Test {
 protected:
  void SetUp() override { fs::remove_all(folder_); }

  /// Two small sheets that fall on a ball.
  static SceneDesc sheets() {
    return shipped("two_layers", {"cloth[0].grid.cells=[6, 6]", "cloth[1].grid.cells=[8, 6]"});
  }

  RunOptions options(int frames) const { return {.frames = frames, .folder = folder_.string()}; }

  nlohmann::json list() const { return nlohmann::json::parse(read_text(folder_ / "run.json")); }

  /// Contents of all files.
  std::map<std::string, std::string> contents() const {
    std::map<std::string, std::string> files;
    for (const auto& entry : fs::recursive_directory_iterator(folder_)) {
      const std::string name = entry.path().lexically_relative(folder_).generic_string();
      files[name] = entry.is_directory() ? "" : read_text(entry.path());
    }
    return files;
  }

  std::set<std::string> names() const {
    std::set<std::string> names;
    for (const auto& [name, content] : contents()) names.insert(name);
    return names;
  }

  const fs::path folder_ =
      fs::path(WEFT_OUTPUT_DIR) / testing::UnitTest::GetInstance()->current_test_info()->name();
};

TEST_F(RunFolder, HasTheListedFiles) {
  const FinishedRun run = run_to_folder(sheets(), options(3));
  EXPECT_EQ(names(), (std::set<std::string>{"animation.glb", "lower_sheet.pc2", "report.json", "run.json",
                                            "upper_sheet.pc2"}));
  EXPECT_EQ(run.files.size(), 5u);
  EXPECT_EQ(run.files.back(), folder_ / "run.json");
  const nlohmann::json expected = {
      {"format", 1},
      {"weft", run.report.version},
      {"scene", "two_layers"},
      {"fps", 60.0},
      {"frames", 3},
      {"cloths",
       {{{"name", "lower sheet"}, {"positions", "lower_sheet.pc2"}, {"vertices", 49}, {"particles", 49}},
        {{"name", "upper sheet"}, {"positions", "upper_sheet.pc2"}, {"vertices", 63}, {"particles", 63}}}},
      {"animation", "animation.glb"},
      {"report", "report.json"}};
  EXPECT_EQ(list(), expected);
  EXPECT_EQ(fs::file_size(folder_ / "lower_sheet.pc2"), 32u + 4 * 12 * 49);
  EXPECT_EQ(fs::file_size(folder_ / "upper_sheet.pc2"), 32u + 4 * 12 * 63);
  EXPECT_EQ(read_text(folder_ / "report.json"), to_json(run.report));
}

/// Keeps the positions at the end of the run.
struct EndPositions : FrameSink {
  void begin(SceneRun&, RunReport&) override {}
  void add_frame(const SceneRun&, RunReport&) override {}
  void finish(const SceneRun& run, RunReport&) override {
    for (int c = 0; c < run.world().num_cloths(); ++c)
      positions.push_back(positions_of(run.world().state(run.world().cloth(c))));
  }

  std::vector<std::vector<Vec3>> positions;
};

TEST_F(RunFolder, PointCachesHaveThePositionsOfTheRun) {
  FilmSink film;
  EndPositions end;
  run_to_folder(sheets(), options(4), {&film, &end});
  for (std::size_t c = 0; c < 2; ++c) {
    const PointCache cache = read_pc2(folder_ / list()["cloths"][c]["positions"].get<std::string>());
    EXPECT_EQ(cache.frames, film.animation().cloths[c].frames);
    const std::vector<float>& last = cache.frames.back();
    ASSERT_EQ(last.size(), 3 * end.positions[c].size());
    for (std::size_t k = 0; k < last.size(); ++k)
      EXPECT_EQ(last[k], static_cast<float>(end.positions[c][k / 3][static_cast<int>(k % 3)]));
  }
}

TEST_F(RunFolder, PointCachesHaveTheVerticesOfTheMeshFile) {
  fs::create_directories(folder_);
  const fs::path file = folder_ / "two_panels.obj";
  std::ofstream(file) << "v 0 1 0\nv 1 1 0\nv 1 1 1\nv 0 1 1\nv 5 5 5\n"  // the fifth has no triangle
                         "v 1 1 0\nv 2 1 0\nv 2 1 1\nv 1 1 1\n"
                         "f 1 4 3 2\nf 6 9 8 7\n";
  SceneDesc scene = sheets();
  scene.cloths.resize(1);
  scene.cloths[0].shape = MeshSource{.file = file, .weld = true};
  scene.cloths[0].position = {0, 0.5, 0};
  run_to_folder(scene, options(6));
  EXPECT_EQ(list()["cloths"][0]["vertices"], 9);
  EXPECT_EQ(list()["cloths"][0]["particles"], 6);
  const PointCache cache = read_pc2(folder_ / list()["cloths"][0]["positions"].get<std::string>());
  ASSERT_EQ(cache.num_points, 9);
  const auto point = [&](std::size_t frame, int v) {
    return Vec3(cache.frames[frame][3 * v], cache.frames[frame][3 * v + 1], cache.frames[frame][3 * v + 2]);
  };
  EXPECT_EQ(point(0, 0), Vec3(0, 1.5, 0));
  EXPECT_EQ(point(0, 6), Vec3(2, 1.5, 0));
  for (std::size_t frame = 0; frame <= 6; ++frame) {
    EXPECT_EQ(point(frame, 1), point(frame, 5)) << "welded";
    EXPECT_EQ(point(frame, 2), point(frame, 8)) << "welded";
    EXPECT_EQ(point(frame, 4), Vec3(5, 5.5, 5)) << "where it rested";
  }
  EXPECT_LT(point(6, 0).y(), 1.5) << "it falls";
}

TEST_F(RunFolder, EarlierResultsStayWhenARunThrows) {
  run_to_folder(sheets(), options(2));
  const auto before = contents();
  RunOptions all = options(3);
  all.obj = true;
  EXPECT_THROW(run_to_folder(sheets(), all, {},
                             [](const Progress& p) {
                               return p.frame < 2 ? true : throw InputError("stopped by the caller");
                             }),
               InputError);
  EXPECT_EQ(contents(), before) << "and nothing is left aside";
}

TEST_F(RunFolder, UnwritablePointCacheIsRefusedBeforeTheFirstStep) {
  fs::create_directories(folder_ / "lower_sheet.pc2");
  int num_frames = 0;
  EXPECT_THROW(run_to_folder(sheets(), options(3), {}, [&](const Progress&) { return ++num_frames > 0; }),
               InputError);
  EXPECT_EQ(num_frames, 0);
}

TEST_F(RunFolder, FilesOfTheEarlierRunAreRemoved) {
  run_to_folder(sheets(), options(1));
  std::ofstream(folder_ / "mine.pc2") << "not of a run";
  SceneDesc renamed = sheets();
  renamed.cloths[0].name = "sail";
  run_to_folder(renamed, options(1));
  EXPECT_EQ(names(), (std::set<std::string>{"animation.glb", "mine.pc2", "report.json", "run.json",
                                            "sail.pc2", "upper_sheet.pc2"}));
  RunOptions none = options(1);
  none.pc2 = none.glb = false;
  EXPECT_EQ(run_to_folder(renamed, none).files.size(), 2u);
  EXPECT_EQ(names(), (std::set<std::string>{"mine.pc2", "report.json", "run.json"}));
  EXPECT_TRUE(list()["cloths"][0]["positions"].is_null());
  EXPECT_TRUE(list()["animation"].is_null());
}

TEST_F(RunFolder, ForgedListRemovesNothing) {
  fs::create_directories(folder_ / "inner");
  for (const char* name : {"outside.pc2", "inner/deep.pc2", "notes.txt"})
    std::ofstream(folder_ / name) << "!";
  const fs::path absolute = fs::absolute(folder_ / "outside.pc2");
  for (const std::string& cloths :
       {std::string(R"([{"positions": "inner/deep.pc2"}, {"positions": "notes.txt"}, {"positions": 7}, 8])"),
        R"([{"positions": ")" + absolute.string() + R"("}])", std::string("7"), std::string("]")}) {
    std::ofstream(folder_ / "run.json") << R"({"cloths": )" << cloths << "}";
    run_to_folder(sheets(), options(1));
    for (const char* name : {"outside.pc2", "inner/deep.pc2", "notes.txt"})
      EXPECT_EQ(read_text(folder_ / name), "!") << cloths;
  }
}

TEST_F(RunFolder, FailedRunHasTheFramesBeforeTheFailure) {
  const SceneDesc scene =
      shipped("paper/fig3_horizontal_real", {"solver.integrator=explicit", "solver.explicit.substeps=1"});
  const FinishedRun run = run_to_folder(scene, options(200));
  EXPECT_EQ(run.report.outcome, RunOutcome::failed);
  EXPECT_EQ(list()["frames"], run.report.frames);
  const PointCache cache = read_pc2(folder_ / list()["cloths"][0]["positions"].get<std::string>());
  EXPECT_EQ(cache.frames.size(), static_cast<std::size_t>(run.report.frames) + 1);
}

TEST_F(RunFolder, InterruptedFrameIsLeftOut) {
  SceneDesc scene = sheets();
  scene.steps_per_frame = 4;
  RunOptions some = options(5);
  int num_asked = 0;  // three times in a frame of four steps
  some.keep_going = [&] { return ++num_asked < 5; };
  const FinishedRun run = run_to_folder(scene, some);
  EXPECT_EQ(num_asked, 5) << "the second step of the second frame is the last one";
  EXPECT_EQ(run.report.outcome, RunOutcome::interrupted);
  EXPECT_EQ(run.report.frames, 1);
  EXPECT_EQ(run.report.lowest_y.size(), 1u);
  EXPECT_EQ(run.report.divisions.size(), 1u);
  EXPECT_EQ(read_pc2(folder_ / "lower_sheet.pc2").frames.size(), 2u);
}

TEST_F(RunFolder, PublicRunIsTheSameRun) {
  const std::string file = WEFT_SOURCE_DIR "/scenes/two_layers.toml";
  const Scene scene = Scene::load(file, {"cloth[0].grid.cells=[6, 6]", "cloth[1].grid.cells=[8, 6]"});
  std::vector<int> frames;
  const RunResult result =
      weft::run(scene, {.frames = 3, .folder = folder_.string()}, [&](const Progress& p) {
        frames.push_back(p.frame);
        return true;
      });
  EXPECT_EQ(frames, (std::vector<int>{1, 2, 3}));
  const RunReport report = run_scene(SceneAccess::desc(scene), {.frames = 3});
  EXPECT_EQ(result.outcome, RunOutcome::done);
  EXPECT_EQ(result.state_hash, report.state_hash);
  EXPECT_EQ(result.problems.size(), report.problems.size());
  EXPECT_EQ(result.report, read_text(folder_ / "report.json"));
  EXPECT_EQ(result.files.size(), 5u);
  for (const std::string& written : result.files) EXPECT_TRUE(fs::exists(written)) << written;
}

TEST_F(RunFolder, PublicRunWithoutAFolderWritesNothing) {
  fs::create_directories(folder_);
  const fs::path old = fs::current_path();
  fs::current_path(folder_);
  const Scene scene = Scene::load(WEFT_SOURCE_DIR "/scenes/two_layers.toml", {"cloth[0].grid.cells=[6, 6]"});
  const RunResult result = weft::run(scene, {.frames = 5}, [](const Progress& p) { return p.frame < 2; });
  fs::current_path(old);
  EXPECT_EQ(result.outcome, RunOutcome::interrupted);
  EXPECT_EQ(nlohmann::json::parse(result.report)["frames"], 2);
  EXPECT_TRUE(result.files.empty());
  EXPECT_TRUE(fs::is_empty(folder_));
}

TEST_F(RunFolder, PublicRunRefusesCountsBelowOne) {
  const Scene scene = Scene::load(WEFT_SOURCE_DIR "/scenes/two_layers.toml");
  EXPECT_THROW(weft::run(scene, {.frames = 0}), InputError);
  EXPECT_THROW(weft::run(scene, {.frames = 1, .threads = 0}), InputError);
  EXPECT_THROW(weft::run(scene, {.frames = 1, .checkpoint_seconds = -1}), InputError);
  EXPECT_THROW(weft::run(scene, {.frames = 1, .checkpoint_every = 0}), InputError);
}

}  // namespace
}  // namespace weft::engine
