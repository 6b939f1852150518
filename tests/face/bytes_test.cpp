/// World::save and World::load: the same continuation, and rejection of all other bytes.

#include <gtest/gtest.h>

#include <random>

#include "weft/weft.h"

namespace weft {
namespace {

constexpr double kStep = 1.0 / 60;

/// A garment piece and a grid in contact with bodies of every kind of motion.
World make_busy_world(const std::string& integrator = "newton") {
  World world;
  world.set_integrator({.integrator = integrator});
  world.set_contact({.tracks_points = true});
  world.set_wind({.keys = {{0, {1, 0, 0}}, {0.2, {0, 0, 1}}}, .drag = 0.1});
  const Grid grid{.size_x = 0.5, .size_z = 0.5, .cells_x = 16, .cells_z = 16};
  const ClothId upper =
      world.add_cloth({.name = "upper",
                       .shape = grid,
                       .fabric = integrator == "newton" ? std::variant<Fabric, Springs>(Fabric())
                                                        : Springs{.structural = 300},
                       .pose = {{0, 0.02, 0}, {}}});
  world.set_pins(upper, {{.particles = {0}, .motion = {{0, {}, {}}, {1, {0, 0.2, 0}, {}}}},
                         {.particles = {16, 33}, .stiffness = 50.0, .damping = 0.1}});
  TriangleMesh mesh{.positions = {{0, 0.1, 0}, {0.4, 0.1, 0}, {0.4, 0.1, 0.4}, {0, 0.1, 0.4}, {5, 5, 5}},
                    .triangles = {{0, 2, 1}, {0, 3, 2}}};
  const ClothId lower = world.add_cloth({.shape = mesh, .fabric = Springs{.structural = 300, .bend = 0.1}});
  world.stiffen(lower, {0, 1}, 2);
  const ColliderId ball = world.add_collider(
      {.name = "ball", .shape = Sphere{.radius = 0.15}, .pose = {{0.25, -0.16, 0.25}, {}}});
  const ColliderId body =
      world.add_collider({.shape = TriangleMesh{.positions = {{0, 0, 0}, {1, 0, 0}, {0, 0, 1}, {0, -1, 0}},
                                                .triangles = {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}}},
                          .pose = {{-0.3, -0.4, -0.3}, rotation_about({0, 1, 0}, 20)}});
  world.set_friction(upper, ball, 0.1, 0.2);
  world.set_collision(upper, body, false);
  for (int n = 0; n < 12; ++n) {
    world.move_collider(ball, {{0.25 + 0.002 * n, -0.16, 0.25}, rotation_about({0, 1, 0}, 3.0 * n)});
    world.move_vertices(body, {{0, 0.001 * n, 0}, {1, 0, 0}, {0, 0, 1}, {0, -1, 0}});
    EXPECT_TRUE(world.step(kStep).ok);
  }
  // Targets set now act in the next step.
  world.move_collider(ball, {{0.28, -0.15, 0.25}, {}});
  world.move_pins(upper, {{0, 0.06, 0}, {0.5, 0.1, 0}, {0.5, 0.1, 0.05}});
  world.set_forces(lower, std::vector<Vec3>(4, Vec3{0, 1e-3, 0}));
  return world;
}

std::uint64_t hash_after(World& world, int steps) {
  for (int n = 0; n < steps; ++n) EXPECT_TRUE(world.step(kStep).ok);
  return world.state_hash();
}

TEST(SavedWorlds, ContinueBitForBit) {
  for (const char* integrator : {"newton", "explicit"}) {
    World world = make_busy_world(integrator);
    World loaded = World::load(world.save());
    EXPECT_EQ(loaded.state_hash(), world.state_hash());
    loaded.set_jobs(make_jobs(2));
    EXPECT_EQ(hash_after(loaded, 20), hash_after(world, 20)) << integrator;
    EXPECT_EQ(loaded.name(loaded.collider(0)), "ball");
    EXPECT_FALSE(loaded.contact_points().empty()) << "in contact";
    // And a second time from there.
    World again = World::load(loaded.save());
    EXPECT_EQ(hash_after(again, 10), hash_after(loaded, 10));
  }
}

TEST(SavedWorlds, AreTheSameBytesForTheSameState) {
  World world = make_busy_world();
  EXPECT_EQ(world.save(), world.save());
  EXPECT_EQ(World::load(world.save()).save(), world.save());
}

TEST(SavedWorlds, DamagedBytesAreRefused) {
  const std::vector<std::byte> bytes = make_busy_world().save();
  std::mt19937 random(1);
  for (int n = 0; n < 200; ++n) {
    std::vector<std::byte> damaged = bytes;
    damaged[random() % damaged.size()] ^= static_cast<std::byte>(1 + random() % 255);
    EXPECT_THROW(World::load(damaged), InputError);
    damaged = bytes;
    damaged.resize(random() % bytes.size());
    EXPECT_THROW(World::load(damaged), InputError);
  }
  EXPECT_THROW(World::load({}), InputError);
}

/// Damaged bytes with a valid checksum: the result is a world or an InputError.
TEST(SavedWorlds, ForgedBytesDoNoHarm) {
  const auto forge = [](std::vector<std::byte>& bytes) {  // FNV-1a, as core/hash.h has it
    std::uint64_t sum = 0xcbf29ce484222325ULL;
    for (std::size_t i = 0; i + 8 < bytes.size(); ++i)
      sum = (sum ^ static_cast<std::uint64_t>(bytes[i])) * 0x100000001b3ULL;
    for (int b = 0; b < 8; ++b) bytes[bytes.size() - 8 + b] = static_cast<std::byte>(sum >> (8 * b));
  };
  World world;
  const ClothId cloth = world.add_cloth({.shape = Grid{.cells_x = 2, .cells_z = 2}});
  world.set_pins(cloth, {{.particles = {0}}, {.particles = {1}, .stiffness = 1.0}});
  world.add_collider({.shape = Sphere{}, .pose = {{0, -3, 0}, {}}});
  world.step(kStep);
  const std::vector<std::byte> bytes = world.save();
  int loaded = 0, refused = 0;
  for (std::size_t i = 8; i + 8 < bytes.size(); ++i) {
    for (const int bits : {1, 0x80, 0xff}) {
      std::vector<std::byte> forged = bytes;
      forged[i] ^= static_cast<std::byte>(bits);
      forge(forged);
      try {
        World other = World::load(forged);
        ++loaded;
        if (i % 8 == 0) other.step(kStep);
      } catch (const InputError&) {
        ++refused;
      }
    }
  }
  EXPECT_GT(loaded, 0) << "the checksum fits";
  EXPECT_GT(refused, 0);
}

TEST(SavedWorlds, OfAnotherVersionAreNamed) {
  std::vector<std::byte> bytes = make_busy_world().save();
  bytes[4] = std::byte{99};
  try {
    World::load(bytes);
    FAIL();
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("version 99"), std::string::npos) << error.what();
  }
}

}  // namespace
}  // namespace weft
