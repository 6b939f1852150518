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
#include "weft/io.h"
#include "weft/io/mesh_files.h"
#include "weft/io/obj_reader.h"
#include "weft/io/pc2.h"
#include "weft/run/film.h"
#include "weft/run/past_run.h"
#include "weft/scene/scene_access.h"
#include "weft/scene/scene_reader.h"

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
  EXPECT_EQ(names(), (std::set<std::string>{"animation.glb", "as_run", "as_run/scene.toml",
                                            "lower_sheet.mesh.obj", "lower_sheet.pc2", "report.json",
                                            "run.json", "upper_sheet.mesh.obj", "upper_sheet.pc2"}));
  EXPECT_EQ(run.files.size(), 8u);
  EXPECT_EQ(run.files.back(), folder_ / "run.json");
  const nlohmann::json expected = {{"format", 1},
                                   {"weft", run.report.version},
                                   {"scene", "two_layers"},
                                   {"scene_hash", hash_of_scene(sheets())},
                                   {"fps", 60.0},
                                   {"frames", 3},
                                   {"cloths",
                                    {{{"name", "lower sheet"},
                                      {"positions", "lower_sheet.pc2"},
                                      {"mesh", "lower_sheet.mesh.obj"},
                                      {"color", {0.75, 0.6, 0.4}},
                                      {"vertices", 49},
                                      {"particles", 49}},
                                     {{"name", "upper sheet"},
                                      {"positions", "upper_sheet.pc2"},
                                      {"mesh", "upper_sheet.mesh.obj"},
                                      {"color", {0.3, 0.05, 0.35}},
                                      {"vertices", 63},
                                      {"particles", 63}}}},
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

/// Two panels with a seam between them, quads, texture coordinates by corner and groups. The fifth vertex has no
/// triangle.
const std::string kPanels =
    "v 0 1 0\nv 1 1 0\nv 1 1 1\nv 0 1 1\nv 5 5 5\nv 1 1 0\nv 2 1 0\nv 2 1 1\nv 1 1 1\n"
    "vt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nvt 0.25 0.125\n"
    "o dress\ng left\nf 1/1 4/4 3/3 2/2\ng right hem\nf 6/5 9/4 8/3 7/2\n";

class PanelsFolder : public RunFolder {
 protected:
  void SetUp() override {
    RunFolder::SetUp();
    fs::create_directories(folder_);
    std::ofstream(file_) << kPanels;
  }

  /// One cloth of the panels, welded at the seam, half a metre higher.
  SceneDesc panels() const {
    SceneDesc scene = sheets();
    scene.cloths.resize(1);
    scene.cloths[0].shape = MeshSource{.file = file_, .weld = true};
    scene.cloths[0].position = {0, 0.5, 0};
    return scene;
  }

  const fs::path file_ = folder_ / "two_panels.obj";
};

TEST_F(PanelsFolder, PointCachesHaveTheVerticesOfTheMeshFile) {
  run_to_folder(panels(), options(6));
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

void expect_equal(const MeshFaces& a, const MeshFaces& b) {
  EXPECT_EQ(a.corners, b.corners);
  EXPECT_EQ(a.ends, b.ends);
  EXPECT_EQ(a.uv, b.uv);
  EXPECT_EQ(a.groups, b.groups);
}

TEST_F(PanelsFolder, MeshesHaveTheFacesOfTheMeshFile) {
  RunOptions with_obj = options(3);
  with_obj.obj = true;
  run_to_folder(panels(), with_obj);
  const MeshFromFile source = read_obj(file_),
                     start = read_obj(folder_ / list()["cloths"][0]["mesh"].get<std::string>());
  expect_equal(start.faces, source.faces);
  const PointCache cache = read_pc2(folder_ / list()["cloths"][0]["positions"].get<std::string>());
  for (std::size_t k = 0; k <= 3; ++k) {
    const MeshFromFile frame = read_obj(folder_ / "obj" / ("lower_sheet_000" + std::to_string(k) + ".obj"));
    expect_equal(frame.faces, source.faces);
    ASSERT_EQ(frame.mesh.num_vertices(), 9);
    for (int v = 0; v < 9; ++v) {
      for (int axis = 0; axis < 3; ++axis)
        EXPECT_EQ(static_cast<float>(frame.mesh.positions[v][axis]), cache.frames[k][3 * v + axis]);
    }
    if (k == 0) {
      EXPECT_EQ(frame.mesh.positions, start.mesh.positions);
    }
  }
}

TEST_F(PanelsFolder, ConvertsToSequencesOfMeshes) {
  run_to_folder(panels(), options(3));
  const PointCache cache = read_pc2(folder_ / "lower_sheet.pc2");
  const Converted all = weft::convert(folder_.string(), (folder_ / "walk.obj").string());
  ASSERT_EQ(all.files.size(), 4u);
  EXPECT_EQ(all.files[3], (folder_ / "walk_0003.obj").string());
  const Converted some =
      weft::convert((folder_ / "lower_sheet.pc2").string(), (folder_ / "part.ply").string(),
                    {.first_frame = 1, .last_frame = 2, .mesh = file_.string()});
  ASSERT_EQ(some.files.size(), 2u);
  EXPECT_EQ(some.files[0], (folder_ / "part_0001.ply").string());
  ASSERT_EQ(some.notes.size(), 1u);
  EXPECT_EQ(some.notes[0], file_.string() + " has 4 groups, which are lost: only .obj holds them");
  const MeshFaces source = read_obj(file_).faces;
  const auto expect_frame = [&](const fs::path& file, std::size_t k) {
    MeshFromFile read = read_mesh(file);
    for (int v = 0; v < 9; ++v) {
      for (int axis = 0; axis < 3; ++axis)
        EXPECT_EQ(read.mesh.positions[v][axis], cache.frames[k][3 * v + axis]);
    }
    if (has_ending(file, ".ply")) read.faces.groups = source.groups;
    expect_equal(read.faces, source);
  };
  for (std::size_t k = 0; k <= 3; ++k) expect_frame(all.files[k], k);
  for (std::size_t k = 1; k <= 2; ++k) expect_frame(some.files[k - 1], k);
}

TEST_F(PanelsFolder, MistakesOfAConversionNameTheirFiles) {
  run_to_folder(panels(), options(1));
  const fs::path cache = folder_ / "lower_sheet.pc2", out = folder_ / "x.obj";
  const auto failure = [](const fs::path& in, const fs::path& to,
                          const ConvertOptions& given) -> std::string {
    try {
      weft::convert(in.string(), to.string(), given);
    } catch (const InputError& error) {
      return error.what();
    }
    return "no error";
  };
  EXPECT_EQ(failure(cache, out, {}),
            out.string() + ": a point cache has no faces; --mesh names the mesh of its points");
  std::ofstream(folder_ / "other.obj") << "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
  EXPECT_EQ(failure(cache, out, {.mesh = (folder_ / "other.obj").string()}),
            cache.string() + " has 9 points, but " + (folder_ / "other.obj").string() +
                " has 3 vertices; expected the mesh of its points");
  for (const fs::path& in : {file_, folder_})
    EXPECT_EQ(failure(in, out, {.mesh = file_.string()}),
              file_.string() + ": only a point cache that becomes .obj or .ply needs a mesh (--mesh)");
  std::ofstream(folder_ / "run.json") << R"({"cloths": [{"name": "a", "positions": "lower_sheet.pc2"}]})";
  EXPECT_EQ(failure(folder_, out, {}),
            folder_.string() + " has no meshes of its point caches: it is of an earlier version of Weft");
}

TEST_F(RunFolder, HasTheSceneThatMadeIt) {
  SceneDesc scene = sheets();
  scene.settle = 0.1;
  scene.solver.newton.iterations = 7;
  const FinishedRun run = run_to_folder(scene, options(2));
  const SceneDesc again = read_scene(folder_ / "as_run/scene.toml");
  EXPECT_EQ(again.settle, 0.1);
  EXPECT_EQ(hash_of_scene(again), hash_of_scene(scene));
  EXPECT_EQ(run_scene(again, {.frames = 2}).state_hash, run.report.state_hash);
}

TEST_F(RunFolder, HasTheMeshesThatAreInNoFile) {
  SceneDesc scene = sheets();
  scene.cloths.resize(1);
  scene.cloths[0].name = "sail";
  scene.cloths[0].shape =
      MeshSource{.mesh = std::make_shared<const weft::TriangleMesh>(weft::TriangleMesh{
                     .positions = {{0, 2, 0}, {1, 2, 0}, {0, 2, 1}}, .triangles = {{0, 1, 2}}})};
  const FinishedRun run = run_to_folder(scene, options(2));
  EXPECT_EQ(run_scene(read_scene(folder_ / "as_run/scene.toml"), {.frames = 2}).state_hash,
            run.report.state_hash);
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
  EXPECT_EQ(names(), (std::set<std::string>{"animation.glb", "as_run", "as_run/scene.toml", "mine.pc2",
                                            "report.json", "run.json", "sail.mesh.obj", "sail.pc2",
                                            "upper_sheet.mesh.obj", "upper_sheet.pc2"}));
  RunOptions none = options(1);
  none.pc2 = none.glb = false;
  EXPECT_EQ(run_to_folder(renamed, none).files.size(), 3u);
  EXPECT_EQ(names(),
            (std::set<std::string>{"as_run", "as_run/scene.toml", "mine.pc2", "report.json", "run.json"}));
  EXPECT_TRUE(list()["cloths"][0]["positions"].is_null());
  EXPECT_TRUE(list()["cloths"][0]["mesh"].is_null());
  EXPECT_TRUE(list()["animation"].is_null());
}

TEST_F(RunFolder, ForgedListRemovesNothing) {
  fs::create_directories(folder_ / "inner");
  for (const char* name : {"outside.pc2", "inner/deep.pc2", "notes.txt", "mine.obj"})
    std::ofstream(folder_ / name) << "!";
  const fs::path absolute = fs::absolute(folder_ / "outside.pc2");
  for (
      const std::string& cloths :
      {std::string(
           R"([{"positions": "inner/deep.pc2"}, {"positions": "notes.txt"}, {"positions": 7}, {"mesh": "mine.obj"}, 8])"),
       R"([{"positions": ")" + absolute.string() + R"("}])", std::string("7"), std::string("]")}) {
    std::ofstream(folder_ / "run.json") << R"({"cloths": )" << cloths << "}";
    run_to_folder(sheets(), options(1));
    for (const char* name : {"outside.pc2", "inner/deep.pc2", "notes.txt", "mine.obj"})
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
  EXPECT_EQ(result.files.size(), 8u);
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
