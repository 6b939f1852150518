#include "weft/scene/scene_reader.h"

#include <gtest/gtest.h>

#include <fstream>

namespace weft::engine {
namespace {

const std::string kScene = "[scene]\nformat = 1\n";
const std::string kGrid = "[[cloth]]\ngrid = { size = [1, 1], cells = [4, 4] }\n";

SceneDesc parse(const std::string& text, const Overrides& overrides = {}) {
  return parse_scene(text, "scene.toml", overrides);
}

/// The smallest scene, with keys added to its cloth.
ClothSceneDesc parse_cloth(const std::string& text) { return parse(kScene + kGrid + text).cloths.at(0); }

SceneDesc set(const Overrides& overrides) {
  return parse(kScene + "gravity = [0, -9.81, 0]\n" + kGrid + "pins = [\"corner:0,0\", \"corner:1,0\"]\n",
               overrides);
}

/// A file in the tests' folder, removed by the destructor.
class TemporaryFile {
 public:
  explicit TemporaryFile(const std::string& name, const std::string& text = "")
      : path_(std::filesystem::path(testing::TempDir()) / name) {
    std::ofstream(path_) << text;
  }
  ~TemporaryFile() { std::filesystem::remove(path_); }
  TemporaryFile(const TemporaryFile&) = delete;
  TemporaryFile& operator=(const TemporaryFile&) = delete;

  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

TEST(SceneReader, LeavesDefaultsWhereKeysAreLeftOut) {
  const SceneDesc scene = parse(kScene + kGrid), defaults;
  EXPECT_EQ(scene.gravity, defaults.gravity);
  EXPECT_EQ(scene.fps, defaults.fps);
  EXPECT_EQ(scene.duration, defaults.duration);
  EXPECT_EQ(scene.steps_per_frame, defaults.steps_per_frame);
  EXPECT_EQ(scene.contact, defaults.contact);
  EXPECT_EQ(scene.solver.integrator, defaults.solver.integrator);
  EXPECT_TRUE(scene.colliders.empty());
  EXPECT_TRUE(scene.wind.keys.empty());
  const ClothSceneDesc &cloth = scene.cloths.at(0), none;
  EXPECT_EQ(cloth.name, "cloth");
  EXPECT_EQ(cloth.model, none.model);
  EXPECT_EQ(cloth.material.density, ClothMaterial().density);
  EXPECT_EQ(cloth.material.structural, ClothMaterial().structural);
  EXPECT_EQ(cloth.color, none.color);
  EXPECT_TRUE(cloth.pins.empty());
}

TEST(SceneReader, ReadsEveryKeyOfTheScene) {
  const SceneDesc scene = parse(R"([scene]
format = 1
description = "A cloth"
gravity = [0.5, -1.62, 0]
fps = 24
duration = 2.5
)" + kGrid);
  EXPECT_EQ(scene.description, "A cloth");
  EXPECT_EQ(scene.gravity, Vec3(0.5, -1.62, 0));
  EXPECT_EQ(scene.fps, 24);
  EXPECT_EQ(scene.duration, 2.5);
}

TEST(SceneReader, ReadsEveryKeyOfAGrid) {
  const ClothSceneDesc cloth = parse(kScene + R"([[cloth]]
name = "flag"
grid = { size = [1.5, 1], cells = [6, 4] }
model = "alternating"
position = [1, 2, 3]
rotation = [90, 0, -45]
velocity = [0, 0, 1]
pressure = -20
sealed = true
layer = -2
color = [0, 0.5, 1]
)")
                                   .cloths.at(0);
  const Grid& grid = std::get<Grid>(cloth.shape);
  EXPECT_EQ(cloth.name, "flag");
  EXPECT_EQ(grid.size_x, 1.5);
  EXPECT_EQ(grid.size_z, 1);
  EXPECT_EQ(grid.cells_x, 6);
  EXPECT_EQ(grid.cells_z, 4);
  EXPECT_EQ(cloth.model, SpringModel::alternating);
  EXPECT_EQ(cloth.position, Vec3(1, 2, 3));
  EXPECT_EQ(cloth.rotation_deg, Vec3(90, 0, -45));
  EXPECT_EQ(cloth.velocity, Vec3(0, 0, 1));
  EXPECT_EQ(cloth.pressure, -20);
  EXPECT_TRUE(cloth.is_sealed);
  EXPECT_EQ(cloth.layer, -2);
  EXPECT_EQ(cloth.color, (std::array<double, 3>{0, 0.5, 1}));
}

TEST(SceneReader, ReadsEveryKeyOfAFabric) {
  const ClothMaterial material = parse_cloth(R"([cloth.fabric]
spring_structural = 200
spring_shear = 100.5
spring_bend = 0
density = 0.3
damping = 0.01
damping_kind = "plain"
thickness = 0.002
friction = 0.1
)")
                                     .material;
  EXPECT_EQ(material.structural, 200);
  EXPECT_EQ(material.shear, 100.5);
  EXPECT_EQ(material.bend, 0);
  EXPECT_EQ(material.density, 0.3);
  EXPECT_EQ(material.damping, 0.01);
  EXPECT_EQ(material.damping_kind, DampingKind::plain);
  EXPECT_EQ(material.thickness, 0.002);
  EXPECT_EQ(material.friction, 0.1);
}

TEST(SceneReader, ReadsEveryModelByName) {
  for (const SpringModel model : {SpringModel::basic, SpringModel::simplified, SpringModel::alternating}) {
    EXPECT_EQ(parse_cloth("model = \"" + std::string(to_string(model)) + "\"").model, model);
  }
}

TEST(SceneReader, FindsMeshesBesideTheScene) {
  const TemporaryFile mesh("scene_reader_test.obj");
  const std::string cloth =
      "[[cloth]]\nmesh = \"scene_reader_test.obj\"\nup = \"z\"\nscale = 0.01\nweld = 0.002\n";
  const SceneDesc scene = parse_scene(kScene + cloth, mesh.path().parent_path() / "scene.toml");
  const MeshSource& file = std::get<MeshSource>(scene.cloths.at(0).shape);
  EXPECT_EQ(file.file, mesh.path());
  EXPECT_TRUE(file.up_is_z);
  EXPECT_EQ(file.scale, 0.01);
  EXPECT_TRUE(file.weld);
  EXPECT_EQ(file.weld_distance, 0.002);
}

TEST(SceneReader, WeldsByYesNoOrDistance) {
  const TemporaryFile mesh("scene_reader_test_weld.obj");
  const auto parse_weld = [&](const std::string& weld) {
    const std::string cloth = "[[cloth]]\nmesh = \"scene_reader_test_weld.obj\"\nweld = " + weld;
    return std::get<MeshSource>(parse_scene(kScene + cloth, mesh.path()).cloths.at(0).shape);
  };
  EXPECT_FALSE(parse_weld("false").weld);
  EXPECT_TRUE(parse_weld("true").weld);
  EXPECT_EQ(parse_weld("true").weld_distance, MeshSource().weld_distance);
  EXPECT_TRUE(parse_weld("0").weld);
  EXPECT_EQ(parse_weld("0").weld_distance, 0);
}

TEST(SceneReader, SewsByDistance) {
  const TemporaryFile mesh("scene_reader_test_sew.obj");
  const std::string cloth = "[[cloth]]\nmesh = \"scene_reader_test_sew.obj\"\n";
  const auto parse_sew = [&](const std::string& key) {
    return std::get<MeshSource>(parse_scene(kScene + cloth + key, mesh.path()).cloths.at(0).shape);
  };
  EXPECT_EQ(parse_sew("").sew_distance, 0);
  EXPECT_EQ(parse_sew("sew = 0.002").sew_distance, 0.002);
  EXPECT_FALSE(parse_sew("sew = 0.002").weld);
}

TEST(SceneReader, ReadsPinsInShort) {
  const std::vector<PinDesc> pins = parse_cloth("pins = [\"corner:1,0\", \"index:24\"]").pins;
  ASSERT_EQ(pins.size(), 2u);
  EXPECT_EQ(std::get<GridCorner>(pins[0].select).i, 1);
  EXPECT_EQ(std::get<GridCorner>(pins[0].select).j, 0);
  EXPECT_EQ(std::get<ParticleIndices>(pins[1].select).indices, std::vector<int>{24});
}

TEST(SceneReader, ReadsEveryKindOfPin) {
  const std::vector<PinDesc> pins = parse_cloth(R"(pins = ["corner:0,0"]
[[cloth.pin]]
select = "corner:0,1"
[[cloth.pin]]
select = { index = [0, 24] }
[[cloth.pin]]
select = { box = { min = [0, -1, 0], max = [1, 1, 0.5] } }
[[cloth.pin]]
select = { sphere = { center = [1, 0, 0], radius = 0.2 } }
)")
                                        .pins;
  ASSERT_EQ(pins.size(), 5u);
  EXPECT_EQ(std::get<GridCorner>(pins[1].select).j, 1);
  EXPECT_EQ(std::get<ParticleIndices>(pins[2].select).indices, (std::vector<int>{0, 24}));
  EXPECT_EQ(std::get<Box>(pins[3].select).max, Vec3(1, 1, 0.5));
  EXPECT_EQ(std::get<Sphere>(pins[4].select).radius, 0.2);
}

TEST(SceneReader, ReadsGroupsOfAMesh) {
  const TemporaryFile mesh("groups.obj");
  const ClothSceneDesc cloth = parse(kScene + "[[cloth]]\nmesh = '" + mesh.path().string() + R"('
pins = ["group:left cuff"]
[[cloth.pin]]
select = "group:waist"
[[cloth.pin]]
select = { group = "waist" }
[[cloth.stiffen]]
select = { group = "collar" }
factor = 2
)")
                                   .cloths.at(0);
  ASSERT_EQ(cloth.pins.size(), 3u);
  EXPECT_EQ(cloth.pins[0].select, ParticleSelection(GroupName{"left cuff"}));
  EXPECT_EQ(cloth.pins[1].select, ParticleSelection(GroupName{"waist"}));
  EXPECT_EQ(cloth.pins[2].select, ParticleSelection(GroupName{"waist"}));
  EXPECT_EQ(cloth.stiffened.at(0).select, ParticleSelection(GroupName{"collar"}));
}

TEST(SceneReader, ReadsTheMotionOfPins) {
  const PinDesc pin = parse_cloth(R"([[cloth.pin]]
select = "corner:0,0"
pivot = [0.5, 0, 0]
motion = [{ time = 0 }, { time = 1, position = [0, 1, 0] }, { time = 1.5, rotation = [0, 720, 0] }]
)")
                          .pins.at(0);
  EXPECT_EQ(pin.pivot, Vec3(0.5, 0, 0));
  ASSERT_EQ(pin.motion.size(), 3u);
  EXPECT_EQ(pin.motion[0].translation, Vec3::Zero());
  EXPECT_EQ(pin.motion[1].time, 1);
  EXPECT_EQ(pin.motion[1].translation, Vec3(0, 1, 0));
  EXPECT_EQ(pin.motion[2].angles_deg, Vec3(0, 720, 0));
}

TEST(SceneReader, ReadsColliders) {
  const std::vector<ColliderSceneDesc> colliders = parse(kScene + kGrid + R"([[collider]]
shape = "sphere"
center = [0, 0.4, 0]
radius = 0.3
friction = 0
motion = [{ time = 0 }, { time = 2, position = [1, 0, 0] }]
[[collider]]
name = "slope"
shape = "plane"
point = [0, 1, 0]
normal = [3, 4, 0]
[[collider]]
shape = "plane"
)")
                                                       .colliders;
  ASSERT_EQ(colliders.size(), 3u);
  EXPECT_EQ(colliders[0].name, "collider");
  EXPECT_EQ(std::get<Sphere>(colliders[0].shape).center, Vec3(0, 0.4, 0));
  EXPECT_EQ(std::get<Sphere>(colliders[0].shape).radius, 0.3);
  EXPECT_EQ(colliders[0].friction, 0);
  EXPECT_EQ(colliders[0].motion.at(1).translation, Vec3(0.5, 0, 0));
  EXPECT_EQ(colliders[1].name, "slope");
  EXPECT_EQ(std::get<Plane>(colliders[1].shape).point, Vec3(0, 1, 0));
  // Rounding of one division.
  EXPECT_TRUE(std::get<Plane>(colliders[1].shape).normal.isApprox(Vec3(0.6, 0.8, 0), 1e-15));
  EXPECT_EQ(colliders[1].friction, Collider().friction);
  EXPECT_EQ(std::get<Plane>(colliders[2].shape).normal, Vec3::UnitY());
  EXPECT_TRUE(colliders[2].motion.is_still());
}

TEST(SceneReader, ReadsEveryKeyOfCapsulesAndBoxes) {
  const std::vector<ColliderSceneDesc> colliders = parse(kScene + kGrid + R"([[collider]]
shape = "capsule"
a = [0, 1, 0]
b = [0.5, 1, 0]
radius = 0.1
friction = 0.5
[[collider]]
name = "crate"
shape = "box"
center = [0, 1, 2]
half_size = [0.1, 0.2, 0.3]
rotation = [0, 90, 0]
motion = [{ time = 0 }, { time = 1, rotation = [0, 90, 0] }]
[[collider]]
shape = "box"
half_size = [1, 1, 1]
)")
                                                       .colliders;
  ASSERT_EQ(colliders.size(), 3u);
  const Capsule& capsule = std::get<Capsule>(colliders[0].shape);
  EXPECT_EQ(capsule.a, Vec3(0, 1, 0));
  EXPECT_EQ(capsule.b, Vec3(0.5, 1, 0));
  EXPECT_EQ(capsule.radius, 0.1);
  EXPECT_EQ(colliders[0].friction, 0.5);
  const PlacedBox& box = std::get<PlacedBox>(colliders[1].shape);
  EXPECT_EQ(colliders[1].name, "crate");
  EXPECT_EQ(box.center, Vec3(0, 1, 2));
  EXPECT_EQ(box.half_size, Vec3(0.1, 0.2, 0.3));
  EXPECT_EQ(box.rotation_deg, Vec3(0, 90, 0));
  EXPECT_FALSE(colliders[1].motion.is_still());
  EXPECT_EQ(std::get<PlacedBox>(colliders[2].shape).rotation_deg, Vec3(Vec3::Zero()));
}

TEST(SceneReader, FindsMeshesOfCollidersBesideTheScene) {
  const TemporaryFile mesh("scene_reader_test_body.obj");
  const std::string colliders = R"([[collider]]
shape = "mesh"
file = "scene_reader_test_body.obj"
up = "z"
scale = 0.01
position = [1, 2, 3]
rotation = [0, 0, 45]
)";
  const SceneDesc scene = parse_scene(kScene + kGrid + colliders, mesh.path().parent_path() / "scene.toml");
  const PlacedMesh& placed = std::get<PlacedMesh>(scene.colliders.at(0).shape);
  EXPECT_EQ(placed.source.file, mesh.path());
  EXPECT_TRUE(placed.source.up_is_z);
  EXPECT_EQ(placed.source.scale, 0.01);
  EXPECT_TRUE(placed.source.weld) << "a collider has no seams";
  EXPECT_EQ(placed.source.weld_distance, 0);
  EXPECT_EQ(placed.position, Vec3(1, 2, 3));
  EXPECT_EQ(placed.rotation_deg, Vec3(0, 0, 45));
}

TEST(SceneReader, ReadsSteadyWind) {
  const WindDesc wind = parse(kScene + kGrid + "[wind]\ndrag = 0.1\nvelocity = [1, 0, 2]\n").wind;
  EXPECT_EQ(wind.drag, 0.1);
  ASSERT_EQ(wind.keys.size(), 1u);
  EXPECT_EQ(wind.keys[0].velocity, Vec3(1, 0, 2));
}

TEST(SceneReader, ReadsWindThatChanges) {
  const WindDesc wind = parse(kScene + kGrid + R"([wind]
drag = 0.1
keys = [{ time = 0, velocity = [0, 0, 0] }, { time = 2, velocity = [5, 0, 0] }]
)")
                            .wind;
  ASSERT_EQ(wind.keys.size(), 2u);
  EXPECT_EQ(wind.keys[1].time, 2);
  EXPECT_EQ(wind.keys[1].velocity, Vec3(5, 0, 0));
}

TEST(SceneReader, ReadsEveryKeyOfTheSolver) {
  const SceneDesc scene = parse(kScene + kGrid + R"([solver]
integrator = "paper"
steps_per_frame = 100
iterations = 7
quality = "high"
tolerance = 1e-7
contact = false
explicit = { substeps = 12 }
paper = { damping_sign = "as_printed" }
)");
  EXPECT_EQ(scene.solver.integrator, "paper");
  EXPECT_EQ(scene.steps_per_frame, 100);
  EXPECT_EQ(scene.solver.implicit_euler.iterations, 7);
  EXPECT_EQ(scene.solver.newton.iterations, 7);
  EXPECT_EQ(scene.solver.newton.quality, NewtonQuality::high);
  EXPECT_EQ(scene.solver.implicit_euler.tolerance, 1e-7);
  EXPECT_FALSE(scene.contact);
  EXPECT_EQ(scene.solver.explicit_euler.substeps, 12);
  EXPECT_TRUE(scene.solver.paper.printed_damping_sign);
}

TEST(SceneReader, LeavesIterationsToTheIntegrator) {
  const SceneDesc scene = parse(kScene + kGrid + "[solver]\niterations = \"auto\"\n");
  EXPECT_EQ(scene.solver.newton.iterations, 0);
  EXPECT_EQ(scene.solver.implicit_euler.iterations, ImplicitEulerSettings{}.iterations);
}

TEST(SceneReader, KnowsEveryIntegrator) {
  for (const std::string_view name : integrator_names()) {
    const std::string solver = "[solver]\nintegrator = \"" + std::string(name) + "\"\n";
    EXPECT_EQ(parse(kScene + kGrid + solver).solver.integrator, name);
  }
}

TEST(SceneReader, NumbersSeveralClothsAndColliders) {
  const std::string ball = "[[collider]]\nshape = \"sphere\"\nradius = 1\n";
  const SceneDesc scene = parse(kScene + kGrid + kGrid + ball + ball);
  EXPECT_EQ(scene.cloths.at(0).name, "cloth");
  EXPECT_EQ(scene.cloths.at(1).name, "cloth 2");
  EXPECT_EQ(scene.colliders.at(1).name, "collider 2");
}

TEST(SceneReader, ReadsWindowsLineEndsAndByteOrderMark) {
  const SceneDesc scene = parse(
      "\xEF\xBB\xBF[scene]\r\nformat = 1\r\nfps = 30\r\n\r\n[[cloth]]\r\n"
      "grid = { size = [1, 1], cells = [4, 4] }\r\n");
  EXPECT_EQ(scene.fps, 30);
}

TEST(SceneReader, ReadsLettersOfEveryScript) {
  const SceneDesc scene =
      parse(kScene + "description = \"\"\"Ткань \\\n  über 布 🧵\"\"\"\n" + kGrid);
  EXPECT_EQ(scene.description, "Ткань über 布 🧵");
}

TEST(SceneReader, ReadsEveryShippedScene) {
  const std::filesystem::path folder = WEFT_SOURCE_DIR "/scenes";
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder)) {
    const std::filesystem::path& file = entry.path();
    if (file.extension() != ".toml") continue;
    const std::filesystem::path name = file.lexically_relative(folder).replace_extension();
    EXPECT_EQ(read_scene(file).name, name.generic_string());
  }
}

TEST(SceneReader, NamesScenesBelowAFolderOfScenes) {
  const auto name = [](const char* file) { return parse_scene(kScene + kGrid, file).name; };
  EXPECT_EQ(name("scenes/paper/fig6_ball.toml"), "paper/fig6_ball");
  EXPECT_EQ(name("my/scenes/flag.toml"), "flag");
  EXPECT_EQ(name("scenes/old/scenes/a/b/c.d.toml"), "a/b/c.d");
  EXPECT_EQ(name("scenes/../elsewhere/flag.toml"), "flag");
}

TEST(SceneOverrides, ReplaceAndAddValues) {
  EXPECT_EQ(set({"scene.fps=30"}).fps, 30);
  EXPECT_EQ(set({"scene.gravity=[0, -1.62, 0]"}).gravity, Vec3(0, -1.62, 0));
  EXPECT_EQ(set({"cloth[0].fabric.density=0.3"}).cloths[0].material.density, 0.3);
  EXPECT_EQ(set({"cloth[0].fabric={ density = 0.4 }"}).cloths[0].material.density, 0.4);
  EXPECT_TRUE(set({"solver.paper.damping_sign=as_printed"}).solver.paper.printed_damping_sign);
  EXPECT_FALSE(set({"solver.contact=false"}).contact);
}

TEST(SceneOverrides, TakeBareWordsForStrings) {
  EXPECT_EQ(set({"solver.integrator=desbrun"}).solver.integrator, "desbrun");
  EXPECT_EQ(set({"solver.integrator=\"desbrun\""}).solver.integrator, "desbrun");
  EXPECT_EQ(set({"scene.description=two words, a = b"}).description, "two words, a = b");
  EXPECT_EQ(set({"scene.description=C:\\cloth \"x\"\t\n"}).description, "C:\\cloth \"x\"\t\n");
  EXPECT_EQ(set({"scene.description="}).description, "");
}

TEST(SceneOverrides, ReachIntoLists) {
  EXPECT_EQ(set({"scene.gravity[1]=-1.62"}).gravity, Vec3(0, -1.62, 0));
  const std::vector<PinDesc> pins = set({"cloth[0].pins[1]=corner:1,1"}).cloths[0].pins;
  EXPECT_EQ(std::get<GridCorner>(pins[1].select).j, 1);
}

TEST(SceneOverrides, ComeOneAfterTheOther) {
  EXPECT_EQ(set({"scene.fps=30", "scene.fps=24"}).fps, 24);
  EXPECT_EQ(set({"wind.drag=1", "wind.velocity=[1, 0, 0]"}).wind.keys.at(0).velocity, Vec3(1, 0, 0));
}

TEST(SceneOverrides, AllowBlanksAroundTheEqualsSign) { EXPECT_EQ(set({"scene.fps = 30"}).fps, 30); }

TEST(SceneOverrides, CanMendABrokenScene) {
  EXPECT_EQ(parse("[scene]\nformat = 1\nfps = -1\n" + kGrid, {"scene.fps=30"}).fps, 30);
}

}  // namespace
}  // namespace weft::engine
