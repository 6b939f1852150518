/// Scenes that start from a frame of an earlier run.

#include "weft/run/start_from.h"

#include <gtest/gtest.h>

#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <fstream>
#include <nlohmann/json.hpp>

#include "tests/message_of.h"
#include "tests/own_folder.h"
#include "tests/run/shipped.h"
#include "weft/core/staged_file.h"
#include "weft/io/pc2.h"
#include "weft/run/past_run.h"
#include "weft/run/run_folder.h"
#include "weft/run/start_check.h"

namespace weft::engine {
namespace {

namespace fs = std::filesystem;

void expect_contains(const std::string& text, const std::string& part) {
  EXPECT_NE(text.find(part), std::string::npos) << text << "\nhas not: " << part;
}

class StartFromRun : public testing::Test {
 protected:
  /// A sheet of 9×9 particles above a ball of radius 0.2 m around the origin.
  SceneDesc sheet(const std::string& more = "", const std::string& in_scene = "",
                  const std::string& in_solver = "") const {
    return parse_scene("[scene]\nformat = 1\n" + in_scene + "[solver]\n" + in_solver + R"(
[[cloth]]
name = "sheet"
grid = { size = [1, 1], cells = [8, 8] }
fabric = "silk"
position = [-0.5, 0.25, -0.5]
)" + more,
                       folder_ / "scene.toml");
  }

  static std::string ball(double height, double radius) {
    return "[[collider]]\nname = \"ball\"\nshape = \"sphere\"\ncenter = [0, " + std::to_string(height) +
           ", 0]\nradius = " + std::to_string(radius) + "\n";
  }

  std::string path(const std::string& name) const { return (folder_ / name).string(); }

  RunOptions options(const std::string& name, int frames, const std::string& start_from = "") const {
    return {.frames = frames, .folder = path(name), .glb = false, .start_from = start_from};
  }

  /// A run of one cloth "sheet" with these frames (num_vertices x, y, z).
  void write_run(const std::string& name, const std::vector<std::vector<float>>& frames, double fps) const {
    fs::create_directories(folder_ / name);
    StagedFile file(folder_ / name / "sheet.pc2");
    Pc2Writer writer(file, static_cast<int>(frames[0].size() / 3));
    for (const std::vector<float>& frame : frames) writer.add_frame(frame);
    writer.finish();
    file.replace();
    const nlohmann::json list = {{"fps", fps}, {"cloths", {{{"name", "sheet"}, {"positions", "sheet.pc2"}}}}};
    std::ofstream(folder_ / name / "run.json") << list;
  }

  const fs::path folder_ = make_own_folder();
};

TEST_F(StartFromRun, ReadsFolderAndFrame) {
  const auto parts = [](const std::string& text) {
    const StartFrom from = parse_start_from(text);
    return from.folder.string() + " " + (from.frame ? std::to_string(*from.frame) : "last");
  };
  EXPECT_EQ(parts("out/flag@60"), "out/flag 60");
  EXPECT_EQ(parts("out/flag@0"), "out/flag 0");
  EXPECT_EQ(parts("out/flag@last"), "out/flag last");
  EXPECT_EQ(parts("out/flag"), "out/flag last");
  EXPECT_EQ(parts("me@home/flag"), "me@home/flag last");
  EXPECT_EQ(parts("me@home/flag@7"), "me@home/flag 7");
  fs::create_directories(folder_ / "flag@7");
  EXPECT_EQ(parts(path("flag@7")), path("flag@7") + " last") << "a folder of that name";
  for (const char* text : {"out/flag@", "out/flag@-1", "out/flag@x", "out/flag@1.5", "@5", "a@1234567890"})
    expect_contains(message_of([&] { parse_start_from(text); }),
                    std::string("start_from ") + text + ": expected");
  EXPECT_EQ(to_text(parse_start_from(path("a/../b/@3"))), path("b@3"));
  EXPECT_EQ(to_text(parse_start_from(path("b"))), path("b@last"));
}

/// One vertex at x(t) = 3 t + 5 t² m: the parabola's velocity 3 + 10 t is exact from three frames.
TEST_F(StartFromRun, VelocitiesAreThoseOfTheParabolaThroughThreeFrames) {
  std::vector<std::vector<float>> frames;
  for (int k = 0; k < 5; ++k) {
    const double t = k / 8.0;  // an exact float, as its square is
    frames.push_back({static_cast<float>(3 * t + 5 * t * t), 1, 0});
  }
  write_run("old", frames, 8);
  const auto velocity = [&](const std::string& frame) {
    return read_start(parse_start_from(path("old") + frame)).cloths[0].velocities[0];
  };
  for (const int k : {0, 2, 3, 4})
    EXPECT_EQ(velocity('@' + std::to_string(k)), Vec3(3 + 10 * k / 8.0, 0, 0)) << k;
  EXPECT_EQ(velocity(""), velocity("@4"));
  EXPECT_EQ(velocity("@last"), velocity("@4"));
  EXPECT_EQ(velocity("@1"), Vec3(3 + 10 * 0.5 / 8, 0, 0)) << "two frames only: half a frame earlier";
}

TEST_F(StartFromRun, VelocityOfClothThatWasStoppedIsZero) {
  write_run("old", {{0, 2, 0}, {0, 1, 0}, {0, 1, 0}}, 10);
  EXPECT_EQ(read_start(parse_start_from(path("old"))).cloths[0].velocities[0], Vec3(Vec3::Zero()));
  write_run("still", {{0, 2, 0}}, 10);
  EXPECT_EQ(read_start(parse_start_from(path("still"))).cloths[0].velocities[0], Vec3(Vec3::Zero()));
}

TEST_F(StartFromRun, BeginsWithThePositionsAndVelocitiesOfTheFrame) {
  const SceneDesc scene = sheet("", "", "contact = false\n");
  run_to_folder(scene, options("old", 20));
  SceneRun whole(scene, make_serial_jobs());
  for (int k = 0; k < 12; ++k) whole.next_frame();
  const SceneStart start = read_start(parse_start_from(path("old@12")));
  const SceneRun later(scene, make_serial_jobs(), {}, 5, &start);
  EXPECT_EQ(later.world().time(), 0);
  const ClothState &now = whole.world().state(whole.world().cloth(0)),
                   &begun = later.world().state(later.world().cloth(0));
  // A float of the cache, and a float of the state: half a unit in the last place below 2 m each.
  for (std::size_t i = 0; i < now.x.size(); ++i) {
    ASSERT_LT((begun.position(i) - now.position(i)).norm(), 2e-7 * std::sqrt(3.0));
    // Free fall: floats of positions over a frame, of 1/60 s. Half a frame's fall would be 0.08 m/s.
    ASSERT_LT((begun.v.get(i) - now.v.get(i)).norm(), 4 * 2e-7 * 60);
  }
  EXPECT_EQ(later.report().notes,
            (std::vector<std::string>{"cloth \"sheet\" starts from frame 12 of " + path("old")}));
}

/// A panel of a cushion, bulged by `height`: around its middle four corners, each cut off by an edge between two
/// middles of sides. Vertices of `out` before it: `first`.
void write_panel(std::ostream& out, double height, int first) {
  constexpr int kAround[8][2] = {{0, 0}, {1, 0}, {2, 0}, {2, 1}, {2, 2}, {1, 2}, {0, 2}, {0, 1}};
  for (const auto& [x, z] : kAround) out << "v " << 0.5 * x << ' ' << 0.05 * height << ' ' << 0.5 * z << '\n';
  for (const auto& [x, z] : {std::pair(0.2, 0.2), {0.8, 0.2}, {0.8, 0.8}, {0.2, 0.8}, {0.5, 0.5}})
    out << "v " << x << ' ' << height << ' ' << z << '\n';
  const auto triangle = [&](int a, int b, int c) {
    out << "f " << first + a << ' ' << first + b << ' ' << first + c << '\n';
  };
  for (int corner = 0; corner < 4; ++corner) {
    const int here = 2 * corner, before = (here + 7) % 8, after = here + 1, inside = 8 + corner;
    triangle(before, here, inside);
    triangle(here, after, inside);
    triangle(after, before, inside);
    triangle(after, 12, before);
  }
}

/// Keeps the positions of the first cloth's particles.
struct Positions : FrameSink {
  void begin(SceneRun& run, RunReport&) override { add(run); }
  void add_frame(const SceneRun& run, RunReport&) override { add(run); }
  void add(const SceneRun& run) { frames.push_back(positions_of(run.world().state(run.world().cloth(0)))); }

  std::vector<std::vector<Vec3>> frames;
};

/// Sewn panels have the edges between middles of sides twice: sewing divides one of each. A vertex without
/// triangle is in the mesh too.
TEST_F(StartFromRun, MovesEveryParticleOfASewnMesh) {
  const fs::path file = folder_ / "cushion.obj";
  {
    std::ofstream out(file);
    write_panel(out, 0.1, 1);
    write_panel(out, -0.1, 14);
    out << "v 5 5 5\n";
  }
  SceneDesc scene = sheet("", "", "contact = false\n");
  scene.cloths[0].shape = MeshSource{.file = file, .sew_distance = 0.03};
  scene.cloths[0].velocity = {0, 0, 7};
  Positions old, begun;
  run_to_folder(scene, options("old", 3), {&old});
  run_to_folder(scene, options("new", 1, path("old@3")), {&begun});
  ASSERT_EQ(old.frames[0].size(), 8 + 2 * 5 + 4u);
  for (std::size_t i = 0; i < old.frames[0].size(); ++i) {
    EXPECT_NEAR(old.frames[3][i].z() - old.frames[0][i].z(), 7 * 3 / 60.0, 1e-5) << "it moves as a whole";
    EXPECT_LT((begun.frames[0][i] - old.frames[3][i]).norm(), 1e-5) << i;
  }
}

TEST_F(StartFromRun, ClothsAreMatchedByTheirNames) {
  run_to_folder(sheet(), options("old", 3));
  const std::string other = R"([[cloth]]
name = "cape"
grid = { size = [1, 1], cells = [4, 4] }
position = [3, 1, 0]
)";
  const RunReport report = run_to_folder(sheet(other), options("more", 1, path("old@3"))).report;
  EXPECT_EQ(report.notes,
            (std::vector<std::string>{
                "cloth \"sheet\" starts from frame 3 of " + path("old"),
                "cloth \"cape\" starts as the scene says: it is not in frame 3 of " + path("old")}));
  EXPECT_EQ(read_pc2(folder_ / "more/cape.pc2").frames[0][1], 1);
  EXPECT_EQ(read_pc2(folder_ / "more/sheet.pc2").frames[0], read_pc2(folder_ / "old/sheet.pc2").frames[3]);
  const RunReport fewer = run_to_folder(sheet(), options("fewer", 1, path("more"))).report;
  EXPECT_EQ(fewer.notes[1], "cloth \"cape\" of frame 1 of " + path("more") + " is not in the scene");
}

TEST_F(StartFromRun, MistakesNameBothSides) {
  run_to_folder(sheet(), options("old", 3));
  const auto refused = [&](const SceneDesc& scene, const std::string& start_from) {
    return message_of([&] { run_to_folder(scene, options("new", 1, start_from)); });
  };
  SceneDesc finer = sheet();
  std::get<Grid>(finer.cloths[0].shape).cells_x = 9;
  expect_contains(refused(finer, path("old")),
                  "cloth \"sheet\" has 90 vertices in the scene, but 81 in frame 3 of " + path("old"));
  SceneDesc renamed = sheet();
  renamed.cloths[0].name = "cape";
  expect_contains(refused(renamed, path("old")), "no cloth starts from frame 3 of " + path("old") +
                                                     ": the scene has \"cape\", the run has \"sheet\"");
  EXPECT_EQ(refused(sheet(), path("old@4")),
            path("old") + " has the frames 0 to 3; a scene cannot start from frame 4");
  EXPECT_EQ(refused(sheet(), path("none@4")), path("none") + " holds no run: there is no run.json");
  EXPECT_FALSE(fs::exists(folder_ / "new/unfinished"));
  expect_contains(message_of([&] { run_to_folder(sheet(), options("old", 1, path("old@2"))); }),
                  "the results would replace the run that they start from");
  RunOptions without = options("without", 1);
  without.pc2 = false;
  run_to_folder(sheet(), without);
  EXPECT_EQ(refused(sheet(), path("without")),
            path("without") + " has no point cache of cloth \"sheet\": it was run with --no-pc2");
}

double height(const SceneRun& run) {  // of the sheet's middle
  return run.world().state(run.world().cloth(0)).position(4 * 9 + 4).y();
}

/// Order: the old state, then the repair of intersections, then settling, then the check of the start.
TEST_F(StartFromRun, IntersectionsWithTheNewSceneAreRepairedOrRefused) {
  run_to_folder(sheet(), options("old", 6));
  const SceneStart start = read_start(parse_start_from(path("old")));
  const double there = start.cloths[0].positions[4 * 9 + 4].y();
  ASSERT_LT(there, 0.21) << "the sheet has fallen";
  // The scene's own start is above this ball, the old state goes through it.
  const std::string in_the_way = ball(0.02, 0.2);
  const SceneRun repaired(sheet(in_the_way), make_serial_jobs(), {}, 1, &start);
  EXPECT_TRUE(check_start(repaired.world()).empty());
  EXPECT_GT(height(repaired), there);
  expect_contains(repaired.report().warnings.at(0), "moved apart in ");

  const auto refused = [&](const char* in_solver) {
    return message_of(
        [&] { run_to_folder(sheet(in_the_way, "", in_solver), options("new", 1, path("old"))); });
  };
  EXPECT_EQ(refused(""), "no error");
  expect_contains(refused("untangle = false\n"), "intersections at the start, which solver.untangle = false");
}

TEST_F(StartFromRun, SettlesFromTheOldState) {
  run_to_folder(sheet(), options("old", 6));
  const SceneStart start = read_start(parse_start_from(path("old")));
  const SceneRun run(sheet(ball(-0.1, 0.2), "settle = 0.5\n"), make_serial_jobs(), {}, 1, &start);
  EXPECT_EQ(run.world().time(), 0);
  EXPECT_NEAR(height(run), 0.11, 0.025)
      << "it lies on the ball: a corner of a tangent triangle is up to 20 mm above";
  const ClothState& state = run.world().state(run.world().cloth(0));
  for (std::size_t i = 0; i < state.v.size(); ++i) ASSERT_EQ(state.v.get(i), Vec3(Vec3::Zero()));
}

TEST_F(StartFromRun, PinsHoldWhereTheOldRunLeftThem) {
  const std::string pin = "[[cloth.pin]]\nselect = { index = [0] }\n";
  run_to_folder(sheet(pin + "motion = [{ time = 0 }, { time = 0.1, position = [0, 0, 0.05] }]\n"),
                options("old", 9));
  run_to_folder(sheet(pin), options("new", 5, path("old")));
  const PointCache old = read_pc2(folder_ / "old/sheet.pc2"), now = read_pc2(folder_ / "new/sheet.pc2");
  EXPECT_NEAR(old.frames[9][2], -0.45, 1e-6);
  for (const std::vector<float>& frame : now.frames) {
    for (int axis = 0; axis < 3; ++axis) EXPECT_EQ(frame[axis], old.frames[9][axis]);
  }
}

TEST_F(StartFromRun, StartsFromAnUnfinishedRunToo) {
  const pid_t child = fork();
  if (child == 0) {
    run_to_folder(sheet(), options("old", 6), {}, [](const Progress& progress) {
      if (progress.frame == 4) raise(SIGKILL);
      return true;
    });
    _exit(0);
  }
  waitpid(child, nullptr, 0);
  const PastRun old = read_past_run(folder_ / "old");
  EXPECT_EQ(old.fps, 60);
  EXPECT_EQ(old.cloths[0].cache, folder_ / "old/unfinished/sheet.pc2");
  const SceneStart start = read_start(parse_start_from(path("old")));
  EXPECT_EQ(start.source, "frame 4 of " + path("old"));
  EXPECT_EQ(start.cloths[0].positions.size(), 81u);
}

}  // namespace
}  // namespace weft::engine
