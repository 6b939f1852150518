/// Written scenes are read back equal, and check_scene gives the reader's messages.

#include "weft/scene/scene_writer.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "tests/own_folder.h"
#include "weft/core/job_system.h"
#include "weft/error.h"
#include "weft/mesh/solid.h"
#include "weft/scene/scene_library.h"
#include "weft/scene/scene_reader.h"
#include "weft/scene/scene_world.h"

namespace weft::engine {
namespace {

namespace fs = std::filesystem;

class SceneWriter : public testing::Test {
 protected:
  /// The scene, written and read.
  SceneDesc round_trip(const SceneDesc& scene) const {
    write_scene(folder_ / "scene.toml", scene);
    SceneDesc read = read_scene(folder_ / "scene.toml");
    read.name = scene.name;  // a file's name is the scene's
    return read;
  }

  // One per test: tests run at the same time.
  const fs::path folder_ = make_own_folder();
};

/// Mesh files by the shortest of their names.
SceneDesc with_short_paths(SceneDesc scene) {
  const auto shorten = [](fs::path& path) { path = fs::weakly_canonical(path); };
  for (ClothSceneDesc& cloth : scene.cloths) {
    if (MeshSource* mesh = std::get_if<MeshSource>(&cloth.shape)) shorten(mesh->file);
  }
  for (ColliderSceneDesc& collider : scene.colliders) {
    PlacedMesh* mesh = std::get_if<PlacedMesh>(&collider.shape);
    if (!mesh) continue;
    shorten(mesh->source.file);
    for (fs::path& frame : mesh->frames) shorten(frame);
  }
  return scene;
}

TEST_F(SceneWriter, WritesEveryShippedSceneSoThatItReadsBackEqual) {
  int count = 0;
  for (const ShippedScene& shipped : list_scenes()) {
    const SceneDesc scene = with_short_paths(read_scene(shipped.file));
    const SceneDesc read = with_short_paths(round_trip(scene));
    EXPECT_EQ(read.cloths, scene.cloths) << shipped.name;
    EXPECT_EQ(read.colliders, scene.colliders) << shipped.name;
    EXPECT_EQ(read.wind, scene.wind) << shipped.name;
    EXPECT_EQ(read.solver, scene.solver) << shipped.name;
    EXPECT_EQ(read, scene) << shipped.name;
    ++count;
  }
  EXPECT_GE(count, 30);
}

/// Every key of a scene file, with another value than its default.
TEST_F(SceneWriter, WritesEveryKey) {
  std::ofstream(folder_ / "a.obj") << "v 0 0 0\nv 1 0 0\nv 0 0 1\nf 1 2 3\n";
  std::ofstream(folder_ / "c.glb") << "glTF";
  std::ofstream(folder_ / "b_1.obj") << "v 0 0 0\nv 1 0 0\nv 0 0 1\nf 1 2 3\n";
  std::ofstream(folder_ / "b_2.obj") << "v 0 0 0\nv 1 0 0\nv 0 1 1\nf 1 2 3\n";
  const SceneDesc scene = parse_scene(R"([scene]
format = 1
description = "quotes \" and \\ and\ta tab"
gravity = [0.1, -9, 0.3333333333333333]
fps = 50
duration = 0.7
settle = 0.25
[[cloth]]
grid = { size = [1.5, 2], cells = [4, 5] }
model = "basic"
fabric = { density = 0.3, spring_structural = 1e3, spring_shear = 7, spring_bend = 0, damping = 0.25, damping_kind = "plain", thickness = 0.002, friction = 0.7 }
position = [1, 2, 3]
rotation = [10, 20, 30]
velocity = [-1, 0, 1e-9]
color = [0.1, 0.2, 0.3]
pins = ["corner:1,0", "index:3"]
[[cloth.pin]]
select = { index = [4, 5] }
motion = [{ time = 0 }, { time = 1, position = [0, 1, 0], rotation = [0, 720, 0] }]
pivot = [1, 1, 1]
[[cloth.pin]]
select = { box = { min = [-9, -9, -9], max = [9, 9, 9] } }
[[cloth.stiffen]]
select = { sphere = { center = [1, 2, 3], radius = 4 } }
factor = 2.5
[[cloth]]
name = "mesh"
mesh = "a.obj"
up = "z"
scale = 0.01
weld = 0.0005
sew = 0.002
rest = { uv_scale = 0.8 }
fabric = { base = "denim", friction = 0.77 }
membrane = "springs"
warp = [1, 0, 0.5]
seam_time = 0.5
seam_stiffness = 1e5
layer = 3
pins = ['group:left "cuff"', { group = "waist", follow = "dancer", stiffness = 50, damping = 0.1 }]
[[cloth.rest_scale]]
select = "group:waist"
weft = 0.7
[[cloth.rest_scale]]
select = { sphere = { center = [1, 2, 3], radius = 4 } }
warp = 1.25
[[cloth.seam]]
a = [0, 4, 9]
b = [17, 12]
[[cloth]]
mesh = "a.obj"
stitches = true
rest = "uv"
fabric = "silk"
[[cloth]]
mesh = "a.obj"
rest = { mesh = "a.obj", up = "z", scale = 0.5 }
fabric = "silk"
[[cloth]]
grid = { size = [1, 1], cells = [2, 2] }
fabric = { name = "mine", density = 0.2, c11 = 500, c22 = 400, g = 30, stretch_warp = [[0.01, 5], [0.02, 12]], strain_limit = 0.2, bend_hysteresis_warp = 0.001, bend_hysteresis_weft = 0.002, bend_set = 500 }
[[cloth]]
grid = { size = [1, 1], cells = [2, 2] }
fabric = { base = "silk", strength = 900 }
[[collider]]
shape = "plane"
normal = [1, 2, 3]
friction = 0.2
static_friction = 0.25
[[collider]]
name = "box"
shape = "box"
center = [1, 1, 1]
half_size = [0.1, 0.2, 0.3]
rotation = [11, 22, 33]
motion = [{ time = 0.5 }]
[[collider]]
name = "capsule"
shape = "capsule"
a = [0, 0, 0]
b = [0, 0, 2]
radius = 0.3
[[collider]]
name = "body"
shape = "mesh"
frames = "b_*.obj"
frame_rate = 12
rest = "a.obj"
solid = true
up = "z"
scale = 2
position = [0, 1, 0]
rotation = [0, 90, 0]
[[collider]]
name = "dancer"
shape = "mesh"
file = "c.glb"
node = "Body"
clip = "walk"
start_time = 0.5
solid = false
scale = 0.01
[[contact]]
between = ["mesh", "body"]
collide = false
[[contact]]
between = ["mesh", "box"]
friction = 0.1
static_friction = 0.4
[wind]
drag = 0.1
air = { density = 1.1, drag = 1.3, lift = 0.2 }
gusts = { strength = 2, length = 3, time = 4, seed = 5 }
keys = [{ time = 1, velocity = [1, 0, 0] }, { time = 2, velocity = [0, 0, 0] }]
[solver]
integrator = "implicit_euler"
steps_per_frame = 3
adaptive = true
max_steps_per_frame = 8
iterations = 17
quality = "high"
precision = "double"
tolerance = 1e-5
contact = false
untangle = false
crossed_start = "allow"
explicit = { substeps = 4 }
paper = { damping_sign = "as_printed" }
xpbd = { substeps = 12 }
)",
                                      folder_ / "scene.toml");
  SceneDesc read = round_trip(scene);
  read.solver.newton.iterations = scene.solver.newton.iterations;
  EXPECT_EQ(read.cloths, scene.cloths);
  EXPECT_EQ(read.colliders, scene.colliders);
  EXPECT_EQ(read.contacts, scene.contacts);
  EXPECT_EQ(read.wind, scene.wind);
  EXPECT_EQ(read, scene);
}

/// A cloth and a deforming body, without files.
SceneDesc make_scene_in_memory() {
  weft::TriangleMesh sheet{.positions = {{0, 1, 0}, {1, 1, 0}, {0, 1, 1}, {1, 1, 1}},
                           .triangles = {{0, 2, 1}, {1, 2, 3}},
                           .uv = {{{{0, 0}, {0, 1}, {1, 0}}}, {{{1, 0}, {0, 1}, {1, 1}}}}};
  const TriangleMesh ball = make_sphere_mesh({0, 0, 0}, 0.2, 6);
  weft::TriangleMesh body{.positions = {}, .triangles = ball.triangles};
  for (const Vec3& p : ball.positions) body.positions.push_back({p.x(), p.y(), p.z()});
  PlacedMesh placed;
  placed.source.mesh = std::make_shared<weft::TriangleMesh>(std::move(body));
  placed.frame_positions = {ball.positions, ball.positions};
  for (Vec3& p : placed.frame_positions[1]) p *= 1.5;
  SceneDesc scene{.name = "memory"};
  ClothSceneDesc cloth{.name = "sheet"};
  cloth.shape = MeshSource{.mesh = std::make_shared<weft::TriangleMesh>(std::move(sheet))};
  cloth.fabric = FabricDesc{.name = "silk", .numbers = find_fabric("silk")};
  scene.cloths.push_back(cloth);
  scene.colliders.push_back({.name = "body", .shape = placed, .motion = {}});
  return scene;
}

TEST_F(SceneWriter, WritesMeshesInMemoryBesideTheScene) {
  const SceneDesc scene = make_scene_in_memory();
  EXPECT_EQ(check_scene(scene), std::vector<std::string>());
  PublicScene from_memory = build_scene(scene, make_serial_jobs());
  PublicScene from_file = build_scene(round_trip(scene), make_serial_jobs());
  EXPECT_TRUE(fs::exists(folder_ / "scene_sheet.obj"));
  for (int s = 0; s < 5; ++s) {
    from_memory.world.step(1.0 / 60);
    from_file.world.step(1.0 / 60);
  }
  EXPECT_EQ(from_memory.world.state_hash(), from_file.world.state_hash());
}

TEST_F(SceneWriter, GivesBodiesOfLikeNamesTheirOwnFiles) {
  SceneDesc scene = make_scene_in_memory();
  scene.cloths[0].name = "a b";
  scene.cloths.push_back(scene.cloths[0]);
  scene.cloths[1].name = "a_b";
  PlacedMesh& body = std::get<PlacedMesh>(scene.colliders[0].shape);
  body.frame_positions.clear();
  scene.colliders[0].name = "a/b";
  const SceneDesc read = round_trip(scene);
  const fs::path first = std::get<MeshSource>(read.cloths[0].shape).file,
                 second = std::get<MeshSource>(read.cloths[1].shape).file,
                 third = std::get<PlacedMesh>(read.colliders[0].shape).source.file;
  EXPECT_NE(first, second);
  EXPECT_NE(first, third);
  EXPECT_NE(second, third);
}

TEST_F(SceneWriter, ChecksASceneByTheSentencesOfTheReader) {
  SceneDesc scene = make_scene_in_memory();
  scene.fps = -1;
  scene.cloths[0].fabric->numbers.g = 0;
  scene.solver.integrator = "newtn";
  const std::vector<std::string> found = check_scene(scene);
  std::string all;
  for (const std::string& message : found) all += message + '\n';
  EXPECT_NE(all.find("scene.fps: expected a number above 0"), std::string::npos) << all;
  EXPECT_NE(all.find("cloth[0].g: expected"), std::string::npos) << all;
  EXPECT_NE(all.find("did you mean \"newton\"?"), std::string::npos) << all;
}

TEST_F(SceneWriter, RefusesWhatASceneFileCannotSay) {
  SceneDesc scene = make_scene_in_memory();
  scene.colliders[0].motion = RigidMotion(Pose{.translation = {1, 0, 0}});
  EXPECT_THROW(write_scene(folder_ / "scene.toml", scene), InputError);
}

}  // namespace
}  // namespace weft::engine
