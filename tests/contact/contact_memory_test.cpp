#include "weft/contact/contact_memory.h"

#include <gtest/gtest.h>

#include <array>

#include "tests/support.h"
#include "weft/world/world.h"

namespace weft::engine {
namespace {

Constraint pair(std::array<int, 4> vertex, std::array<double, 4> weight) {
  Constraint c;
  c.num_vertices = 4;
  c.vertex = vertex;
  c.weight = weight;
  return c;
}

/// A cloth of four particles, which remember forces.
ClothState make_cloth() {
  ClothState state = make_state({{0, 0, 0}, {1, 0, 0}, {0, 0, 1}, {1, 0, 1}});
  state.history.step = 1;
  return state;
}

TEST(ContactMemory, KeepsWhatTwoStepsBear) {
  ClothState state = make_cloth();
  const Constraint c = pair({0, 1, 2, 3}, {-0.2, -0.3, -0.5, 1});
  const double borne[] = {5, 2, 3, 0, 4};    // in each step [N]
  const double lasting[] = {0, 0, 2, 2, 0};  // known at its start
  const bool was_pressed[] = {false, true, true, true, false};
  for (int step = 0; step < 5; ++step) {
    ContactMemory memory;
    memory.begin_step(4);
    memory.read(0, state);
    EXPECT_NEAR(memory.lasting_force(c), lasting[step], 1e-6) << step;
    EXPECT_EQ(memory.was_pressed(c), was_pressed[step]) << step;
    memory.add(c, borne[step]);
    memory.store(0, state);
  }
}

TEST(ContactMemory, SolvesAgainWithoutTheForcesOfTheFirstSolve) {
  ClothState state = make_cloth();
  const Constraint c = pair({0, 1, 2, 3}, {-0.2, -0.3, -0.5, 1});
  ContactMemory memory;
  memory.begin_step(4);
  memory.add(c, 7);
  memory.restart();
  memory.store(0, state);
  EXPECT_TRUE(state.history.pressed.last.empty());
}

TEST(ContactMemory, IsOfClothOnClothOnly) {
  // The particle 3 lies on a collider, vertices 4 to 6, and cloth on it.
  ClothState state = make_cloth();
  const Constraint on_body = pair({4, 5, 6, 3}, {-0.2, -0.3, -0.5, 1}),
                   on_cloth = pair({0, 1, 2, 3}, {-0.2, -0.3, -0.5, 1});
  ContactMemory memory;
  for (int step = 0; step < 3; ++step) {
    memory.begin_step(4);
    memory.read(0, state);
    if (step == 2) break;
    memory.add(on_body, 4);
    memory.store(0, state);
  }
  EXPECT_EQ(memory.lasting_force(on_body), 0);
  EXPECT_EQ(memory.lasting_force(on_cloth), 0);
  EXPECT_FALSE(memory.was_pressed(on_cloth));
}

TEST(ContactMemory, EndsWhileContactIsOff) {
  World world;
  world.add_collider({"floor", Plane{Vec3::Zero(), Vec3::UnitY()}, 0.4, {}});
  const auto topology = build_grid_topology(test::square(8, 0.5), SpringModel::simplified);
  for (const double height : {6e-4, 1.7e-3}) {
    std::vector<Vec3> positions;
    for (const Vec3& p : topology->mesh.positions) positions.push_back(p + Vec3(0, height, 0));
    world.add_cloth({.name = "sheet", .topology = topology, .positions = positions});
  }
  for (int s = 0; s < 20; ++s) world.step(1.0 / 60);
  const MotionHistory::Pressed& pressed = world.state(world.cloth(1)).history.pressed;
  EXPECT_FALSE(pressed.lasting.empty());
  world.set_contact(false);
  EXPECT_TRUE(pressed.last.empty() && pressed.lasting.empty());
}

}  // namespace
}  // namespace weft::engine
