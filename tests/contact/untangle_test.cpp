/// Repair of intersected cloth, validated by the independent checker.

#include "weft/contact/untangle.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <span>

#include "tests/support.h"
#include "weft/mesh/clean.h"
#include "weft/mesh/sample_meshes.h"
#include "weft/run/frame_checks.h"
#include "weft/world/measures.h"

namespace weft::engine {
namespace {

const ClothMaterial kCotton{.structural = 200, .shear = 60, .bend = 0.5, .damping = 2e-3, .thickness = 2e-3};

ClothId add_sheet(World& world, const std::string& name, const Vec3& middle, const Vec3& angles_deg,
                  double size = 0.4, int cells = 16) {
  const auto topology = build_grid_topology(test::square(cells, size), SpringModel::alternating);
  const Mat3 turn = rotation_from_angles_deg(angles_deg);
  std::vector<Vec3> positions;
  for (const Vec3& p : topology->mesh.positions)
    positions.push_back(middle + turn * (p - Vec3(size / 2, 0, size / 2)));
  return world.add_cloth({.name = name, .topology = topology, .material = kCotton, .positions = positions});
}

verify::FrameCheck check(const World& world) {
  return verify::check_frame(WorldFrames(world).now().frame, 1);
}

double largest_strain(const World& world, ClothId cloth) {
  return compute_strain(world.model(cloth), world.state(cloth)).max;
}

/// Repairs the intersections, and checks that none occurs in any frame of the next second and a half.
void expect_untangled(World& world, const std::string& what_crossed) {
  ASSERT_TRUE(check(world).intersections > 0 || check(world).penetration() > 1e-3)
      << "else nothing is tested";
  const UntangleReport report = world.untangle();
  ASSERT_FALSE(report.crossed.empty());
  EXPECT_NE(report.crossed[0].find(what_crossed), std::string::npos) << report.crossed[0];
  for (const std::string& left : report.left) ADD_FAILURE() << left;
  testing::Test::RecordProperty("rounds", report.rounds);
  testing::Test::RecordProperty("farthest_mm", std::to_string(1000 * report.farthest));
  EXPECT_EQ(check(world).intersections, 0);
  for (int frame = 0; frame < 90; ++frame) {
    const StepReport step = world.step(1.0 / 60);
    ASSERT_TRUE(step.ok);
    EXPECT_TRUE(step.infeasible.empty()) << frame;
    ASSERT_EQ(check(world).intersections, 0) << frame;
    ASSERT_LE(check(world).penetration(), 1e-6) << frame;
  }
}

TEST(Untangle, CrossedPlanesOfClothGoApart) {
  World world;
  // Upright, with its lowest quarter below the level one.
  const ClothId upright = add_sheet(world, "upright", {0.013, 0.1, 0.007}, {90, 0, 0}, 0.35, 14);
  const ClothId level = add_sheet(world, "level", {0, 0, 0}, {0, 0, 0}, 0.5, 20);
  world.set_pins(level, {{{0, 20, 440 - 20, 440}, {}, Vec3::Zero()}});
  expect_untangled(world, "cloth \"upright\"");
  (void)upright;
}

TEST(Untangle, StripsThatCrossInTheMiddleGoApart) {
  World world;
  add_sheet(world, "a", {0, 0, 0}, {0, 0, 12}, 0.4, 16);
  add_sheet(world, "b", {0.011, 0.003, 0.005}, {0, 0, -12}, 0.4, 15);
  world.add_collider({"floor", Plane{Vec3(0, -0.3, 0), Vec3::UnitY()}, 0.3, {}});
  expect_untangled(world, "cloth \"a\"");
}

TEST(Untangle, ClothPartlyInABallComesOut) {
  for (const double height : {0.1, 0.0}) {
    World world;
    world.add_collider({"ball", Sphere{Vec3::Zero(), 0.12}, 0.3, {}});
    const ClothId sheet = add_sheet(world, "sheet", {0.07, height, 0.02}, {5, 0, 0});
    expect_untangled(world, "inside collider \"ball\"");
    EXPECT_LT(largest_strain(world, sheet), 0.3) << "it has not torn";
  }
}

TEST(Untangle, ClothPartlyInAClosedMeshComesOut) {
  World world;
  MeshShape shape;
  shape.mesh = std::make_shared<const TriangleMesh>(make_sphere_mesh(Vec3::Zero(), 0.12, 12));
  world.add_collider({"rock", shape, 0.3, {}});
  add_sheet(world, "sheet", {0.05, 0.08, 0.02}, {5, 0, 0});
  expect_untangled(world, "cloth \"sheet\"");
}

TEST(Untangle, ClothPartlyInTheClosedShellOfAMeshComesOut) {
  TriangleMesh mesh = make_sphere_mesh(Vec3::Zero(), 0.12, 12);
  const int first = mesh.num_vertices();  // and a card beside it, as of hair
  for (const Vec3& p : {Vec3(-0.3, 0, 0), Vec3(-0.25, 0, 0), Vec3(-0.3, 0, 0.05)})
    mesh.positions.push_back(p);
  mesh.triangles.push_back({first, first + 1, first + 2});
  World world;
  world.add_collider({"rock", MeshShape{.mesh = std::make_shared<const TriangleMesh>(mesh)}, 0.3, {}});
  add_sheet(world, "sheet", {0.05, 0.08, 0.02}, {5, 0, 0});
  expect_untangled(world, "cloth \"sheet\"");
}

/// A sheet bent over by `turn_deg` around an edge, so that its end comes back through the rest.
TEST(Untangle, AFoldThroughItselfComesOut) {
  const auto topology = build_grid_topology({.size_x = 0.7, .size_z = 0.2, .cells_x = 35, .cells_z = 10},
                                            SpringModel::alternating);
  std::vector<Vec3> positions;
  for (const Vec3& p : topology->mesh.positions) {
    // Straight, then around a circle of 0.05 m by 240 degrees, then straight again: through the first part.
    constexpr double kRadius = 0.05, kStart = 0.3, kTurn = 240 * 3.14159265358979 / 180;
    const double s = std::max(0.0, p.x() - kStart), arc = std::min(s / kRadius, kTurn),
                 rest = s - arc * kRadius;
    positions.push_back({std::min(p.x(), kStart) + kRadius * std::sin(arc) + rest * std::cos(arc),
                         kRadius * (1 - std::cos(arc)) + rest * std::sin(arc), p.z()});
  }
  World world;
  world.add_collider({"floor", Plane{Vec3(0, -0.2, 0), Vec3::UnitY()}, 0.3, {}});
  world.add_cloth({.name = "fold", .topology = topology, .material = kCotton, .positions = positions});
  expect_untangled(world, "cloth \"fold\"");
}

/// A tube of cloth along x.
TriangleMesh make_sleeve(double radius, double length, int num_around, int num_along) {
  TriangleMesh mesh;
  for (int i = 0; i <= num_along; ++i) {
    for (int k = 0; k < num_around; ++k) {
      const double angle = 2 * 3.141592653589793 * k / num_around;
      mesh.positions.push_back({length * (static_cast<double>(i) / num_along - 0.5), radius * std::cos(angle),
                                radius * std::sin(angle)});
    }
  }
  for (int i = 0; i < num_along; ++i) {
    for (int k = 0; k < num_around; ++k) {
      const int a = i * num_around + k, b = i * num_around + (k + 1) % num_around;
      mesh.triangles.insert(mesh.triangles.end(),
                            {{a, b, a + num_around}, {b, b + num_around, a + num_around}});
    }
  }
  return mesh;
}

TEST(Untangle, AnArmHalfOutsideItsSleeveIsPutIntoIt) {
  constexpr double kArm = 0.04, kSleeve = 0.046, kAside = 0.03;
  World world;
  const TriangleMesh arm = make_capsule_mesh({-0.3, 0, 0}, {0.3, 0, 0}, kArm, 24);
  const CleanMesh closed = clean_mesh(arm, {.weld_distance = 0});
  world.add_collider({"arm", MeshShape{.mesh = std::make_shared<const TriangleMesh>(closed.mesh)}, 0.3, {}});
  const TriangleMesh sleeve = make_sleeve(kSleeve, 0.35, 36, 40);
  std::vector<Vec3> positions = sleeve.positions;
  for (Vec3& p : positions) p.y() += kAside;
  const ClothId id = world.add_cloth({.name = "sleeve",
                                      .topology = build_mesh_topology(sleeve),
                                      .material = kCotton,
                                      .positions = positions});
  const UntangleReport report = world.untangle();
  EXPECT_FALSE(report.crossed.empty());
  for (const std::string& left : report.left) ADD_FAILURE() << left;
  EXPECT_EQ(check(world).intersections, 0);
  EXPECT_LT(largest_strain(world, id), 0.1);
  double above = 0, below = 0;
  for (int k = 0; k < 36; ++k) {  // the middle ring is around the arm
    const Vec3 p = world.state(id).position(20 * 36 + k);
    above = std::max(above, p.y());
    below = std::min(below, p.y());
  }
  EXPECT_GT(above, kArm);
  EXPECT_LT(below, -kArm);
}

struct Sleeve {
  double radius, aside;  // [m]
  int layer;
};

constexpr int kAround = 36, kAlong = 30;

/// Sleeves of the same length around an arm of 40 mm along x.
std::vector<ClothId> add_sleeves(World& world, std::span<const Sleeve> sleeves) {
  const TriangleMesh arm = make_capsule_mesh({-0.3, 0, 0}, {0.3, 0, 0}, 0.04, 24);
  const CleanMesh closed = clean_mesh(arm, {.weld_distance = 0});
  world.add_collider({"arm", MeshShape{.mesh = std::make_shared<const TriangleMesh>(closed.mesh)}, 0.3, {}});
  std::vector<ClothId> ids;
  for (const Sleeve& sleeve : sleeves) {
    const TriangleMesh mesh = make_sleeve(sleeve.radius, 0.25, kAround, kAlong);
    std::vector<Vec3> positions = mesh.positions;
    for (Vec3& p : positions) p.y() += sleeve.aside;
    ids.push_back(world.add_cloth({.name = "sleeve " + std::to_string(ids.size()),
                                   .topology = build_mesh_topology(mesh),
                                   .material = kCotton,
                                   .positions = positions,
                                   .layer = sleeve.layer}));
  }
  return ids;
}

/// Rays from the arm's axis meet `inner` before `outer`, everywhere but at their ends.
void expect_order(const World& world, ClothId inner, ClothId outer) {
  const auto positions = [&](ClothId id) { return positions_of(world.state(id)); };
  const std::vector<Vec3> in = positions(inner), out = positions(outer);
  const std::vector<Triangle>& triangles = world.model(inner).topology->mesh.triangles;
  const auto meets = [](const Vec3& from, const Vec3& to, const std::vector<Vec3>& x, const Triangle& t) {
    Mat3 m;
    m << x[t[1]] - x[t[0]], x[t[2]] - x[t[0]], from - to;
    const Vec3 uvs = m.inverse() * (from - x[t[0]]);
    return uvs.minCoeff() >= 0 && uvs.x() + uvs.y() <= 1 && uvs.z() <= 1;
  };
  for (int v = 3 * kAround; v < (kAlong - 2) * kAround; ++v) {
    const Vec3 axis(out[v].x(), 0, 0);
    const auto count = [&](const Vec3& from, const Vec3& to) {
      return std::ranges::count_if(triangles, [&](const Triangle& t) { return meets(from, to, in, t); });
    };
    EXPECT_EQ(count(axis, out[v]) % 2, 1) << "vertex " << v << " at " << out[v].transpose();
  }
}

/// Triangles in a ball, all particles outside of it: shallow, as of a sheet that was placed by its particles.
TEST(Untangle, TrianglesLeaveABallThatNoParticleIsIn) {
  World world;
  world.add_collider({"ball", Sphere{.center = {0, -0.2, 0}, .radius = 0.203}, 0.3, {}});
  add_sheet(world, "sheet", {0.05, 0, 0.05}, {0, 0, 0}, 0.4, 4);
  expect_untangled(world, "triangles of cloth \"sheet\" are in collider \"ball\"");
}

ClothId add_sheet_on_pole(World& world, double radius) {
  const Capsule pole{.a = {0.02, -0.5, 0.03}, .b = {0.02, 0.5, 0.03}, .radius = radius};
  world.add_collider({"pole", pole, 0.3, {}});
  return add_sheet(world, "sheet", {0, 0, 0}, {0, 0, 0}, 1, 10);
}

/// Particles were taken out of the pole, triangles not, and seconds of settling stretched the sheet.
TEST(Untangle, ASheetWithAPoleThroughItComesOff) {
  World world;
  const ClothId sheet = add_sheet_on_pole(world, 0.08);
  expect_untangled(world, "particles of cloth \"sheet\" are inside collider \"pole\"");
  EXPECT_LT(largest_strain(world, sheet), 0.1);
}

TEST(Untangle, LeavesAHeldSheetOnAPoleWhereItIs) {
  World world;
  const ClothId sheet = add_sheet_on_pole(world, 0.03);
  Pin all;
  for (int p = 0; p < world.model(sheet).num_particles(); ++p) all.particles.push_back(p);
  world.set_pins(sheet, {all});
  const std::vector<Vec3> start = positions_of(world.state(sheet));
  EXPECT_EQ(world.untangle().rounds, 0) << "nothing can move";
  EXPECT_EQ(positions_of(world.state(sheet)), start);
}

TEST(Untangle, PutsAHigherLayerOutside) {
  // Wholly under the other one, and through it on one side.
  for (const auto& [first, second] : {std::pair(Sleeve{0.050, 0, 0}, Sleeve{0.0485, 0, 1}),
                                      std::pair(Sleeve{0.047, 0, 0}, Sleeve{0.049, 0.006, 1}),
                                      std::pair(Sleeve{0.0485, 0, 1}, Sleeve{0.050, 0, 0}),
                                      std::pair(Sleeve{0.049, 0.006, 3}, Sleeve{0.047, 0, -1})}) {
    World world;
    const std::vector<ClothId> ids = add_sleeves(world, std::array{first, second});
    const bool is_first_inner = first.layer < second.layer;
    const UntangleReport report = world.untangle();
    EXPECT_GT(report.rounds, 0);
    for (const std::string& left : report.left) ADD_FAILURE() << left;
    EXPECT_EQ(check(world).intersections, 0);
    expect_order(world, ids[is_first_inner ? 0 : 1], ids[is_first_inner ? 1 : 0]);
    for (const ClothId id : ids) EXPECT_LT(largest_strain(world, id), 0.2);
  }
}

TEST(Untangle, PutsThreeLayersInOrder) {
  World world;
  const std::vector<ClothId> ids =
      add_sleeves(world, std::array{Sleeve{0.049, 0.004, 2}, Sleeve{0.048, 0, 1}, Sleeve{0.047, -0.003, 0}});
  for (const std::string& left : world.untangle().left) ADD_FAILURE() << left;
  EXPECT_EQ(check(world).intersections, 0);
  expect_order(world, ids[2], ids[1]);
  expect_order(world, ids[1], ids[0]);
}

TEST(Untangle, SaysWhichLayerIsUnderWhich) {
  World world;
  add_sleeves(world, std::array{Sleeve{0.050, 0, 0}, Sleeve{0.0485, 0, 1}});
  const UntangleReport report = world.untangle();
  ASSERT_EQ(report.crossed.size(), 1);
  EXPECT_NE(
      report.crossed[0].find("particles of cloth \"sleeve 1\" are under cloth \"sleeve 0\", a lower layer"),
      std::string::npos)
      << report.crossed[0];
}

/// Planes are ground: without another solid there is no outside.
TEST(Untangle, HasNoOrderOfLayersWithoutABody) {
  World world;
  world.add_collider({"floor", Plane{Vec3(0, -0.1, 0), Vec3::UnitY()}, 0.3, {}});
  const TriangleMesh mesh = make_sleeve(0.04, 0.25, kAround, kAlong);
  for (const double scale : {1.0, 0.9}) {
    std::vector<Vec3> positions = mesh.positions;
    for (Vec3& p : positions) p *= scale;
    world.add_cloth({.topology = build_mesh_topology(mesh),
                     .material = kCotton,
                     .positions = positions,
                     .layer = scale < 1 ? 1 : 0});
  }
  EXPECT_EQ(world.untangle().rounds, 0);
}

TEST(Untangle, LeavesLayersInOrderAlone) {
  World world;
  add_sleeves(world, std::array{Sleeve{0.045, 0, 0}, Sleeve{0.0485, 0, 1}});
  EXPECT_EQ(world.untangle().rounds, 0);
  World equal;
  add_sleeves(equal, std::array{Sleeve{0.0485, 0, 4}, Sleeve{0.045, 0, 4}});
  EXPECT_EQ(equal.untangle().rounds, 0);
}

TEST(Untangle, LeavesAloneWhatDoesNotCross) {
  World world;
  const ClothId sheet = add_sheet(world, "sheet", {0, 0, 0}, {0, 0, 0});
  add_sheet(world, "other", {0, 0.01, 0}, {0, 10, 0});
  const std::uint64_t hash = world.state_hash();
  const UntangleReport report = world.untangle();
  EXPECT_EQ(report.rounds, 0);
  EXPECT_TRUE(report.crossed.empty());
  EXPECT_EQ(world.state_hash(), hash);
  (void)sheet;
}

TEST(Untangle, WhatPinsHoldThroughEachOtherIsNamed) {
  World world;
  const ClothId a = add_sheet(world, "a", {0, 0, 0}, {0, 0, 0}, 0.1, 4);
  const ClothId b = add_sheet(world, "b", {0.003, 0.002, 0.001}, {90, 0, 0}, 0.1, 4);
  for (const ClothId cloth : {a, b}) {
    std::vector<int> all;
    for (int i = 0; i < 25; ++i) all.push_back(i);
    world.set_pins(cloth, {{all, {}, Vec3::Zero()}});
  }
  const UntangleReport report = world.untangle();
  ASSERT_FALSE(report.left.empty());
  EXPECT_NE(report.left[0].find("cloth \"a\""), std::string::npos) << report.left[0];
  EXPECT_NE(report.left[0].find("cloth \"b\""), std::string::npos) << report.left[0];
  EXPECT_NE(report.left[0].find("with triangle"), std::string::npos) << report.left[0];
}

}  // namespace
}  // namespace weft::engine
