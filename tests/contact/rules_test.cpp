/// Contact settings of a pair of bodies, in place of those of the bodies: friction, and the collision filter.

#include <gtest/gtest.h>

#include <cmath>

#include "tests/support.h"
#include "weft/error.h"
#include "weft/world/measures.h"

namespace weft::engine {
namespace {

const ClothMaterial kSoft{.structural = 20, .shear = 10, .bend = 0.2, .damping = 2e-3, .friction = 0.5};

/// A square of 32 cm, centred over the origin.
ClothId add_sheet(World& world, const std::string& name, double height, const Mat3& turn = Mat3::Identity()) {
  constexpr double kSize = 0.32;
  const auto topology = build_grid_topology(test::square(8, kSize), SpringModel::alternating);
  std::vector<Vec3> positions;
  for (const Vec3& p : topology->mesh.positions)
    positions.push_back(turn * (p + Vec3(-kSize / 2, height, -kSize / 2)));
  return world.add_cloth({.name = name, .topology = topology, .material = kSoft, .positions = positions});
}

double height_of(const World& world, ClothId cloth) {
  return compute_center_of_mass(world.model(cloth), world.state(cloth)).y();
}

void run(World& world, double seconds, int steps_per_second) {
  for (int s = 0; s < std::lround(seconds * steps_per_second); ++s)
    ASSERT_TRUE(world.step(1.0 / steps_per_second).ok);
}

TEST(ContactRules, GiveAPairItsOwnFriction) {
  // On a slope of 30° the collider's default friction would hold it.
  const double a = 30 * 3.14159265358979 / 180, friction = 0.2;
  const Mat3 tilt = rotation_from_angles_deg({0, 0, 30});
  World world;
  world.add_collider({"slope", Plane{Vec3::Zero(), tilt * Vec3::UnitY()}, 0.7, {}});
  const ClothId sheet = add_sheet(world, "sheet", kSoft.thickness / 2, tilt);
  world.set_friction("slope", "sheet", 0.9);
  world.set_friction("sheet", "slope", friction);  // the last one wins, whatever the order of the names
  const Vec3 before = compute_center_of_mass(world.model(sheet), world.state(sheet));
  run(world, 0.4, 300);
  const Vec3 moved = compute_center_of_mass(world.model(sheet), world.state(sheet)) - before;
  const double expected = 9.81 * (std::sin(a) - friction * std::cos(a));
  EXPECT_NEAR(-moved.dot(tilt * Vec3::UnitX()) / (0.5 * 0.4 * 0.4), expected, 0.03 * expected);
}

enum class Body { sphere, plane, mesh };
class PassingColliders : public testing::TestWithParam<std::tuple<const char*, Body>> {};

TEST_P(PassingColliders, LetOneClothThroughAndHoldTheOther) {
  const auto [integrator, body] = GetParam();
  World world;
  world.set_integrator({.integrator = integrator});
  const auto mesh = std::make_shared<const TriangleMesh>(
      make_box_mesh(Vec3(0, -0.2, 0), Vec3(0.3, 0.2, 0.3), Mat3::Identity()));
  const ColliderShape shapes[] = {Sphere{Vec3(0, -0.2, 0), 0.2}, Plane{Vec3::Zero(), Vec3::UnitY()},
                                  MeshShape{.mesh = mesh}};
  world.add_collider({"body", shapes[static_cast<int>(body)], 0.5, {}});
  const ClothId held = add_sheet(world, "held", 0.01), passing = add_sheet(world, "passing", 0.03);
  world.set_collision("body", "passing", false);
  world.set_collision("held", "passing", false);
  run(world, 0.4, 120);
  EXPECT_GT(height_of(world, held), -0.2) << "lies or hangs on the body";
  EXPECT_LT(height_of(world, passing), -0.5) << "free fall in 0.4 s: 0.75 m";
  world.set_collision("held", "body", false);
  run(world, 0.4, 120);
  EXPECT_LT(height_of(world, held), -0.5) << "rules may change between steps";
}

INSTANTIATE_TEST_SUITE_P(All, PassingColliders,
                         testing::Combine(testing::Values("newton", "implicit_euler", "paper_fixed"),
                                          testing::Values(Body::sphere, Body::plane, Body::mesh)));

TEST(ContactRules, LetClothThroughItself) {
  // The two halves of a fold pass through each other; with contact the upper one stays above.
  const auto topology = build_grid_topology({.size_x = 0.4, .size_z = 0.2, .cells_x = 16, .cells_z = 8},
                                            SpringModel::alternating);
  const auto lowest_gap = [&](bool collide) {
    World world;
    world.set_gravity(Vec3::Zero());
    const ClothId fold = world.add_cloth({.name = "fold", .topology = topology, .material = kSoft});
    world.set_collision("fold", "fold", collide);
    ClothState state = world.state(fold);
    for (std::size_t i = 0; i < state.x.size(); ++i) {
      const Vec3 p = topology->mesh.positions[i];
      if (p.x() <= 0.2) continue;
      state.set_position(i, {0.4 - p.x(), 0.02, p.z()});
      state.v.set(i, Vec3(0, -1, 0));
    }
    world.restore({.time = 0, .states = {state}});
    double gap = 1;
    for (int s = 0; s < 12; ++s) {
      EXPECT_TRUE(world.step(1.0 / 120).ok);
      gap = std::min(gap, world.state(fold).position(16).y() - world.state(fold).position(0).y());
    }
    return gap;
  };
  EXPECT_GT(lowest_gap(true), 0);
  EXPECT_LT(lowest_gap(false), -0.01);
}

TEST(ContactRules, NameWhatIsWrong) {
  World world;
  world.add_collider({"ball", Sphere{Vec3::Zero(), 1}, 0.5, {}});
  add_sheet(world, "sheet", 2);
  const auto message = [&](const char* a, const char* b, double friction) -> std::string {
    try {
      world.set_friction(a, b, friction);
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_EQ(message("sheet", "bal", 0.1), "no cloth or collider is named \"bal\"");
  EXPECT_NE(message("ball", "ball", 0.1).find("one of the two must be a cloth"), std::string::npos);
  EXPECT_NE(message("sheet", "ball", -1).find("must be 0 or more"), std::string::npos);
  EXPECT_TRUE(world.non_colliding_pairs().empty());
}

}  // namespace
}  // namespace weft::engine
