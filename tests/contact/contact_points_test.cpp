/// Reported contact points: their forces equal the loads that the contacts carry.

#include <gtest/gtest.h>

#include <cmath>

#include "tests/support.h"
#include "weft/world/measures.h"

namespace weft::engine {
namespace {

constexpr double kGravity = 9.81;
const ClothMaterial kSoft{.structural = 20, .shear = 10, .bend = 0.2, .damping = 2e-3, .friction = 0.5};

double mass_of(const World& world, ClothId cloth) {
  double mass = 0;
  for (const double m : world.model(cloth).mass) mass += m;
  return mass;
}

ClothId add_sheet(World& world, const std::string& name, double size, int cells, const Mat3& turn,
                  double height) {
  const auto topology = build_grid_topology(test::square(cells, size), SpringModel::alternating);
  std::vector<Vec3> positions;
  for (const Vec3& p : topology->mesh.positions)
    positions.push_back(turn * (p + Vec3(-size / 2, height, -size / 2)));
  return world.add_cloth({.name = name, .topology = topology, .material = kSoft, .positions = positions});
}

Vec3 sum_of_forces(const std::vector<ContactPoint>& points) {
  Vec3 sum = Vec3::Zero();
  for (const ContactPoint& p : points) sum += p.force;
  return sum;
}

/// Mean of the sum of contact forces over the last quarter of the steps.
Vec3 settle(World& world, double seconds, int steps_per_second) {
  const int num_steps = static_cast<int>(std::lround(seconds * steps_per_second)), last = num_steps / 4;
  Vec3 mean = Vec3::Zero();
  for (int s = 0; s < num_steps; ++s) {
    EXPECT_TRUE(world.step(1.0 / steps_per_second).ok);
    if (s >= num_steps - last) mean += sum_of_forces(world.contact_points()) / last;
  }
  return mean;
}

struct ContactCase {
  const char* integrator;
  int steps_per_second;
};

class ContactPoints : public testing::TestWithParam<ContactCase> {
 protected:
  World make_world() const {
    World world;
    world.set_integrator({.integrator = GetParam().integrator});
    world.track_contacts(true);
    return world;
  }
};

TEST_P(ContactPoints, OfASheetOnAFloorCarryItsWeight) {
  World world = make_world();
  world.add_collider({"floor", Plane{Vec3::Zero(), Vec3::UnitY()}, 0.5, {}});
  const ClothId sheet = add_sheet(world, "sheet", 0.3, 8, Mat3::Identity(), kSoft.thickness / 2);
  const Vec3 force = settle(world, 0.5, GetParam().steps_per_second);
  const double weight = mass_of(world, sheet) * kGravity;
  EXPECT_NEAR(force.y(), weight, 0.01 * weight);
  EXPECT_LT(std::hypot(force.x(), force.z()), 0.01 * weight);
  const std::vector<ContactPoint> points = world.contact_points();
  EXPECT_GE(points.size(), 81u) << "every particle lies on it";
  for (const ContactPoint& p : points) {
    EXPECT_EQ(p.collider, 0);
    EXPECT_EQ(p.other_cloth, -1);
    EXPECT_NEAR(p.normal.y(), 1, 1e-6);
    EXPECT_NEAR(p.position.y(), kSoft.thickness / 2, 1e-4);
    EXPECT_LT((p.position - world.state(sheet).position(p.particle)).norm(), 1e-3)
        << "particles, not triangles";
  }
}

TEST_P(ContactPoints, OfASheetOnABallCarryItsWeight) {
  World world = make_world();
  world.add_collider({"ball", Sphere{Vec3::Zero(), 0.2}, 0.5, {}});
  const ClothId sheet = add_sheet(world, "sheet", 0.3, 16, Mat3::Identity(), 0.2 + kSoft.thickness / 2);
  const Vec3 force = settle(world, 2.5, GetParam().steps_per_second);
  const double weight = mass_of(world, sheet) * kGravity;
  // It still swings a little, and paper_fixed does not conserve momentum where borders differ.
  const double tolerance = GetParam().integrator == std::string("paper_fixed") ? 0.05 : 0.03;
  EXPECT_NEAR(force.y(), weight, tolerance * weight);
}

TEST_P(ContactPoints, OfASheetThatSticksOnASlopeHoldItByFriction) {
  const double angle = 20 * 3.14159265358979 / 180;  // tan = 0.36
  const Mat3 tilt = rotation_from_angles_deg({0, 0, 20});
  World world = make_world();
  world.add_collider({"slope", OrientedBox{tilt * Vec3(0, -1, 0), {4, 1, 4}, tilt}, 0.5, {}});
  const ClothId sheet = add_sheet(world, "sheet", 0.3, 8, tilt, kSoft.thickness / 2);
  const Vec3 force = settle(world, 0.5, GetParam().steps_per_second);
  const double weight = mass_of(world, sheet) * kGravity;
  EXPECT_NEAR(force.dot(tilt * Vec3::UnitX()), weight * std::sin(angle), 0.02 * weight * std::sin(angle))
      << "friction";
  EXPECT_NEAR(force.dot(tilt * Vec3::UnitY()), weight * std::cos(angle), 0.01 * weight);
}

TEST_P(ContactPoints, OfClothOnClothNameBothAndCarryTheUpperOne) {
  World world = make_world();
  const ClothId below = add_sheet(world, "below", 0.4, 10, Mat3::Identity(), 0);
  std::vector<int> all;
  for (int i = 0; i < world.model(below).num_particles(); ++i) all.push_back(i);
  world.set_pins(below, {{all, {}, Vec3::Zero()}});
  const ClothId above =
      add_sheet(world, "above", 0.3, 8, rotation_from_angles_deg({0, 20, 0}), kSoft.thickness);
  Vec3 force = Vec3::Zero();  // on the upper one
  const int num_steps = GetParam().steps_per_second / 2, last = num_steps / 5;
  for (int s = 0; s < num_steps; ++s) {
    ASSERT_TRUE(world.step(1.0 / GetParam().steps_per_second).ok);
    if (s < num_steps - last) continue;
    for (const ContactPoint& p : world.contact_points()) {
      EXPECT_EQ(p.collider, -1);
      EXPECT_EQ(p.cloth + p.other_cloth, 1);
      force += (world.cloth(p.cloth) == above ? 1.0 : -1.0) / last * p.force;
    }
  }
  const double weight = mass_of(world, above) * kGravity;
  EXPECT_NEAR(force.y(), weight, 0.02 * weight);
}

TEST_P(ContactPoints, AreNoneInFreeFall) {
  World world = make_world();
  world.add_collider({"floor", Plane{Vec3(0, -5, 0), Vec3::UnitY()}, 0.5, {}});
  add_sheet(world, "sheet", 0.3, 8, Mat3::Identity(), 0);
  for (int s = 0; s < 10; ++s) {
    ASSERT_TRUE(world.step(1.0 / GetParam().steps_per_second).ok);
    EXPECT_TRUE(world.contact_points().empty());
  }
}

TEST_P(ContactPoints, DoNotChangeTheMotionByBeingTracked) {
  std::uint64_t hashes[2];
  for (const bool is_tracked : {false, true}) {
    World world = make_world();
    world.track_contacts(is_tracked);
    world.add_collider({"ball", Sphere{Vec3::Zero(), 0.2}, 0.5, {}});
    add_sheet(world, "below", 0.3, 8, Mat3::Identity(), 0.2 + kSoft.thickness);
    add_sheet(world, "above", 0.25, 6, rotation_from_angles_deg({0, 20, 0}), 0.2 + 3 * kSoft.thickness);
    for (int s = 0; s < 20; ++s) ASSERT_TRUE(world.step(1.0 / GetParam().steps_per_second).ok);
    EXPECT_EQ(world.contact_points().empty(), !is_tracked);
    hashes[is_tracked] = world.state_hash();
  }
  EXPECT_EQ(hashes[0], hashes[1]);
}

INSTANTIATE_TEST_SUITE_P(Integrators, ContactPoints,
                         testing::Values(ContactCase{"newton", 60}, ContactCase{"implicit_euler", 60},
                                         ContactCase{"explicit", 300}, ContactCase{"paper_fixed", 300}),
                         [](const auto& test) { return std::string(test.param.integrator); });

}  // namespace
}  // namespace weft::engine
