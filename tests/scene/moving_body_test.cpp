/// Bodies that move by a glTF file, and cloth that holds on to them.

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <functional>
#include <numeric>

#include "tests/io/gltf_builder.h"
#include "tests/own_folder.h"
#include "weft/io.h"
#include "weft/scene/scene_reader.h"
#include "weft/scene/scene_world.h"
#include "weft/world.h"

namespace weft {
namespace {

namespace fs = std::filesystem;
using engine::test::Floats;
using engine::test::GltfBuilder;
using engine::test::operator+;

constexpr int kCells = 10;     // along the arm, and half as many across
constexpr double kLength = 1;  // of the arm, along x from 0 [m]

/// A flat arm, whose outer half turns about z at x = 0.5 by 90 degrees from 1 to 2 s; every vertex is moved by
/// two joints with weights that change along it.
GltfBuilder make_bending_arm() {
  GltfBuilder file;
  Floats position, weights;
  std::vector<std::uint8_t> joints;
  for (int j = 0; j <= kCells / 2; ++j) {
    for (int i = 0; i <= kCells; ++i) {
      const float x = static_cast<float>(kLength * i / kCells);
      position = position + Floats{x, 0, static_cast<float>(kLength * j / kCells)};
      weights = weights + Floats{1 - x, x, 0, 0};
      joints.insert(joints.end(), {0, 1, 0, 0});
    }
  }
  std::vector<std::uint16_t> indices;
  for (int j = 0; j < kCells / 2; ++j) {
    for (int i = 0; i < kCells; ++i) {
      const int a = j * (kCells + 1) + i, b = a + kCells + 1;
      for (const int v : {a, b, a + 1, a + 1, b, b + 1}) indices.push_back(static_cast<std::uint16_t>(v));
    }
  }
  const auto half = static_cast<float>(std::sqrt(0.5));
  file.add("meshes", {{"primitives",
                       {{{"attributes",
                          {{"POSITION", file.add_floats("VEC3", position)},
                           {"JOINTS_0", file.add_accessor("VEC4", joints)},
                           {"WEIGHTS_0", file.add_floats("VEC4", weights)}}},
                         {"indices", file.add_accessor("SCALAR", indices)}}}}});
  file.json["nodes"] = {{{"name", "shoulder"}, {"children", {1}}},
                        {{"name", "elbow"}, {"translation", {0.5, 0, 0}}},
                        {{"name", "arm"}, {"mesh", 0}, {"skin", 0}}};
  file.add(
      "skins",
      {{"joints", {0, 1}},
       {"inverseBindMatrices",
        file.add_floats("MAT4", engine::test::kIdentity + engine::test::translation_matrix(-0.5f, 0, 0))}});
  file.add("scenes", {{"nodes", {0, 2}}});
  file.json["scene"] = 0;
  file.add("animations", {{"name", "bend"}});
  file.add_channel(0, 1, "rotation", file.add_floats("SCALAR", {1, 2}),
                   file.add_floats("VEC4", {0, 0, 0, 1, 0, 0, half, half}));
  return file;
}

/// The exact position of the arm's point (x, z) when the elbow has turned by an angle.
Vec3 bent(double x, double z, double angle) {
  const double outer_x = 0.5 + std::cos(angle) * (x - 0.5), outer_y = std::sin(angle) * (x - 0.5);
  return {(1 - x) * x + x * outer_x, x * outer_y, z};
}

class MovingBody : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = engine::make_own_folder();
    std::ofstream(folder_ / "arm.glb", std::ios::binary) << make_bending_arm().glb();
  }
  std::string arm() const { return (folder_ / "arm.glb").string(); }

  ColliderDesc describe_arm(double start_time = 1) const {
    const BodyFromFile body = read_gltf(arm());
    return {.name = "arm", .shape = body.mesh, .deformation = body.motion, .deformation_start = start_time};
  }

  engine::SceneDesc parse(const std::string& text) const {
    return engine::parse_scene(text, folder_ / "scene.toml");
  }

  fs::path folder_;
};

/// A small sheet 13 mm above the outer half of the arm.
ClothDesc describe_sheet() {
  return {.name = "sheet",
          .shape = Grid{.size_x = 0.2, .size_z = 0.2, .cells_x = 4, .cells_z = 4},
          .pose = {.translation = {0.62, 0.013, 0.13}}};
}

std::vector<int> first_row() { return {0, 1, 2, 3, 4}; }

using Point = std::array<double, 3>;
Point operator-(const Point& a, const Point& b) { return {a[0] - b[0], a[1] - b[1], a[2] - b[2]}; }
double dot(const Point& a, const Point& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
Point cross(const Point& a, const Point& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
Point unit(Point a) {
  const double length = std::sqrt(dot(a, a));
  for (double& c : a) c /= length;
  return a;
}
Point to_point(const Vec3& p) { return {p.x, p.y, p.z}; }

/// Corners of the triangle of a cell that has the point (x, z) of the flat arm.
std::array<Point, 3> triangle_at(double x, double z, double angle) {
  const int i = static_cast<int>(x * kCells), j = static_cast<int>(z * kCells);
  const auto corner = [&](int ci, int cj) {
    return to_point(bent(kLength * ci / kCells, kLength * cj / kCells, angle));
  };
  const bool is_first = (x * kCells - i) + (z * kCells - j) < 1;
  if (is_first) return {corner(i, j), corner(i, j + 1), corner(i + 1, j)};
  return {corner(i + 1, j), corner(i, j + 1), corner(i + 1, j + 1)};
}

/// The point of the triangle at these weights, moved by a height along its normal.
Point above(const std::array<Point, 3>& t, const std::array<double, 3>& weights, double height) {
  const Point normal = unit(cross(t[1] - t[0], t[2] - t[0]));
  Point p = {};
  for (int c = 0; c < 3; ++c) {
    for (int k = 0; k < 3; ++k) p[c] += weights[k] * t[k][c];
    p[c] += height * normal[c];
  }
  return p;
}

/// Weights of the point (x, z) of the flat arm in its triangle.
std::array<double, 3> weights_at(double x, double z) {
  const double u = x * kCells - std::floor(x * kCells), v = z * kCells - std::floor(z * kCells);
  if (u + v < 1) return {1 - u - v, v, u};
  return {1 - v, 1 - u, u + v - 1};
}

TEST_F(MovingBody, IsEvaluatedAtEveryTime) {
  const BodyFromFile body = read_gltf(arm());
  EXPECT_EQ(body.clip, "bend");
  EXPECT_EQ(body.motion.num_vertices(), 66);
  EXPECT_EQ(body.motion.start(), 1);
  EXPECT_EQ(body.motion.end(), 2);
  World world;
  const ColliderId id = world.add_collider(describe_arm());
  ASSERT_TRUE(world.contains(id));
  // A third of the way in time is a third of the angle, and the vertices are on arcs.
  for (const double share : {0.0, 1.0 / 3, 0.77, 1.0}) {
    const std::vector<Vec3> positions = body.motion.positions(1 + share);
    for (int v = 0; v < 66; ++v) {
      const Vec3 exact =
          bent(kLength * (v % 11) / kCells, kLength * (v / 11) / kCells, share * std::acos(-1.0) / 2);
      EXPECT_NEAR(positions[v].x, exact.x, 1e-6);
      EXPECT_NEAR(positions[v].y, exact.y, 1e-6);
      EXPECT_NEAR(positions[v].z, exact.z, 1e-6);
    }
  }
}

TEST_F(MovingBody, LiftsClothThatLiesOnIt) {
  World world;
  ColliderDesc arm = describe_arm();
  arm.friction = 5;
  world.add_collider(arm);
  ClothDesc sheet = describe_sheet();
  sheet.pose.translation.y = 0.002;
  const ClothId cloth = world.add_cloth(sheet);
  double lowest = 1;
  for (int frame = 0; frame < 20; ++frame) ASSERT_TRUE(world.step(1.0 / 60).ok);
  for (const Vec3& p : world.positions(cloth)) lowest = std::min(lowest, p.y);
  // At 1/3 s the arm's point under the sheet's inner edge has risen by this much.
  EXPECT_GT(lowest, 0.8 * bent(0.62, 0, 30 * std::acos(-1.0) / 180).y);
}

TEST_F(MovingBody, CarriesPinsAtTheirOffsetFromItsSurface) {
  for (const bool is_soft : {false, true}) {
    World world;
    const ColliderId arm = world.add_collider(describe_arm(0.5));
    const ClothId cloth = world.add_cloth(describe_sheet());
    const std::vector<Vec3> start = world.positions(cloth);
    Pin pin{.particles = first_row(), .follow = arm};
    if (is_soft) pin.stiffness = 1e6;
    world.set_pins(cloth, {pin});
    double farthest = 0;
    for (int frame = 1; frame <= 300; ++frame) {
      ASSERT_TRUE(world.step(1.0 / 120).ok);
      const double share = std::min(1.0, std::max(0.0, frame / 120.0 - 0.5));
      const std::vector<Vec3> now = world.positions(cloth);
      for (const int i : first_row()) {
        const auto [x, y, z] = to_point(start[i]);
        const Point expected = above(triangle_at(x, z, share * std::acos(-1.0) / 2), weights_at(x, z), y);
        const Point off = to_point(now[i]) - expected;
        farthest = std::max(farthest, std::sqrt(dot(off, off)));
      }
    }
    EXPECT_LT(farthest, is_soft ? 1e-3 : 1e-6) << (is_soft ? "with a stiffness" : "held exactly");
  }
}

TEST_F(MovingBody, CarriesPinsFromWhereClothWasPlaced) {
  for (const bool is_soft : {false, true}) {
    World world;
    const ColliderId arm = world.add_collider(describe_arm());
    const ClothId cloth = world.add_cloth(describe_sheet());
    Pin pin{.particles = first_row(), .follow = arm};
    if (is_soft) pin.stiffness = 1e6;
    world.set_pins(cloth, {pin});
    std::vector<Vec3> placed = world.positions(cloth);
    for (Vec3& p : placed) p.y += 0.05;
    world.set_positions(cloth, placed);
    ASSERT_TRUE(world.step(1.0 / 60).ok);
    // In 1/60 s the elbow turns by 1.5 degrees.
    const std::array<double, 3> weights = weights_at(placed[0].x, placed[0].z);
    const Point expected =
        above(triangle_at(placed[0].x, placed[0].z, std::acos(-1.0) / 120), weights, placed[0].y);
    const Point off = to_point(world.positions(cloth)[0]) - expected;
    EXPECT_LT(std::sqrt(dot(off, off)), is_soft ? 1e-3 : 1e-6)
        << (is_soft ? "with a stiffness" : "held exactly");
  }
}

TEST_F(MovingBody, DoesNotCollideWithThePinsThatFollowIt) {
  World world;
  const ColliderId arm = world.add_collider(describe_arm());
  ClothDesc sheet = describe_sheet();
  sheet.pose.translation.y = 1e-4;  // less than half of the thickness
  const ClothId cloth = world.add_cloth(sheet);
  std::vector<int> all(25);
  std::iota(all.begin(), all.end(), 0);
  world.set_pins(cloth, {{.particles = all, .follow = arm}});
  for (int frame = 0; frame < 60; ++frame) {
    const StepReport report = world.step(1.0 / 60);
    ASSERT_TRUE(report.ok);
    ASSERT_TRUE(report.infeasible.empty()) << "frame " << frame;
  }
}

TEST_F(MovingBody, CarriesPinsOfRigidShapes) {
  World world;
  const ColliderId ball = world.add_collider(
      {.name = "ball",
       .shape = Sphere{.center = {0, 0, 0}, .radius = 0.1},
       .motion = {{.time = 0}, {.time = 1, .translation = {0.3, 0.2, 0}, .angles_deg = {0, 0, 90}}}});
  ClothDesc sheet = describe_sheet();
  sheet.pose.translation = {-0.1, 0.11, 0};
  const ClothId cloth = world.add_cloth(sheet);
  world.set_pins(cloth, {{.particles = {0}, .follow = ball}});
  for (int frame = 0; frame < 60; ++frame) ASSERT_TRUE(world.step(1.0 / 60).ok);
  const Vec3 p = world.positions(cloth)[0];
  EXPECT_NEAR(p.x, 0.3 - 0.11, 1e-6);
  EXPECT_NEAR(p.y, 0.2 - 0.1, 1e-6);
  EXPECT_NEAR(p.z, 0, 1e-6);
  // When the body goes, the pin stays.
  world.remove(ball);
  ASSERT_TRUE(world.step(1.0 / 60).ok);
  EXPECT_EQ(world.positions(cloth)[0].x, p.x);
}

TEST_F(MovingBody, ContinuesWithTheSameBitsAfterSaveAndLoad) {
  for (const bool is_soft : {false, true}) {
    World world;
    const ColliderId arm = world.add_collider(describe_arm());
    const ClothId cloth = world.add_cloth(describe_sheet());
    Pin pin{.particles = first_row(), .follow = arm};
    if (is_soft) pin.stiffness = 500;
    world.set_pins(cloth, {pin});
    for (int frame = 0; frame < 20; ++frame) world.step(1.0 / 60);
    const std::vector<std::byte> bytes = world.save();
    World loaded = World::load(bytes), copy = world.clone();
    const Snapshot snapshot = world.snapshot();
    for (int frame = 0; frame < 20; ++frame) {
      world.step(1.0 / 60);
      loaded.step(1.0 / 60);
      copy.step(1.0 / 60);
      ASSERT_EQ(loaded.state_hash(), world.state_hash()) << frame;
      ASSERT_EQ(copy.state_hash(), world.state_hash()) << frame;
    }
    EXPECT_EQ(loaded.save(), world.save());
    copy = world.clone();
    world.restore(snapshot);
    for (int frame = 0; frame < 20; ++frame) world.step(1.0 / 60);
    EXPECT_EQ(copy.state_hash(), world.state_hash());
    // Bytes with one error are refused, or have another checksum; none crash.
    for (std::size_t k = 0; k < bytes.size(); k += 97) {
      std::vector<std::byte> damaged = bytes;
      damaged[k] ^= std::byte{0x40};
      EXPECT_THROW(World::load(damaged), InputError);
    }
  }
}

TEST_F(MovingBody, IsMovedByHandFromWhereItIs) {
  World world;
  const ColliderId arm = world.add_collider(describe_arm());
  for (int frame = 0; frame < 10; ++frame) world.step(1.0 / 60);
  const std::vector<Vec3> now = read_gltf(this->arm()).motion.positions(1 + world.time());
  world.move_vertices(arm, now);
  const World loaded = World::load(world.save());
  EXPECT_EQ(loaded.state_hash(), world.state_hash());
  const ClothId cloth = world.add_cloth(describe_sheet());
  ASSERT_TRUE(world.step(1.0 / 60).ok);
  EXPECT_TRUE(world.contains(cloth));
}

std::string complaint(const std::function<void()>& call) {
  try {
    call();
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

TEST_F(MovingBody, NamesMistakes) {
  World world;
  ColliderDesc desc = describe_arm();
  desc.frames = {{.time = 0, .positions = std::get<TriangleMesh>(desc.shape).positions}};
  EXPECT_EQ(complaint([&] { world.add_collider(desc); }),
            "collider \"arm\": has both frames and a deformation; expected one of them");
  desc.frames.clear();
  std::get<TriangleMesh>(desc.shape).positions.push_back({0, 0, 0});
  EXPECT_EQ(complaint([&] { world.add_collider(desc); }),
            "collider \"arm\": its deformation has 66 vertices, the mesh 67");
  desc.shape = Sphere{};
  EXPECT_EQ(complaint([&] { world.add_collider(desc); }),
            "collider \"arm\": only a mesh can have frames or a deformation");
  const ColliderId arm = world.add_collider(describe_arm());
  const ClothId cloth = world.add_cloth(describe_sheet());
  EXPECT_EQ(
      complaint([&] { world.set_pins(cloth, {{.particles = {0}, .motion = {{.time = 0}}, .follow = arm}}); }),
      "cloth \"sheet\": a pin that follows a collider has no motion of its own");
  world.remove(arm);
  EXPECT_EQ(complaint([&] { world.set_pins(cloth, {{.particles = {0}, .follow = arm}}); }),
            "this ColliderId (number 1) refers to a removed body");
}

TEST_F(MovingBody, StandsInScenes) {
  const std::string scene = R"([scene]
format = 1
duration = 1
[[cloth]]
name = "sheet"
grid = { size = [0.2, 0.2], cells = [4, 4] }
position = [0.62, 0.013, 0.13]
pins = ["index:24", { select = { index = [0, 1, 2, 3, 4] }, follow = "arm" }]
[[collider]]
name = "arm"
shape = "mesh"
file = "arm.glb"
node = "arm"
clip = "bend"
start_time = 1.5
scale = 2
position = [-0.62, 0, 0]
)";
  const engine::SceneDesc read = parse(scene);
  EXPECT_EQ(read.cloths[0].pins[1].follow, "arm");
  weft::World world = std::move(engine::build_scene(read, make_serial_jobs()).world);
  const Vec3 start = world.positions(world.cloth(0))[0];
  for (int frame = 0; frame < 30; ++frame) ASSERT_TRUE(world.step(1.0 / 60).ok);
  const Vec3 end = world.positions(world.cloth(0))[0];
  EXPECT_GT(end.y - start.y, 0.08) << "the arm turns from 45 to 90 degrees";
  const auto mistakes = [&](const std::string& from, const std::string& to) {
    std::string text = scene;
    text.replace(text.find(from), from.size(), to);
    return complaint([&] { engine::build_scene(parse(text), make_serial_jobs()); });
  };
  EXPECT_EQ(mistakes("follow = \"arm\"", "follow = \"arms\""),
            "cloth \"sheet\": a pin follows \"arms\", but there is no collider of this name; did you mean "
            "\"arm\"?");
  EXPECT_NE(
      mistakes("clip = \"bend\"", "clip = \"walk\"").find("no clip is named \"walk\"; available: \"bend\""),
      std::string::npos)
      << mistakes("clip = \"bend\"", "clip = \"walk\"");
  EXPECT_NE(mistakes("scale = 2", "up = \"z\"").find("a glTF file has its y axis up"), std::string::npos);
  EXPECT_NE(mistakes("follow = \"arm\"", "follow = \"arm\", damping = 1").find("requires stiffness"),
            std::string::npos);
  EXPECT_NE(mistakes("follow = \"arm\"", "follow = \"arm\", motion = [{ time = 0 }]")
                .find("has no motion of its own"),
            std::string::npos);
  const engine::SceneDesc late = parse(std::string(scene).replace(scene.find("1.5"), 3, "2.5"));
  const auto warnings = engine::build_scene(late, make_serial_jobs()).warnings;
  EXPECT_TRUE(std::ranges::any_of(warnings, [](const std::string& w) {
    return w == "collider \"arm\" (arm.glb): start_time = 2.5 is outside the clip, which lasts from 1 to 2 s";
  }));
}

}  // namespace
}  // namespace weft
