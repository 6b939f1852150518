/// The public World, through its headers: cloth from a description, bodies moved between steps, reading.

#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <functional>
#include <limits>
#include <numbers>
#include <optional>
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

/// Positions as World::offsets() gives them.
std::vector<Vec3> read(const ClothOffsets& offsets) {
  const float* x = offsets.data.get();
  std::vector<Vec3> result;
  for (std::size_t i = 0; i < offsets.num_particles; ++i)
    result.push_back(offsets.origin + Vec3{x[i], x[offsets.stride + i], x[2 * offsets.stride + i]});
  return result;
}

TEST(Face, OffsetsShowTheNewestStateInOnePlace) {
  World world;
  const ClothId sheet = hang_sheet(world);
  const ClothOffsets first = world.offsets(sheet);
  const auto expect_shown = [&](const char* after) {
    const ClothOffsets now = world.offsets(sheet);
    EXPECT_EQ(now.data.get(), first.data.get()) << after;
    EXPECT_EQ(now.stride, first.stride) << after;
    const std::vector<Vec3> shown = read({first.data, first.num_particles, first.stride, now.origin});
    EXPECT_EQ(shown, world.positions(sheet)) << after;
  };
  expect_shown("add_cloth");
  const Snapshot start = world.snapshot();
  step(world, 3);
  expect_shown("step");
  world.set_division({.enabled = true, .shortest = 1e-3});
  world.add_collider({.shape = Sphere{.radius = 0.1}, .pose = {{-0.2, -0.1, 0}, {}}});
  step(world, 30);
  expect_shown("steps in contact");
  world.set_positions(sheet, std::vector<Vec3>(first.num_particles, {0.25, 0.5, 1}));
  expect_shown("set_positions");
  world.remove(world.collider(0));
  world.restore(start);
  expect_shown("restore");
  world.teleport(sheet, {{100, 0, 3}, {}});
  expect_shown("teleport");
  world.set_fabric(sheet, kSoft);
  expect_shown("set_fabric");
  EXPECT_FALSE(world.step(1e30).ok);
  expect_shown("a step that failed");
}

TEST(Face, OffsetsOutliveTheirClothAndTheirWorld) {
  std::optional<World> world(std::in_place);
  const ClothId sheet = hang_sheet(*world);
  step(*world, 3);
  const ClothOffsets offsets = world->offsets(sheet);
  const std::vector<Vec3> expected = world->positions(sheet);
  world->remove(sheet);
  hang_sheet(*world);
  step(*world, 3);
  EXPECT_EQ(read(offsets), expected);
  world.reset();
  EXPECT_EQ(read(offsets), expected);
}

TEST(Face, PinsAreAddedAndReleasedOneByOne) {
  World together, apart;
  const ClothId a = hang_sheet(together), b = hang_sheet(apart);
  apart.set_pins(b, {});
  apart.add_pin(b, {.particles = {156}});
  apart.add_pin(b, {.particles = {80}, .stiffness = 50});
  apart.add_pin(b, {.particles = {0, 12}});
  EXPECT_EQ(apart.pinned_particles(b), (std::vector{156, 80, 0, 12}));
  apart.unpin(b, {12, 80});
  EXPECT_EQ(apart.pinned_particles(b), (std::vector{156, 0}));
  EXPECT_EQ(together.pinned_particles(a), (std::vector{0, 156}));
  step(together, 8);
  step(apart, 8);
  EXPECT_EQ(apart.state_hash(), together.state_hash()) << "as if pinned at once";

  expect_contains(error_of([&] { apart.add_pin(b, {.particles = {3, 0}}); }), "particle 0 is pinned twice");
  expect_contains(error_of([&] { apart.add_pin(b, {.particles = {169}}); }),
                  "there is no particle 169 to pin");
  expect_contains(error_of([&] { apart.unpin(b, {0, 7}); }), "particle 7 is not pinned");
  EXPECT_EQ(apart.pinned_particles(b), (std::vector{156, 0})) << "an error changes nothing";
  apart.unpin(b, {0, 156});
  const double height = apart.center_of_mass(b).y;
  step(apart, 32);
  EXPECT_LT(apart.center_of_mass(b).y, height - 0.5) << "it falls";
}

TEST(Face, APinThatIsAddedLeavesTheMotionOfTheOthers) {
  World world;
  const ClothId sheet = hang_sheet(world);
  const std::vector<Vec3> start = world.positions(sheet);
  world.set_pins(sheet,
                 {{.particles = {0}, .motion = {{.time = 0}, {.time = 1, .translation = {0.2, 0, 0}}}}});
  world.add_pin(sheet, {.particles = {156}});
  world.add_pin(sheet, {.particles = {12}, .stiffness = 1000});
  step(world, 32);
  const std::vector<Vec3> now = world.positions(sheet);
  EXPECT_LT(distance(now[0], start[0] + Vec3{0.1, 0, 0}), 1e-6);
  EXPECT_LT(distance(now[156], start[156]), 1e-6);
  world.move_pins(sheet, {156}, {start[156]});  // replaces the key frames
  expect_contains(error_of([&] {
                    world.add_pin(sheet, {.particles = {5}, .motion = {{.time = 0}, {.time = 1}}});
                  }),
                  "which a pin with a motion or a collider cannot join");
}

TEST(Face, SomePinsAreMovedAndTheOthersStay) {
  World world;
  const ClothId sheet = hang_sheet(world);
  const std::vector<Vec3> start = world.positions(sheet);
  const Vec3 way{0.05, 0, 0}, other_way{0, 0.02, 0};
  world.move_pins(sheet, {156}, {start[156] + way});
  world.move_pins(sheet, {0}, {start[0] + other_way});  // before the same step
  step(world, 1);
  EXPECT_LT(distance(world.positions(sheet)[156], start[156] + way), 1e-6);
  EXPECT_LT(distance(world.positions(sheet)[0], start[0] + other_way), 1e-6);
  world.move_pins(sheet, {0}, {start[0]});
  step(world, 1);
  EXPECT_LT(distance(world.positions(sheet)[156], start[156] + way), 1e-6) << "stays";
  EXPECT_LT(distance(world.positions(sheet)[0], start[0]), 1e-6);
  expect_contains(error_of([&] { world.move_pins(sheet, {3}, {start[3]}); }), "particle 3 is not pinned");
  expect_contains(error_of([&] { world.move_pins(sheet, {0, 156}, {start[0]}); }), "a target for each of 2");
}

TEST(Face, SettingsAreReadAsTheyWereSet) {
  World world;
  const ClothId sheet = world.add_cloth({.name = "sheet",
                                         .shape = square(4, 0.5),
                                         .fabric = find_fabric("denim"),
                                         .pose = {{1, 2, 3}, rotation_about({0, 1, 0}, 30)}});
  world.set_gravity({0, 0, -1.62});
  world.set_wind({.velocity = {3, 0, 1}, .air = Air{.density = 1.1}});
  world.set_integrator({.integrator = "implicit_euler"});
  world.set_division({.enabled = false, .shortest = 0.001});
  world.set_contact({.enabled = true, .tracks_points = true});
  EXPECT_EQ(world.gravity(), (Vec3{0, 0, -1.62}));
  EXPECT_EQ(world.wind().velocity, (Vec3{3, 0, 1}));
  EXPECT_EQ(world.wind().air.density, 1.1);
  EXPECT_EQ(world.integrator().integrator, "implicit_euler");
  EXPECT_EQ(world.division().shortest, 0.001);
  EXPECT_TRUE(world.contact().tracks_points);
  EXPECT_EQ(world.description(sheet).name, "sheet");
  world.set_fabric(sheet, find_fabric("silk"));
  EXPECT_EQ(std::get<Fabric>(world.description(sheet).fabric).density, find_fabric("silk").density);
  const World loaded = World::load(world.save());
  EXPECT_EQ(loaded.gravity(), world.gravity());
  EXPECT_EQ(loaded.integrator().integrator, "implicit_euler");
  EXPECT_EQ(loaded.wind().air.density, 1.1);

  const std::vector<Vec3> rest = world.rest_positions(sheet);
  ASSERT_EQ(rest.size(), 25u);
  EXPECT_LT(distance(rest[24], {0.5, 0, 0.5}), 1e-7) << "in the cloth's own coordinates";
}

TEST(Face, TextureCoordinatesAreThoseThatWereGiven) {
  World world;
  TriangleMesh mesh{.positions = {{0, 0, 0}, {1, 0, 0}, {0, 0, 1}, {1, 0, 1}},
                    .triangles = {{0, 2, 1}, {1, 2, 3}}};
  mesh.uv = {{{{0, 0}, {0, 1}, {1, 0}}}, {{{1, 0}, {0, 1}, {1, 1}}}};
  const ClothId sheet = world.add_cloth({.shape = mesh, .fabric = find_fabric("denim")});
  ASSERT_EQ(world.uv(sheet).size(), 2u);
  EXPECT_EQ(world.uv(sheet), mesh.uv);
}

TEST(Face, ForcesOfAllKindsAreTheirSum) {
  World world;
  const ClothId sheet = hang_sheet(world);
  world.set_wind({.velocity = {2, 0, 1}, .drag = 0.3});
  world.set_forces(sheet, std::vector<Vec3>(169, {0, 1e-3, 0}));
  step(world, 8);
  std::vector<Vec3> sum(169);
  for (const ForceKind kind : {ForceKind::gravity, ForceKind::elastic, ForceKind::damping, ForceKind::wind,
                               ForceKind::external, ForceKind::contact}) {
    const std::vector<Vec3> force = world.forces(sheet, kind);
    for (std::size_t i = 0; i < sum.size(); ++i) sum[i] = sum[i] + force[i];
  }
  EXPECT_EQ(world.forces(sheet), sum);
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

TEST(Face, PositionsThatAreSetToThemselvesKeepTheHash) {
  World world;
  world.set_integrator({.integrator = "implicit_euler"});  // without a history, which a jump ends
  const ClothId sheet = world.add_cloth({.shape = square(11, 1), .pose = {{-0.5, 0.51, -0.5}, {}}});
  step(world, 1);  // its middle moves from 0 to a small negative number: the origin would be −0
  const std::uint64_t expected = world.state_hash();
  world.set_positions(sheet, world.positions(sheet));
  EXPECT_EQ(world.state_hash(), expected);
}

TEST(Face, SnapshotsFromBeforeAColliderAreRefused) {
  World world;
  hang_sheet(world);
  const Snapshot before = world.snapshot();
  world.add_collider({.shape = Plane{}, .pose = {{0, -2, 0}, {}}});
  expect_contains(error_of([&] { world.restore(before); }), "different numbers of colliders");
}

TEST(Face, MessagesHaveTheOwnerAndTheNumbersThatWereGiven) {
  World world;
  const double kInf = std::numeric_limits<double>::infinity();
  const Pose turned{{1, 2, 3}, rotation_about({0, 0, 1}, 30)};
  expect_contains(error_of([&] {
                    world.add_collider({.shape = Sphere{.center = {kInf, 1, 0}}, .pose = turned});
                  }),
                  "collider \"collider\": its centre must be finite, not (inf, 1, 0)");
  expect_contains(
      error_of([&] {
        world.add_collider({.name = "ball", .shape = Sphere{}, .motion = {{1, {}, {}}, {0, {}, {}}}});
      }),
      "collider \"ball\": key frame 1 is not later");
  const ClothId sheet = hang_sheet(world);
  expect_contains(error_of([&] {
                    world.add_pin(sheet, {.particles = {5}, .motion = {{1, {}, {}}, {0, {}, {}}}});
                  }),
                  "cloth \"cloth\": key frame 1 is not later");
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
  const ClothId triangles = world.add_cloth({.shape = square(4, 0.5), .pose = {{5, 0, 0}, {}}});
  const Mat3 twice{{2, 0, 0}, {0, 2, 0}, {0, 0, 2}}, mirror{{1, 0, 0}, {0, -1, 0}, {0, 0, 1}};
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
      [&] {
        world.stiffen(triangles, {0, 1}, 2);
      },
      // Numbers that floats cannot hold.
      [&] {
        std::vector<Vec3> positions = world.positions(sheet);
        positions[0].x = 1e300;
        world.set_positions(sheet, positions);
      },
      [&] {
        world.set_velocities(sheet, std::vector<Vec3>(25, {0, 1e300, 0}));
      },
      [&] {
        world.teleport(sheet, {{0, 1e300, 0}, {}});
      },
      [&] {
        world.move_pins(sheet, {{1e300, 0, 0}, {0, 0, 0}});
      },
      // Rotations that stretch or mirror.
      [&] {
        world.add_cloth({.pose = {{}, twice}});
      },
      [&] {
        world.add_cloth({.pose = {{}, mirror}});
      },
      [&] {
        world.add_collider({.shape = Sphere{}, .pose = {{}, twice}});
      },
      [&] {
        world.add_collider({.shape = Plane{}, .pose = {{}, mirror}});
      },
      // Settings out of their range.
      [&] { world.add_cloth({.weld = -1}); },
      [&] { world.add_cloth({.sew = -1}); },
      [&] {
        world.add_cloth({.warp = Vec3{0, 0, 0}});
      },
      [&] { world.set_integrator({.newton = {.iterations = -5}}); },
      [&] { world.set_integrator({.explicit_euler = {.substeps = -1}}); },
      [&] { world.set_integrator({.xpbd = {.substeps = 0}}); },
      [&] { world.set_integrator({.implicit_euler = {.iterations = 0}}); },
      [&] { world.set_integrator({.implicit_euler = {.tolerance = kNan}}); },
      [&] { world.set_wind({.gusts = {.strength = -1}}); },
      [&] { world.set_wind({.gusts = {.strength = kNan}}); },
      [&] { world.step(0); },
      [&] { world.step(kNan); },
      [&] { world.cloth(2); },
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
