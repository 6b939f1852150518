#include "weft/contact/collider.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/support.h"
#include "weft/contact/response.h"

namespace weft {
namespace {

TEST(SignedDistance, OfASphereAndAPlane) {
  const Sphere sphere{{1, 0, 0}, 0.5};
  EXPECT_NEAR(signed_distance(sphere, {3, 0, 0}).distance, 1.5, 1e-15);
  EXPECT_NEAR(signed_distance(sphere, {1, 0.25, 0}).distance, -0.25, 1e-15);
  EXPECT_EQ(signed_distance(sphere, {3, 0, 0}).normal, Vec3::UnitX());
  EXPECT_EQ(signed_distance(sphere, {1, 0, 0}).normal, Vec3::UnitY()) << "some direction at the centre";
  const Plane plane{{0, 1, 0}, Vec3::UnitY()};
  EXPECT_NEAR(signed_distance(plane, {5, 0.25, 7}).distance, -0.75, 1e-15);
}

void hold_off(const std::vector<Collider>& colliders, const ContactStep& step,
              const std::vector<char>& is_pinned, ClothState& state) {
  ContactResponse response;
  response.begin_step(colliders, step);
  response.hold_off(is_pinned, *make_serial_jobs(), state);
}

/// One particle on a plane tilted by `angle_deg`, sliding from rest for a second: how far it has gone down
/// the slope.
double slide(double angle_deg, double friction) {
  const Vec3 normal = rotation_from_angles_deg({0, 0, angle_deg}) * Vec3::UnitY();
  const std::vector<Collider> colliders = {{"slope", Plane{Vec3::Zero(), normal}, friction, {}}};
  const auto model = build_cloth_model(test::chain({Vec3::Zero(), Vec3(0, 0, 1)}, 0.01, 1.0), {});
  ClothState state = make_state(model->topology->mesh.positions);
  const auto integrator = test::integrator("implicit_euler");
  const auto jobs = make_serial_jobs();
  constexpr int kSteps = 500;
  for (int s = 1; s <= kSteps; ++s) {
    integrator->advance(*model, {}, 1.0 / kSteps, *jobs, state);
    hold_off(colliders, {.time = s / double{kSteps}, .step = 1.0 / kSteps}, {0, 0}, state);
  }
  const Vec3 down_slope = rotation_from_angles_deg({0, 0, angle_deg}) * -Vec3::UnitX();
  return state.position(0).dot(down_slope);
}

TEST(Friction, HoldsWhereTheTangentIsBelowTheCoefficient) {
  EXPECT_LT(std::abs(slide(20, 0.4)), 1e-5);  // tan 20° = 0.364; floats drift by their rounding
}

TEST(Friction, SlowsASlideByTheCoefficient) {
  for (const double friction : {0.0, 0.2}) {
    const double radians = 30 * 3.14159265358979 / 180;
    const double expected = 0.5 * 9.81 * (std::sin(radians) - friction * std::cos(radians));
    EXPECT_NEAR(slide(30, friction), expected, 0.005 * expected);  // Euler's own error is 1/500
  }
}

TEST(Contact, MovingColliderTakesClothAlong) {
  // A ball rolls up under a particle that friction keeps on it: no particle is ever inside.
  const RigidMotion lift({{.time = 0}, {.time = 1, .translation = {0, 0.5, 0}}});
  const std::vector<Collider> colliders = {{"ball", Sphere{Vec3::Zero(), 0.5}, 0.5, lift}};
  const auto model = build_cloth_model(test::chain({{0, 0.5, 0}, {0.01, 0.5, 0}}, 0.01, 0.01), {});
  ClothState state = make_state(model->topology->mesh.positions);
  const auto integrator = test::integrator("implicit_euler");
  const auto jobs = make_serial_jobs();
  for (int s = 1; s <= 60; ++s) {
    integrator->advance(*model, {}, 1.0 / 60, *jobs, state);
    hold_off(colliders, {.gap = 0.001, .time = s / 60.0, .step = 1.0 / 60}, {0, 0}, state);
    for (const std::size_t i : {0, 1}) {
      EXPECT_GE(signed_distance(shape_at(colliders[0], s / 60.0), state.position(i)).distance, 0) << s;
    }
  }
  EXPECT_NEAR(state.position(0).y(), 1.001, 0.002);
  EXPECT_NEAR(state.v.get(0).y(), 0.5, 0.01);
}

TEST(Contact, LeavesPinnedParticlesWhereTheyAre) {
  const std::vector<Collider> colliders = {{"ball", Sphere{Vec3::Zero(), 0.5}, 0.5, {}}};
  ClothState state = make_state({{0, 0.2, 0}, {0.1, 0.2, 0}});
  hold_off(colliders, {.gap = 0.001, .time = 1, .step = 0.01}, {1, 0}, state);
  EXPECT_LT((state.position(0) - Vec3(0, 0.2, 0)).norm(), 1e-7);
  EXPECT_GE(state.position(1).norm(), 0.5);
}

TEST(Contact, OnAHeavyLandingNothingStaysInsideNorBouncesBack) {
  const std::vector<Collider> colliders = {{"floor", Plane{}, 0.3, {}}};
  ClothState state = make_state({{0, -0.3, 0}, {1, -0.1, 0}});
  for (std::size_t i = 0; i < 2; ++i) state.v.set(i, {0, -20, 0});
  hold_off(colliders, {.gap = 0.001, .time = 1, .step = 1.0 / 60}, {0, 0}, state);
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_GE(state.position(i).y(), 0);
    EXPECT_NEAR(state.position(i).y(), 0.001, 1e-6);
    EXPECT_EQ(state.v.get(i).y(), 0);
  }
}

}  // namespace
}  // namespace weft
