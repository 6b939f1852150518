/// Input validation of World: no input of a caller crashes it.

#include <gtest/gtest.h>

#include <limits>

#include "tests/support.h"
#include "weft/error.h"
#include "weft/mesh/sample_meshes.h"
#include "weft/world/world.h"

namespace weft::engine {
namespace {

using test::square;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

/// The message of the call's error; a failure if there is none.
template <class Call>
std::string error_of(const Call& call) {
  try {
    call();
  } catch (const InputError& error) {
    return error.what();
  }
  ADD_FAILURE() << "no InputError";
  return {};
}

void expect_names(const std::string& message, const std::string& part) {
  EXPECT_NE(message.find(part), std::string::npos) << message;
}

TriangleMesh tetrahedron() {
  return {{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}}};
}

TEST(WorldInput, ShapesThatCannotBe) {
  World world;
  const auto refused = [&](const ColliderShape& shape) {
    return error_of([&] { world.add_collider({.name = "it", .shape = shape}); });
  };
  expect_names(refused(Sphere{Vec3::Zero(), -1}),
               "collider \"it\": its radius must be more than 0 m, not -1");
  expect_names(refused(Sphere{Vec3::Zero(), kNan}), "radius");
  expect_names(refused(Sphere{Vec3(0, kNan, 0), 1}), "centre");
  expect_names(refused(Plane{Vec3::Zero(), Vec3(0, 5, 0)}),
               "its normal must have length 1, but is (0, 5, 0)");
  expect_names(refused(Plane{Vec3::Zero(), Vec3::Zero()}), "normal");
  expect_names(refused(Capsule{Vec3::Zero(), Vec3(0, kNan, 0), 1}), "its end b");
  expect_names(refused(OrientedBox{Vec3::Zero(), Vec3(1, 0, 1), Mat3::Identity()}), "half size");
  expect_names(refused(OrientedBox{Vec3::Zero(), Vec3::Ones(), 2 * Mat3::Identity()}), "rotation");
  expect_names(refused(MeshShape{}), "it has no mesh");
  const auto mesh = [&](TriangleMesh m) {
    return refused(MeshShape{.mesh = std::make_shared<const TriangleMesh>(std::move(m))});
  };
  expect_names(mesh({}), "no triangles");
  expect_names(mesh({{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 3}}}), "triangle 0 uses vertex 3");
  expect_names(mesh({{{0, 0, 0}, {1, 0, kNan}, {0, 1, 0}}, {{0, 1, 2}}}), "vertex 1");
  EXPECT_EQ(world.num_colliders(), 0);
}

TEST(WorldInput, ClothThatCannotBe) {
  World world;
  expect_names(error_of([&] { world.add_cloth({.name = "it"}); }), "cloth \"it\" has no topology");
  EXPECT_THROW(build_mesh_topology(TriangleMesh{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 7}}}), InputError);
  EXPECT_THROW(build_grid_topology({.size_x = 0}, SpringModel::simplified), InputError);
  EXPECT_THROW(build_grid_topology({.cells_z = 0}, SpringModel::simplified), InputError);
  const auto sheet = build_grid_topology(square(4), SpringModel::simplified);
  const auto refused = [&](const auto& change) {
    ClothTopology changed = *sheet;
    change(changed);
    return error_of([&] { world.add_cloth({.topology = std::make_shared<const ClothTopology>(changed)}); });
  };
  expect_names(refused([](ClothTopology& t) { t.mesh.triangles[3][1] = 99; }), "triangle 3 uses vertex 99");
  expect_names(refused([](ClothTopology& t) { t.springs[2].j = -1; }), "a spring joins");
  expect_names(refused([](ClothTopology& t) { t.area.pop_back(); }), "area");
  expect_names(refused([](ClothTopology& t) { t.area[5] = 0; }), "particle 5 has no area");
  expect_names(error_of([&] { world.add_cloth({.topology = sheet, .velocity = Vec3(kNan, 0, 0)}); }),
               "velocity");
  EXPECT_EQ(world.num_cloths(), 0);
}

TEST(WorldInput, NamesDifferWhereARuleNeedsThem) {
  World world;
  const auto sheet = build_grid_topology(square(2), SpringModel::simplified);
  const ClothId first = world.add_cloth({.topology = sheet}), second = world.add_cloth({.topology = sheet});
  EXPECT_EQ(world.name(first), "cloth");
  EXPECT_EQ(world.name(second), "cloth 2");
  EXPECT_EQ(world.collider(world.add_collider({.shape = Sphere{}})).name, "collider");
  for (int n = 0; n < 2; ++n) world.add_collider({.name = "table", .shape = Sphere{}});
  expect_names(error_of([&] { world.set_friction("cloth", "table", 0.5); }), "2 bodies are named \"table\"");
}

TEST(WorldInput, NumbersThatAreNone) {
  World world;
  EXPECT_THROW(world.set_jobs(nullptr), InputError);
  EXPECT_THROW(world.set_gravity(Vec3(0, kNan, 0)), InputError);
  EXPECT_THROW(world.set_wind({.velocity = Vec3(kNan, 0, 0)}), InputError);
  EXPECT_THROW(world.set_wind({.velocity = Vec3::Zero(), .drag = -1}), InputError);
  EXPECT_THROW(RigidMotion(std::vector<KeyFrame>{{.time = kNan}}), InputError);
  const ColliderId ball = world.add_collider({.name = "ball", .shape = Sphere{}});
  EXPECT_THROW(world.set_collider_friction(ball, -1), InputError);
  EXPECT_THROW(world.move_collider(ball, {.rotation = Mat3::Zero()}), InputError);
  EXPECT_THROW(world.place_collider(ball, {.translation = Vec3(kNan, 0, 0)}), InputError);
  expect_names(error_of([&] { world.move_vertices(ball, {}); }), "it is not a mesh");
  const ColliderId solid = world.add_collider(
      {.name = "solid", .shape = MeshShape{.mesh = std::make_shared<const TriangleMesh>(tetrahedron())}});
  expect_names(error_of([&] { world.move_vertices(solid, {Vec3::Zero()}); }), "expected 4 vertices, got 1");
  world.add_cloth({.topology = build_grid_topology(square(2), SpringModel::simplified)});
  EXPECT_TRUE(world.step(1.0 / 60).ok);
}

TEST(WorldInput, IdsOfNothingOfOthersAndOfWhatIsGone) {
  World world, other;
  const auto sheet = build_grid_topology(square(2), SpringModel::simplified);
  const ClothId cloth = world.add_cloth({.topology = sheet});
  const ColliderId ball = world.add_collider({.shape = Sphere{}});
  const ClothId foreign = other.add_cloth({.topology = sheet});
  expect_names(error_of([&] { world.state(ClothId()); }), "this ClothId is empty");
  expect_names(error_of([&] { world.set_pins(foreign, {}); }), "this ClothId belongs to another world");
  EXPECT_FALSE(world.contains(foreign));
  EXPECT_FALSE(world.contains(ClothId()));
  EXPECT_TRUE(world.contains(cloth));
  EXPECT_TRUE(world.contains(ball));
  world.remove(cloth);
  world.remove(ball);
  EXPECT_FALSE(world.contains(cloth));
  EXPECT_FALSE(world.contains(ball));
  expect_names(error_of([&] { world.state(cloth); }), "removed");
  expect_names(error_of([&] { world.remove(cloth); }), "removed");
  expect_names(error_of([&] { world.place_collider(ball, {}); }), "this ColliderId (number 2)");
  const ClothId next = world.add_cloth({.topology = sheet});
  EXPECT_NE(next, cloth);
  EXPECT_FALSE(world.contains(cloth));
  EXPECT_THROW(world.cloth(1), InputError);
  EXPECT_THROW(world.collider(-1), InputError);
  EXPECT_EQ(world.cloth(0), next);
}

}  // namespace
}  // namespace weft::engine
