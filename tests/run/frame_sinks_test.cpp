/// Sinks receive frames during the run, and files hold the same frames as a sink in memory.

#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <fstream>

#include "tests/own_folder.h"
#include "tests/run/shipped.h"
#include "weft/core/file_name.h"
#include "weft/io/glb_reader.h"
#include "weft/io/mesh_files.h"
#include "weft/io/obj_reader.h"
#include "weft/run/file_sinks.h"
#include "weft/run/film.h"
#include "weft/run/scene_run.h"

namespace weft::engine {
namespace {

namespace fs = std::filesystem;

class FrameSinks : public testing::Test {
 protected:
  void SetUp() override { folder_ = make_own_folder(); }

  fs::path folder_;
};

/// Stores the numbers of frames and the world's time at each.
struct Listener : FrameSink {
  void begin(SceneRun& run, RunReport& report) override { add_frame(run, report); }
  void add_frame(const SceneRun& run, RunReport&) override {
    frames.push_back(run.frame());
    times.push_back(run.world().time());
  }
  void begin_step(const SceneRun&) override { ++steps; }
  void finish(const SceneRun&, RunReport& report) override { hash = report.state_hash; }

  std::vector<int> frames;
  std::vector<double> times;
  int steps = 0;
  std::string hash;
};

TEST_F(FrameSinks, GetEveryFrameOnceInOrder) {
  Listener listener;
  const SceneDesc scene = shipped("flag", {"solver.steps_per_frame=2"});
  const RunReport report = run_scene(scene, {.frames = 4}, {&listener});
  EXPECT_EQ(listener.frames, (std::vector<int>{0, 1, 2, 3, 4}));
  for (int k = 0; k <= 4; ++k) EXPECT_NEAR(listener.times[k], k / 60.0, 1e-12);
  EXPECT_EQ(listener.steps, 8);
  EXPECT_EQ(listener.hash, report.state_hash);
}

TEST_F(FrameSinks, RunFrameByFrameHasTheSameBitsWithAndWithoutThem) {
  const SceneDesc scene = shipped("flag");
  Listener listener;
  SceneRun watched(scene, make_serial_jobs(), {&listener}, 10), alone(scene, make_serial_jobs(), {}, 10);
  while (watched.next_frame()) EXPECT_TRUE(alone.next_frame());
  EXPECT_FALSE(alone.next_frame());
  SceneRun by_steps(scene, make_serial_jobs());
  for (int s = 0; s < 10 * scene.steps_per_frame; ++s) by_steps.step();
  EXPECT_EQ(watched.finish().state_hash, alone.finish().state_hash);
  EXPECT_EQ(by_steps.finish().state_hash, alone.report().state_hash);
  EXPECT_EQ(run_scene(scene, {.frames = 10}).state_hash, alone.report().state_hash);
}

TEST_F(FrameSinks, ReportSoFarGrowsByAFrame) {
  SceneRun run(shipped("paper/fig6_ball"), make_serial_jobs(), {}, 3);
  EXPECT_EQ(run.report().frames, 0);
  ASSERT_TRUE(run.next_frame());
  EXPECT_EQ(run.report().frames, 1);
  run.interrupt();
  EXPECT_FALSE(run.next_frame());
  EXPECT_EQ(run.finish().outcome, RunOutcome::interrupted);
}

TEST_F(FrameSinks, GlbHasTheFramesOfTheFilm) {
  GlbSink glb(folder_ / "animation.glb", folder_ / "frames");
  FilmSink film;
  run_scene(shipped("contact/rotating_ball", {"cloth[0].grid.cells=[12, 12]"}), {.frames = 6}, {&glb, &film});
  glb.replace();
  const Animation read = read_glb(folder_ / "animation.glb");
  ASSERT_EQ(count_frames(read), 7u);
  ASSERT_EQ(read.bodies.size(), film.animation().bodies.size());
  for (std::size_t k = 0; k < 7; ++k) {
    const AnimationFrame a = get_frame(read, k), b = get_frame(film.animation(), k);
    for (std::size_t i = 0; i < b.cloths[0].size(); ++i)
      EXPECT_NEAR(a.cloths[0][i], b.cloths[0][i], 2e-7);  // a difference from the first frame, rounded
    for (std::size_t n = 0; n < b.poses.size(); ++n) {
      EXPECT_LT((a.poses[n].translation - b.poses[n].translation).norm(), 1e-6);
      EXPECT_LT(a.poses[n].rotation.angularDistance(b.poses[n].rotation), 1e-6);
    }
  }
}

TEST_F(FrameSinks, GlbHasBodiesThatDeform) {
  write_obj(folder_ / "body_0.obj", make_sphere_mesh({0, 0, 0}, 0.2, 8));
  write_obj(folder_ / "body_1.obj", make_sphere_mesh({0, 0, 0}, 0.3, 8));
  const SceneDesc scene = parse_scene(R"([scene]
format = 1
[[cloth]]
grid = { size = [1, 1], cells = [4, 4] }
position = [0, 5, 0]
[[collider]]
shape = "mesh"
frames = "body_*.obj"
frame_rate = 30
)",
                                      folder_ / "scene.toml");
  GlbSink glb(folder_ / "animation.glb", folder_ / "frames");
  run_scene(scene, {.frames = 2}, {&glb});
  glb.replace();
  const Animation read = read_glb(folder_ / "animation.glb");
  ASSERT_EQ(read.bodies.size(), 1u);
  ASSERT_EQ(read.bodies[0].frames.size(), 3u);
  for (const int k : {0, 1, 2})
    EXPECT_NEAR(read.bodies[0].vertex(0, read.bodies[0].frames.at(k)).norm(), 0.2 + 0.05 * k, 1e-6);
}

/// Two squares that touch, and a vertex of neither. The first is cut along a seam of the texture.
constexpr const char* kTwoSquares = R"(v 0 0 0
v 1 0 0
v 1 0 1
v 0 0 1
v 1 0 0
v 2 0 0
v 2 0 1
v 1 0 1
v 7 7 7
vt 0 0
vt 0.5 0
vt 0.5 0.5
vt 0 0.5
vt 0.25 0.75
f 1/1 2/2 3/3
f 1/5 3/3 4/4
f 5/1 6/2 7/3 8/4
)";

TEST_F(FrameSinks, GlbHasTheVerticesAndTextureCoordinatesOfTheFile) {
  std::ofstream(folder_ / "squares.obj") << kTwoSquares;
  const SceneDesc scene = parse_scene(R"([scene]
format = 1
[[cloth]]
mesh = "squares.obj"
weld = true
)",
                                      folder_ / "scene.toml");
  GlbSink glb(folder_ / "animation.glb", folder_ / "frames");
  FilmSink film;
  run_scene(scene, {.frames = 3}, {&glb, &film});
  glb.replace();

  // As other programs read it.
  const MeshFromFile given = read_obj(folder_ / "squares.obj"), shown = read_mesh(folder_ / "animation.glb");
  ASSERT_EQ(given.mesh.num_vertices(), 9);
  ASSERT_EQ(shown.mesh.num_vertices(), 10) << "one vertex has two texture coordinates";
  for (int v = 0; v < 9; ++v) EXPECT_EQ(shown.mesh.positions[v], given.mesh.positions[v]) << v;
  EXPECT_EQ(shown.mesh.positions[9], given.mesh.positions[0]);
  ASSERT_EQ(shown.mesh.num_triangles(), given.mesh.num_triangles());
  for (int t = 0; t < given.mesh.num_triangles(); ++t) {
    for (int k = 0; k < 3; ++k) {
      const int vertex = shown.mesh.triangles[t][k];
      EXPECT_EQ(vertex == 9 ? 0 : vertex, given.mesh.triangles[t][k]);
      EXPECT_EQ(shown.uv[t][k], given.uv[t][k]);
    }
  }

  // As Weft reads it: six particles.
  const Animation read = read_glb(folder_ / "animation.glb"), made = film.animation();
  EXPECT_EQ(read.cloths[0].triangles, made.cloths[0].triangles);
  EXPECT_EQ(read.cloths[0].fabric_coordinates, made.cloths[0].fabric_coordinates);
  EXPECT_EQ(read.cloths[0].frames[0], made.cloths[0].frames[0]);
  ASSERT_EQ(read.cloths[0].frames[3].size(), 18u);
  for (std::size_t i = 0; i < 18; ++i)
    EXPECT_NEAR(read.cloths[0].frames[3][i], made.cloths[0].frames[3][i], 1e-7);
}

TEST_F(FrameSinks, FilmSpoolHasTheFramesOnDiskWhileTheyAreMade) {
  FilmSink film;
  FilmSpool spool(folder_ / "picture.png", ParticleValue::speed);
  struct Reader : FrameSink {
    explicit Reader(FrameSource& frames) : source(frames) {}
    void begin(SceneRun&, RunReport&) override { start = source.read(0); }
    void add_frame(const SceneRun& run, RunReport&) override {
      EXPECT_EQ(source.num_frames(), run.frame() + 1);
      EXPECT_EQ(source.read(0).cloths, start.cloths);
    }
    FrameSource& source;
    AnimationFrame start;
  } reader(spool);
  run_scene(shipped("contact/rotating_ball", {"cloth[0].grid.cells=[6, 6]"}), {.frames = 3},
            {&film, &spool, &reader});
  ASSERT_EQ(spool.num_frames(), 4);
  for (int k = 3; k >= 0; --k) {
    const AnimationFrame frame = spool.read(k), kept = get_frame(film.animation(), k);
    EXPECT_EQ(frame.cloths, kept.cloths);
    EXPECT_EQ(frame.poses, kept.poses);
    EXPECT_EQ(frame.values[0].size(), 49u);
    EXPECT_EQ(k == 0, *std::ranges::max_element(frame.values[0]) == 0) << "it falls";
  }
  EXPECT_TRUE(fs::is_empty(folder_)) << "no name is left behind";
}

TEST_F(FrameSinks, ObjFilesHoldEveryPosition) {
  ObjSink obj(folder_);
  FilmSink film;
  run_scene(shipped("two_layers", {"cloth[0].grid.cells=[6, 6]", "cloth[1].grid.cells=[6, 6]"}),
            {.frames = 3}, {&obj, &film});
  for (const AnimatedCloth& cloth : film.animation().cloths) {
    const std::string name = FileNames().add(cloth.name);  // "upper_sheet"
    for (int k = 0; k <= 3; ++k) {
      const MeshFromFile read = read_obj(folder_ / (name + "_000" + std::to_string(k) + ".obj"));
      ASSERT_EQ(read.faces.size(), 36u);
      EXPECT_TRUE(std::ranges::equal(read.faces[35], std::array{40, 47, 48, 41})) << "cells, as quads";
      for (int v = 0; v < read.mesh.num_vertices(); ++v) {
        for (int axis = 0; axis < 3; ++axis)
          EXPECT_EQ(static_cast<float>(read.mesh.positions[v][axis]), cloth.frames[k][3 * v + axis]);
      }
    }
  }
}

TEST_F(FrameSinks, ObjFilesAreOnTheDiskAfterSync) {
  std::vector<std::string> synced;
  int num_flushed = 0;
  file_observer = [&](FileEvent event, const fs::path& path) {
    if (event == FileEvent::flush) ++num_flushed;
    if (event == FileEvent::sync || event == FileEvent::sync_folder)
      synced.push_back(path.filename().string());
  };
  ObjSink obj(folder_);
  SceneRun run(shipped("paper/fig3_horizontal"), make_serial_jobs(), {&obj}, 2);
  run.next_frame();
  EXPECT_EQ(num_flushed, 2);
  EXPECT_TRUE(synced.empty()) << "a frame alone waits for no disk";
  const std::string folder = folder_.filename().string();
  obj.sync();
  obj.sync();
  EXPECT_EQ(synced, (std::vector<std::string>{"cloth_0000.obj", "cloth_0001.obj", folder}));
  run.next_frame();
  run.finish();
  EXPECT_EQ(synced,
            (std::vector<std::string>{"cloth_0000.obj", "cloth_0001.obj", folder, "cloth_0002.obj", folder}));
  file_observer = nullptr;
}

TEST_F(FrameSinks, GlbSaysAtTheStartHowManyFramesItHasRoomFor) {
  const auto warning = [&](int frames) {
    GlbSink glb(folder_ / "animation.glb", folder_ / "frames");
    const RunReport report = run_scene(shipped("paper/fig3_horizontal"), {.frames = frames}, {&glb},
                                       [](const Progress& progress) { return progress.frame < 2; });
    return report.warnings.empty() ? "" : report.warnings[0];
  };
  EXPECT_NE(warning(1000000).find("of 1000000 frames: a .glb is limited to 4 GiB"), std::string::npos);
  EXPECT_NE(warning(1001).find("1001 frames, and its morph weights grow with their square"),
            std::string::npos);
  EXPECT_EQ(warning(1000), "");
}

/// Peak memory of a process that writes so many frames to a .glb [bytes].
double peak_memory(const SceneDesc& scene, int frames, const fs::path& file) {
  const pid_t child = fork();
  if (child == 0) {
    GlbSink glb(file, file.string() + ".frames");
    run_scene(scene, {.frames = frames, .check_passages = false}, {&glb});
    _exit(0);
  }
  int status = 0;
  rusage usage{};
  wait4(child, &status, 0, &usage);
  EXPECT_EQ(status, 0);
  return 1024.0 * static_cast<double>(usage.ru_maxrss);
}

TEST_F(FrameSinks, MemoryDoesNotGrowWithTheFrames) {
  const SceneDesc scene =
      shipped("paper/fig3_horizontal", {"cloth[0].grid.cells=[64, 64]", "solver.contact=false"});
  const double few = peak_memory(scene, 20, folder_ / "few.glb");
  const double many = peak_memory(scene, 420, folder_ / "many.glb");
  const double data = 400.0 * 65 * 65 * 6 * sizeof(float);  // of the further frames: 41 MB
  EXPECT_LT(many - few, 0.2 * data) << "grew by " << (many - few) / 1e6 << " MB";
}

}  // namespace
}  // namespace weft::engine
