/// The public World, through its headers: cloth from a description, bodies moved between steps, reading.

#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <functional>
#include <limits>
#include <numbers>
#include <type_traits>

#include "weft/weft.h"

namespace weft {
namespace {

constexpr double kStep = 1.0 / 64;  // exact in binary, and so are times
const Springs kSoft{.density = 0.2, .structural = 200, .shear = 80, .bend = 0.02};

static_assert(std::is_nothrow_move_constructible_v<World> && !std::is_copy_constructible_v<World>);

Grid square(int cells, double size) { return {size, size, cells, cells}; }

/// A sheet in the plane x = 0, hung by two corners, its centre at the origin.
ClothId hang_sheet(World& world, int cells = 12) {
  const Grid grid = square(cells, 0.6);
  const ClothId sheet = world.add_cloth(
      {.shape = grid, .fabric = kSoft, .pose = {{0, 0.3, -0.3}, rotation_about({0, 0, 1}, -90)}});
  world.set_pins(sheet, {{.particles = {grid.index(0, 0), grid.index(0, cells)}}});
  return sheet;
}

double distance(const Vec3& a, const Vec3& b) { return length(a - b); }

void step(World& world, int steps, double dt = kStep) {
  for (int n = 0; n < steps; ++n) ASSERT_TRUE(world.step(dt).ok);
}

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

void expect_contains(const std::string& message, const std::string& part) {
  EXPECT_NE(message.find(part), std::string::npos) << message;
}

/// Two triangles with duplicate vertices along their common edge, and one unused vertex.
TriangleMesh unsewn_square() {
  return {.positions = {{0, 0, 0}, {1, 0, 0}, {0, 0, 1}, {1, 0, 0}, {1, 0, 1}, {0, 0, 1}, {9, 9, 9}},
          .triangles = {{0, 2, 1}, {3, 5, 4}}};
}

TEST(Face, GivesBackTheVerticesThatItWasGiven) {
  World world;
  const ClothId cloth =
      world.add_cloth({.shape = unsewn_square(), .fabric = kSoft, .pose = {{0, 2, 0}, {}}, .weld = 0});
  EXPECT_EQ(world.num_particles(cloth), 4);
  EXPECT_EQ(world.notes(cloth).particle_of_vertex.size(), 7u);
  EXPECT_EQ(world.notes(cloth).particle_of_vertex[6], -1);
  EXPECT_FALSE(world.notes(cloth).warnings.empty());
  step(world, 8);
  const std::vector<Vec3> vertices = world.vertex_positions(cloth);
  const double fallen = 0.5 * 9.81 * std::pow(8 * kStep, 2);
  ASSERT_EQ(vertices.size(), 7u);
  EXPECT_EQ(vertices[1], vertices[3]);
  EXPECT_NEAR(vertices[4].y, 2 - fallen, 0.01);
  EXPECT_NEAR(vertices[4].x, 1, 1e-3);
  EXPECT_EQ(vertices[6], Vec3({9, 11, 9}));
}

TEST(Face, ANamedFabricOnAMeshWithoutTextureCoordinatesWarnsOfItsWarp) {
  World world;
  const ClothId cloth =
      world.add_cloth({.name = "flag", .shape = unsewn_square(), .fabric = find_fabric("denim"), .weld = 0});
  const std::vector<std::string>& warnings = world.notes(cloth).warnings;
  ASSERT_FALSE(warnings.empty());
  expect_contains(warnings.back(), "cloth \"flag\": its mesh has no texture coordinates");
  double mass = 0;
  for (const double m : world.masses(cloth)) mass += m;
  EXPECT_NEAR(mass, find_fabric("denim").density, 1e-12);
}

TEST(Face, FabricsAreChangedBetweenSteps) {
  World world;
  const ClothId cloth = world.add_cloth({.shape = square(8, 0.5), .fabric = find_fabric("silk")});
  step(world, 2);
  world.set_fabric(cloth, find_fabric("denim"));
  step(world, 2);
  double mass = 0;
  for (const double m : world.masses(cloth)) mass += m;
  EXPECT_NEAR(mass, 0.25 * find_fabric("denim").density, 1e-12);
  world.set_fabric(cloth, kSoft);
  step(world, 2);
  EXPECT_THROW(world.set_fabric(cloth, Fabric{.density = -1}), InputError);
}

TEST(Face, AGripperDrivenPerFrameEqualsItsKeyFrames) {
  const OrientedBox jaw{.center = {-0.2, 0, 0}, .half_size = {0.05, 0.1, 0.1}};
  std::vector<KeyFrame> keys;
  for (int k = 0; k <= 40; ++k) keys.push_back({k * kStep, {0.75 * k * kStep, 0, 0}, {}});
  World by_keys, by_program;
  hang_sheet(by_keys);
  const ClothId sheet = hang_sheet(by_program);
  by_keys.add_collider({.shape = jaw, .motion = keys});
  const ColliderId hand = by_program.add_collider({.shape = jaw});
  for (int k = 1; k <= 40; ++k) {
    by_program.move_collider(hand, {{0.75 * k * kStep, 0, 0}, {}});
    ASSERT_TRUE(by_program.step(kStep).ok);
    ASSERT_TRUE(by_keys.step(kStep).ok);
    ASSERT_EQ(by_program.state_hash(), by_keys.state_hash()) << k;
  }
  EXPECT_GT(by_program.center_of_mass(sheet).x, 0.02) << "the jaw pushes";
}

TEST(Face, PosesTakeAShapesOwnCoordinatesToTheWorld) {
  World world;
  const Mat3 turn = rotation_about({0, 0, 1}, 30);
  const Capsule capsule{.a = {0.1, 0, 0}, .b = {0.9, 0, 0}, .radius = 0.1};
  const ColliderId id = world.add_collider({.shape = capsule, .pose = {{0, 1, 0}, turn}});
  const auto expect_pose = [&](const Pose& expected) {
    const Pose pose = world.pose(id);
    EXPECT_LT(distance(pose.translation, expected.translation), 1e-12);
    EXPECT_LT(distance(pose.rotation.row0, expected.rotation.row0), 1e-12);
  };
  expect_pose({{0, 1, 0}, turn});
  const Pose next{{0.5, 0.25, 2}, rotation_from_angles_deg({10, 20, 30})};
  world.move_collider(id, next);
  step(world, 1);
  expect_pose(next);
  world.place_collider(id, {{0, 3, 0}, {}});
  expect_pose({{0, 3, 0}, {}});
}

TEST(Face, PinnedParticlesGoWhereTheyAreMoved) {
  World world;
  const ClothId sheet = hang_sheet(world);
  const std::vector<Vec3> start = world.positions(sheet);
  const int corner = 12 * 13;  // the second pinned one
  for (int n = 1; n <= 16; ++n) {
    const Vec3 way{0.01 * n, 0, 0};
    world.move_pins(sheet, {start[0] + way, start[corner] + way});
    ASSERT_TRUE(world.step(kStep).ok);
    ASSERT_LT(distance(world.positions(sheet)[corner], start[corner] + way), 1e-6);
  }
  const Vec3 there = world.positions(sheet)[0];
  step(world, 4);
  EXPECT_LT(distance(world.positions(sheet)[0], there), 1e-6) << "they stay";
  EXPECT_LT(length(world.velocities(sheet)[0]), 1e-6);
  EXPECT_THROW(world.move_pins(sheet, {{0, 0, 0}}), InputError);
}

TEST(Face, SoftPinsStretchByTheirForceOverTheirStiffness) {
  World world;
  const Grid grid = square(6, 0.3);
  const ClothId sheet = world.add_cloth({.shape = grid, .fabric = kSoft});
  const double weight = 0.2 * 0.09 * 9.81, stiffness = 20;
  Pin pin{.particles = {}, .stiffness = stiffness, .damping = 0.5};
  for (int i = 0; i < grid.num_particles(); ++i) pin.particles.push_back(i);
  world.set_pins(sheet, {pin});
  step(world, 300);
  const double sag = weight / (stiffness * grid.num_particles());
  double mean = 0;
  for (const Vec3& p : world.positions(sheet)) mean += p.y / grid.num_particles();
  EXPECT_NEAR(mean, -sag, 0.02 * sag);
  Vec3 sum;
  for (const Vec3& force : world.pin_forces(sheet)) sum = sum + force;
  EXPECT_NEAR(sum.y, weight, 0.01 * weight);
  // Moved by the program.
  std::vector<Vec3> targets;
  for (const Vec3& p : world.positions(sheet)) targets.push_back(p + Vec3{0.5, 0, 0});
  world.move_pins(sheet, targets);
  step(world, 300);
  EXPECT_NEAR(world.center_of_mass(sheet).x, 0.15 + 0.5, 0.01);
}

TEST(Face, PinsBearTheWeightOfAHangingCloth) {
  World world;
  const ClothId sheet = hang_sheet(world);
  world.set_fabric(sheet,
                   Springs{.density = 0.2, .structural = 200, .shear = 80, .bend = 0.02, .damping = 0.05});
  step(world, 1200);
  const std::vector<Vec3> forces = world.pin_forces(sheet);
  ASSERT_EQ(forces.size(), 2u);
  const double weight = 0.2 * 0.36 * 9.81;
  EXPECT_NEAR(forces[0].y + forces[1].y, weight, 0.01 * weight);
  EXPECT_NEAR(forces[0].z + forces[1].z, 0, 0.01 * weight);
}

TEST(Face, ForcesOfAllKindsSumToMassTimesAcceleration) {
  World world;
  const ClothId sheet = world.add_cloth({.shape = square(6, 0.3), .fabric = kSoft});
  std::vector<Vec3> lift;
  for (const double m : world.masses(sheet)) lift.push_back({0.5 * m, 9.81 * m, 0});
  world.set_forces(sheet, lift);
  step(world, 32);
  const Vec3 v = world.velocities(sheet)[20];
  EXPECT_NEAR(v.x, 0.5 * 32 * kStep, 1e-4);
  EXPECT_NEAR(v.y, 0, 1e-4) << "carried";
  Vec3 sum;
  for (const ForceKind kind :
       {ForceKind::gravity, ForceKind::external, ForceKind::elastic, ForceKind::damping})
    for (const Vec3& f : world.forces(sheet, kind)) sum = sum + f;
  EXPECT_NEAR(sum.x, 0.5 * 0.2 * 0.09, 1e-6);
  EXPECT_NEAR(sum.y, 0, 1e-5);
  world.set_forces(sheet, {});
  step(world, 1);
  EXPECT_LT(world.velocities(sheet)[20].y, -0.1);
}

/// An external force of m·a moves free cloth as the gravity a does, with every integrator.
TEST(Face, ExternalForcesActLikeGravity) {
  for (const std::string_view name : integrator_names()) {
    World falls, pushed;
    for (World* world : {&falls, &pushed}) {
      world->set_integrator({.integrator = std::string(name)});
      world->add_cloth({.shape = square(6, 0.3), .fabric = kSoft});
    }
    pushed.set_gravity({});
    std::vector<Vec3> weight;
    for (const double m : pushed.masses(pushed.cloth(0))) weight.push_back({0, -9.81 * m, 0});
    pushed.set_forces(pushed.cloth(0), weight);
    step(falls, 20);
    step(pushed, 20);
    const double a = falls.center_of_mass(falls.cloth(0)).y, b = pushed.center_of_mass(pushed.cloth(0)).y;
    // Eq. 16 filters gravity, and only gravity.
    if (name != "paper") {
      EXPECT_NEAR(a, b, 2e-5 * std::abs(a)) << name;
    }
    EXPECT_LT(b, -0.3) << name;
  }
}

TEST(Face, ReadsIntoTheCallersMemory) {
  World world;
  const ClothId sheet = hang_sheet(world, 4);
  step(world, 10);
  struct Vertex {
    float position[3], normal[3], other;
  };
  std::vector<Vertex> vertices(static_cast<std::size_t>(world.num_particles(sheet)), Vertex{{}, {}, 7});
  world.copy_positions(sheet, vertices[0].position, sizeof(Vertex));
  world.copy_normals(sheet, vertices[0].normal, sizeof(Vertex));
  std::vector<double> velocities(3 * vertices.size());
  world.copy_velocities(sheet, velocities.data());
  const std::vector<Vec3> positions = world.positions(sheet), expected = world.velocities(sheet);
  for (std::size_t i = 0; i < vertices.size(); ++i) {
    EXPECT_FLOAT_EQ(vertices[i].position[1], static_cast<float>(positions[i].y));
    EXPECT_NEAR(std::hypot(vertices[i].normal[0], vertices[i].normal[1], vertices[i].normal[2]), 1, 1e-5);
    EXPECT_EQ(vertices[i].other, 7);
    EXPECT_EQ(velocities[3 * i + 1], expected[i].y);
  }
  EXPECT_THROW(world.copy_positions(sheet, vertices[0].position, 8), InputError);
}

TEST(Face, StrainsOfASheetStretchedByHand) {
  for (const bool is_fabric : {true, false}) {
    World world;
    ClothDesc desc{.shape = square(4, 1)};
    if (!is_fabric) desc.fabric = kSoft;
    const ClothId sheet = world.add_cloth(desc);
    std::vector<Vec3> positions = world.positions(sheet);
    for (Vec3& p : positions) p = {1.1 * p.x, 0, p.z};
    world.set_positions(sheet, positions);
    for (const TriangleStrain& strain : world.triangle_strains(sheet)) {
      EXPECT_NEAR(strain.max_stretch, 1.1, 1e-6);
      EXPECT_NEAR(strain.min_stretch, 1, 1e-6);
      if (!is_fabric) continue;
      EXPECT_NEAR(strain.warp, 0.1, 1e-6);
      EXPECT_NEAR(strain.weft, 0, 1e-6);
      EXPECT_NEAR(strain.shear, 0, 1e-6);
    }
    for (const double strain : world.spring_strains(sheet)) {
      EXPECT_GT(strain, -1e-6);
      EXPECT_LT(strain, 0.1 + 1e-6);
    }
  }
}

TEST(Face, RaysAndNearestPoints) {
  World world;
  const ClothId sheet = world.add_cloth({.shape = square(8, 1), .fabric = kSoft, .pose = {{0, 2, 0}, {}}});
  const auto hit = world.cast_ray({0.3, 5, 0.7}, {0, -2, 0});
  ASSERT_TRUE(hit);
  EXPECT_EQ(hit->cloth, sheet);
  EXPECT_NEAR(hit->distance, 3, 1e-6);
  EXPECT_NEAR(hit->position.x, 0.3, 1e-6);
  const Triangle& t = world.triangles(sheet)[hit->triangle];
  const std::vector<Vec3> x = world.positions(sheet);
  const Vec3 point = hit->weights.x * x[t[0]] + hit->weights.y * x[t[1]] + hit->weights.z * x[t[2]];
  EXPECT_LT(distance(point, hit->position), 1e-6);
  EXPECT_FALSE(world.cast_ray({0.3, 5, 0.7}, {0, -2, 0}, 2.9));
  EXPECT_FALSE(world.cast_ray({1.3, 5, 0.7}, {0, -2, 0}));
  const auto nearest = world.closest_point({1.5, 2.5, 0.5});
  ASSERT_TRUE(nearest);
  EXPECT_NEAR(nearest->distance, std::numbers::sqrt2 / 2, 1e-6);
  EXPECT_NEAR(nearest->position.x, 1, 1e-6);
  EXPECT_FALSE(world.closest_point({1.5, 2.5, 0.5}, 0.7));
}

TEST(Face, ContactsNameTheirBodiesAndBearTheWeight) {
  World world;
  world.set_contact({.tracks_points = true});
  const ColliderId floor = world.add_collider({.shape = Plane{}});
  const ClothId sheet = world.add_cloth({.shape = square(8, 0.4),
                                         .fabric = Springs{.structural = 200, .shear = 80, .bend = 0.02},
                                         .pose = {{0, 0.002, 0}, {}}});
  step(world, 128);
  double force = 0;
  for (const ContactPoint& contact : world.contact_points()) {
    EXPECT_EQ(contact.cloth, sheet);
    ASSERT_TRUE(contact.collider);
    EXPECT_EQ(*contact.collider, floor);
    force += contact.force.y;
  }
  EXPECT_NEAR(force, 0.2 * 0.16 * 9.81, 0.02 * 0.2 * 0.16 * 9.81);
}

TEST(Face, RulesById) {
  World world;
  const ColliderId floor = world.add_collider({.shape = Plane{}});
  const ClothId through =
      world.add_cloth({.shape = square(4, 0.2), .fabric = kSoft, .pose = {{0, 0.1, 0}, {}}});
  const ClothId held = world.add_cloth({.shape = square(4, 0.2), .fabric = kSoft, .pose = {{0, 0.3, 1}, {}}});
  world.set_collision(through, floor, false);
  step(world, 64);
  EXPECT_LT(world.center_of_mass(through).y, -1);
  EXPECT_GT(world.center_of_mass(held).y, 0);
  EXPECT_THROW(world.set_collision(floor, floor, false), InputError);
  EXPECT_THROW(world.set_friction(held, floor, -1), InputError);
}

TEST(Face, WindKeysBlowAtTheirTimes) {
  World world;
  const ClothId sheet = world.add_cloth({.shape = square(4, 0.2), .fabric = kSoft});
  world.set_gravity({});
  world.set_wind({.keys = {{0.5, {}}, {0.5 + kStep, {3, 0, 0}}}, .drag = 5});
  step(world, 32);
  EXPECT_LT(length(world.velocities(sheet)[0]), 1e-6);
  step(world, 64);
  EXPECT_NEAR(world.velocities(sheet)[0].x, 3, 0.01);
  EXPECT_THROW(world.set_wind({.keys = {{1, {}}, {1, {}}}}), InputError);
}

TEST(Face, ATeleportedClothStopsIfItIsTold) {
  World world;
  const ClothId sheet = world.add_cloth({.shape = square(4, 0.2), .fabric = kSoft, .velocity = {1, 0, 0}});
  world.teleport(sheet, {{0, 0, 5}, rotation_about({0, 1, 0}, 90)});
  EXPECT_NEAR(world.velocities(sheet)[0].z, -1, 1e-6);
  world.teleport(sheet, {{0, 0, 5}, {}}, false);
  EXPECT_EQ(world.velocities(sheet)[0], Vec3());
}

TEST(Face, SnapshotsHoldTargetsAndKnowTheirWorld) {
  World world;
  const ClothId sheet = hang_sheet(world);
  const ColliderId ball = world.add_collider({.shape = Sphere{.radius = 0.1}, .pose = {{-0.2, 0, 0}, {}}});
  step(world, 4);
  std::vector<Vec3> targets = {world.positions(sheet)[0] + Vec3{0.1, 0, 0}, world.positions(sheet)[156]};
  world.move_pins(sheet, targets);
  world.move_collider(ball, {{0.1, 0, 0}, {}});
  world.set_forces(sheet, std::vector<Vec3>(169, {0, 1e-3, 0}));
  const Snapshot snapshot = world.snapshot();
  step(world, 8);
  const std::uint64_t expected = world.state_hash();
  world.set_forces(sheet, {});
  world.set_pins(sheet, {});
  world.restore(snapshot);
  step(world, 8);
  EXPECT_EQ(world.state_hash(), expected);
  World other;
  hang_sheet(other);
  EXPECT_THROW(other.restore(snapshot), InputError);
  EXPECT_THROW(other.restore(Snapshot()), InputError);
}

TEST(Face, IdsThatAreOfNothingAreNamed) {
  World world, other;
  const ClothId sheet = hang_sheet(world);
  const ClothId foreign = hang_sheet(other);
  expect_contains(error_of([&] { world.positions({}); }), "empty");
  expect_contains(error_of([&] { world.positions(foreign); }), "another world");
  world.remove(sheet);
  expect_contains(error_of([&] { world.positions(sheet); }), "removed");
  EXPECT_FALSE(world.contains(sheet));
}

TEST(Face, WhatCannotBeIsRefusedAndChangesNothing) {
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  World world;
  const ClothId sheet = hang_sheet(world, 4);
  const ColliderId ball = world.add_collider({.name = "ball", .shape = Sphere{}, .pose = {{-3, 0, 0}, {}}});
  const TriangleMesh beyond{.positions = {{0, 0, 0}, {1, 0, 0}, {0, 0, 1}}, .triangles = {{0, 1, 3}}};
  const std::vector<std::byte> before = world.save();
  const std::vector<std::function<void()>> calls = {
      [&] { world.add_cloth({.shape = TriangleMesh{}}); },
      [&] { world.add_cloth({.shape = beyond}); },
      [&] { world.add_cloth({.shape = Grid{.cells_x = 0}}); },
      [&] { world.add_cloth({.shape = Grid{.cells_x = 2000000000, .cells_z = 2000000000}}); },
      [&] { world.add_cloth({.fabric = Fabric{.thickness = -1}}); },
      [&] { world.add_cloth({.fabric = Springs{.density = 0}}); },
      [&] {
        world.add_cloth({.pose = {{kNan, 0, 0}, {}}});
      },
      [&] { world.add_collider({.shape = TriangleMesh{}}); },
      [&] { world.add_collider({.shape = beyond}); },
      [&] { world.add_collider({.shape = Sphere{.radius = -1}}); },
      [&] { world.add_collider({.shape = Sphere{.radius = kNan}}); },
      [&] {
        world.add_collider({.shape = Plane{.normal = {0, 5, 0}}});
      },
      [&] {
        world.add_collider({.shape = Sphere{}, .frames = {{0, {}}}});
      },
      [&] {
        world.add_collider({.shape = Sphere{}, .motion = {{1, {}, {}}, {0, {}, {}}}});
      },
      [&] {
        world.move_collider(ball, {{kNan, 0, 0}, {}});
      },
      [&] {
        world.move_collider(ball, {{}, {{2, 0, 0}, {0, 2, 0}, {0, 0, 2}}});
      },
      [&] { world.move_vertices(ball, {}); },
      [&] { world.set_pins(sheet, {{.particles = {25}}}); },
      [&] { world.set_pins(sheet, {{.particles = {-1}, .stiffness = 1.0}}); },
      [&] { world.set_pins(sheet, {{.particles = {0}, .stiffness = kNan}}); },
      [&] {
        world.move_pins(sheet, {{kNan, 0, 0}, {0, 0, 0}});
      },
      [&] {
        world.set_forces(sheet, {{0, 0, 0}});
      },
      [&] { world.set_positions(sheet, {}); },
      [&] {
        world.set_velocities(sheet, std::vector<Vec3>(25, {0, kNan, 0}));
      },
      [&] {
        world.set_gravity({0, kNan, 0});
      },
      [&] { world.set_jobs(nullptr); },
      [&] { world.set_integrator({.integrator = "magic"}); },
      [&] { world.set_division({.shortest = 0}); },
      [&] { world.set_wind({.drag = -1}); },
      [&] { world.stiffen(sheet, {25}, 2); },
      [&] {
        world.stiffen(sheet, {0, 1}, -2);
      },
      [&] { world.step(0); },
      [&] { world.step(kNan); },
      [&] { world.cloth(1); },
      [&] { world.cast_ray({}, {}); },
      [&] {
        world.closest_point({kNan, 0, 0});
      },
  };
  for (std::size_t c = 0; c < calls.size(); ++c) {
    EXPECT_FALSE(error_of(calls[c]).empty()) << c;
    EXPECT_EQ(world.save(), before) << c;
  }
}

TEST(Face, RotationsOfEveryKindAgree) {
  const Mat3 a = rotation_about({0, 2, 0}, 90), b = rotation_from_angles_deg({0, 90, 0}),
             c = rotation_from_quaternion(1, 0, 1, 0);
  for (const Mat3& m : {a, b, c}) EXPECT_LT(distance(m * Vec3{1, 0, 0}, {0, 0, -1}), 1e-12);
  EXPECT_THROW(rotation_about({}, 90), InputError);
  EXPECT_THROW(rotation_from_quaternion(0, 0, 0, 0), InputError);
}

}  // namespace
}  // namespace weft
