/// Only cloths in contact are solved together.

#include "weft/integrators/contact_groups.h"

#include <gtest/gtest.h>

#include "tests/support.h"
#include "weft/forces/potential.h"
#include "weft/integrators/floating_components.h"
#include "weft/world/measures.h"
#include "weft/world/world.h"

namespace weft::engine {
namespace {

std::vector<int> to_vector(std::span<const int> items) { return {items.begin(), items.end()}; }

Contact between(int particle, int other) {
  Contact contact;
  contact.num_particles = 2;
  contact.particle = {particle, other};
  contact.weight = {1, -1};
  return contact;
}

TEST(ContactGroups, AreTheComponentsOfWhatTouches) {
  const auto model = build_cloth_model(build_grid_topology(test::square(1), SpringModel::basic), {});
  const std::vector<Body> bodies(5, Body{.model = model.get()});  // of four particles each
  const std::vector<Contact> contacts = {between(17, 6), between(2, 2), between(5, 18), between(9, 13)};
  ContactGroups groups;
  groups.find(bodies, contacts);
  ASSERT_EQ(groups.size(), 3);
  EXPECT_EQ(to_vector(groups.bodies(0)), std::vector({0}));
  EXPECT_EQ(to_vector(groups.bodies(1)), std::vector({1, 4}));
  EXPECT_EQ(to_vector(groups.bodies(2)), std::vector({2, 3}));
  EXPECT_EQ(to_vector(groups.contacts(0)), std::vector({1}));
  EXPECT_EQ(to_vector(groups.contacts(1)), std::vector({0, 2}));
  EXPECT_EQ(to_vector(groups.contacts(2)), std::vector({3}));
  EXPECT_EQ(groups.body_of(11), 2);
  EXPECT_EQ(groups.first_particle(4), 16);
}

TEST(ContactGroups, OfNothingThatTouchesAreAllCloths) {
  const auto model = build_cloth_model(build_grid_topology(test::square(1), SpringModel::basic), {});
  const std::vector<Body> bodies(3, Body{.model = model.get()});
  ContactGroups groups;
  groups.find(bodies, {});
  ASSERT_EQ(groups.size(), 3);
  for (int g = 0; g < 3; ++g) {
    EXPECT_EQ(to_vector(groups.bodies(g)), std::vector({g}));
    EXPECT_TRUE(groups.contacts(g).empty());
  }
}

/// Two cloths of one cell and one weight each, whose particles are all displaced by (1, 0, 0) and (3, 0, 0).
struct FreeBodiesTest : testing::Test {
  const std::shared_ptr<const ClothModel> model =
      build_cloth_model(build_grid_topology(test::square(1), SpringModel::basic), {});
  const PaddedRows rows = padded_rows_of(*model->topology);
  FloatingComponents components;
  std::vector<float> weight = std::vector<float>(rows.size(), 1);
  Vec3Array moved[2] = {Vec3Array(rows.size()), Vec3Array(rows.size())};
  FreeBodies bodies;

  void SetUp() override {
    components.find(*model, {});
    const FreeBodies::Member member{.components = &components, .rows = &rows, .weight = &weight};
    bodies.begin(std::vector{member, member});
    for (const int m : {0, 1}) {
      for (int i = 0; i < model->num_particles(); ++i) moved[m].set(rows.index(i), Vec3(1 + 2 * m, 0, 0));
    }
  }

  /// Displacement of each cloth's first particle, after removal of the means.
  std::array<double, 2> remove_mean() {
    Vec3Array* const displacements[] = {&moved[0], &moved[1]};
    bodies.remove_mean(displacements);
    return {moved[0].get(rows.index(0)).x(), moved[1].get(rows.index(0)).x()};
  }
};

TEST_F(FreeBodiesTest, AloneHaveNoMean) { EXPECT_EQ(remove_mean(), (std::array{0.0, 0.0})); }

TEST_F(FreeBodiesTest, ThatPushEachOtherHaveNoneInCommon) {
  bodies.touch(std::vector<FreeBodies::Place>{{0, 2}, {1, 3}}, true);
  EXPECT_EQ(remove_mean(), (std::array{-1.0, 1.0}));
}

TEST_F(FreeBodiesTest, OfWhichOneIsPushedFromOutsideAreLeftAlone) {
  bodies.touch(std::vector<FreeBodies::Place>{{0, 2}, {1, 3}}, true);
  bodies.touch(std::vector<FreeBodies::Place>{{1, 0}}, false);
  EXPECT_EQ(remove_mean(), (std::array{1.0, 3.0}));
}

TEST_F(FreeBodiesTest, LetGoAreFreeAgain) {
  bodies.touch(std::vector<FreeBodies::Place>{{0, 2}}, false);
  bodies.release();
  EXPECT_EQ(remove_mean(), (std::array{0.0, 0.0}));
}

/// A sheet on the floor at `place`, optionally with two more beside it that fall on each other.
World make_heap(const char* integrator, bool with_others) {
  World world;
  world.set_integrator({.integrator = integrator});
  world.set_division({.enabled = false});
  world.add_collider({"floor", Plane{Vec3::Zero(), Vec3::UnitY()}, 0.3, {}});
  const auto topology = build_grid_topology(test::square(8, 0.4), SpringModel::alternating);
  const auto add = [&](const Vec3& place) {
    std::vector<Vec3> positions;
    for (const Vec3& p : topology->mesh.positions) positions.push_back(p + place);
    world.add_cloth({.topology = topology, .material = {.damping = 2e-3}, .positions = positions});
  };
  add({2, 0.01, 0});
  if (with_others) {
    add({0, 0.05, 0});
    add({0.1, 0.1, 0.1});
  }
  return world;
}

TEST(ContactGroups, ClothThatTouchesNoOtherHasTheBitsItHasAlone) {
  for (const char* integrator : {"newton", "implicit_euler"}) {
    World alone = make_heap(integrator, false), among_others = make_heap(integrator, true);
    for (int s = 0; s < 40; ++s) {
      alone.step(1.0 / 60);
      among_others.step(1.0 / 60);
      for (std::size_t i = 0; i < alone.state(alone.cloth(0)).x.size(); ++i) {
        ASSERT_EQ(alone.state(alone.cloth(0)).position(i),
                  among_others.state(among_others.cloth(0)).position(i))
            << integrator << ", step " << s << ", particle " << i;
      }
    }
  }
}

}  // namespace
}  // namespace weft::engine
