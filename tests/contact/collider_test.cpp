#include "weft/contact/collider.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/support.h"
#include "weft/contact/contact_system.h"

namespace weft::engine {
namespace {

TEST(SignedDistance, OfASphereAndAPlane) {
  const ColliderShape sphere = Sphere{{1, 0, 0}, 0.5};
  EXPECT_NEAR(signed_distance(sphere, {3, 0, 0}).distance, 1.5, 1e-15);
  EXPECT_NEAR(signed_distance(sphere, {1, 0.25, 0}).distance, -0.25, 1e-15);
  EXPECT_EQ(signed_distance(sphere, {3, 0, 0}).normal, Vec3::UnitX());
  EXPECT_EQ(signed_distance(sphere, {1, 0, 0}).normal, Vec3::UnitY()) << "some direction at the centre";
  const ColliderShape plane = Plane{{0, 1, 0}, Vec3::UnitY()};
  EXPECT_NEAR(signed_distance(plane, {5, 0.25, 7}).distance, -0.75, 1e-15);
}

TEST(Collider, GoesWhereItsMotionTakesItAboutItsPivot) {
  const RigidMotion motion({{.time = 0}, {.time = 1, .translation = {1, 2, 3}, .angles_deg = {0, 90, 0}}});
  const Collider capsule{"capsule", Capsule{{-1, 0, 0}, {1, 0, 0}, 0.1}, 0.3, motion};
  const Capsule moved = std::get<Capsule>(shape_at(capsule, 1));
  EXPECT_LT((moved.a - Vec3(1, 2, 4)).norm(), 1e-14);  // a few roundings
  EXPECT_LT((moved.b - Vec3(1, 2, 2)).norm(), 1e-14);
}

/// A cloth of lone particles that only contact moves. Mass 0.01 kg each.
struct Particles {
  std::shared_ptr<const ClothModel> model;
  ClothState state;
  std::vector<char> is_pinned;
  ContactSystem contact;

  Particles(const std::vector<Vec3>& places, double thickness)
      : model(build_cloth_model(test::chain(places, 0.01, 1.0),
                                {.density = 1, .structural = 0, .thickness = thickness})),
        state(make_state(places)),
        is_pinned(places.size(), 0) {}

  /// The particles are at the start of the step; `move` sets their ends.
  template <class Move>
  void step(const std::vector<Collider>& colliders, const ContactStep& step, const Move& move) {
    const ContactCloth cloth{model.get(), &state, &is_pinned};
    contact.begin_step({&cloth, 1}, colliders, step, *make_serial_jobs());
    move();
    contact.read_solution({});
    contact.find_violations(*make_serial_jobs());
    contact.project_contacts(*make_serial_jobs());
  }

  void project_contacts(const std::vector<Collider>& colliders, const ContactStep& step) {
    this->step(colliders, step, [] {});
  }

  /// Ballistic flight for one step, by semi-implicit Euler.
  void fall(const std::vector<Collider>& colliders, const ContactStep& step) {
    this->step(colliders, step, [&] {
      for (std::size_t i = 0; i < state.x.size(); ++i) {
        state.v.set(i, state.v.get(i) + step.step * Vec3(0, -9.81, 0));
        state.x.set(i, state.x.get(i) + step.step * state.v.get(i));
      }
    });
  }
};

/// One particle on a plane tilted by `angle_deg`, sliding from rest for a second: its displacement down the
/// slope.
double slide(double angle_deg, double friction) {
  const Mat3 tilt = rotation_from_angles_deg({0, 0, angle_deg});
  const std::vector<Collider> colliders = {
      {"slope", Plane{Vec3::Zero(), tilt * Vec3::UnitY()}, friction, {}}};
  Particles particles({Vec3::Zero(), Vec3(0, 0, 1)}, 0.0);
  constexpr int kSteps = 500;
  for (int s = 1; s <= kSteps; ++s) {
    particles.fall(colliders, {.time = s / double{kSteps}, .step = 1.0 / kSteps});
  }
  return particles.state.position(0).dot(tilt * -Vec3::UnitX());
}

TEST(Friction, HoldsWhereTheTangentIsBelowTheCoefficient) {
  EXPECT_LT(std::abs(slide(20, 0.4)), 1e-5);  // tan 20° = 0.364; floats drift by their rounding
}

TEST(Friction, SlowsASlideByTheCoefficient) {
  for (const double friction : {0.0, 0.2, 0.5}) {
    const double radians = 30 * 3.14159265358979 / 180;
    const double expected = 0.5 * 9.81 * (std::sin(radians) - friction * std::cos(radians));
    EXPECT_NEAR(slide(30, friction), expected, 0.005 * expected) << friction;  // Euler's own error is 1/500
  }
}

TEST(ContactSystem, MovingColliderTakesClothAlong) {
  // A ball rises under a particle that friction keeps on it: no particle is ever inside.
  const RigidMotion lift({{.time = 0}, {.time = 1, .translation = {0, 0.5, 0}}});
  const std::vector<Collider> colliders = {{"ball", Sphere{Vec3::Zero(), 0.5}, 0.5, lift}};
  Particles particles({{0, 0.5, 0}, {0.01, 0.5, 0}}, 0.002);
  for (int s = 1; s <= 60; ++s) {
    particles.fall(colliders, {.time = s / 60.0, .step = 1.0 / 60});
    for (const std::size_t i : {0, 1}) {
      EXPECT_GE(signed_distance(shape_at(colliders[0], s / 60.0), particles.state.position(i)).distance, 0)
          << s;
    }
  }
  EXPECT_NEAR(particles.state.position(0).y(), 1.001, 1e-4);  // half the thickness, plus a share of g h²
  EXPECT_NEAR(particles.state.v.get(0).y(), 0.5, 1e-3);       // the ball's
}

TEST(ContactSystem, TurningColliderTakesClothAlongByFriction) {
  // On a turntable at r = 0.1 m, a quarter turn per second: µ g is far more than ω² r.
  const RigidMotion turn({{.time = 0}, {.time = 1, .angles_deg = {0, 90, 0}}});
  const std::vector<Collider> colliders = {
      {"table", OrientedBox{{0, -0.5, 0}, {1, 0.5, 1}, Mat3::Identity()}, 0.5, turn}};
  Particles particles({{0.1, 0.001, 0}, {-0.1, 0.001, 0}}, 0.002);
  constexpr int kSteps = 240;
  for (int s = 1; s <= kSteps; ++s) {
    particles.fall(colliders, {.time = s / double{kSteps}, .step = 1.0 / kSteps});
  }
  // It slips while it accelerates, v²/(2 µ g) = 2.5 mm, and is thrown outwards by a second-order share.
  EXPECT_LT((particles.state.position(0) - Vec3(0, 0.001, -0.1)).norm(), 0.005);
}

TEST(ContactSystem, LeavesPinnedParticlesWhereTheyAre) {
  const std::vector<Collider> colliders = {{"ball", Sphere{Vec3::Zero(), 0.5}, 0.5, {}}};
  Particles particles({{0, 0.2, 0}, {0.1, 0.2, 0}}, 0.002);
  particles.is_pinned[0] = 1;
  const Vec3 before = particles.state.position(0);
  particles.project_contacts(colliders, {.time = 1, .step = 0.01});
  EXPECT_EQ(particles.state.position(0), before);
  EXPECT_GE(particles.state.position(1).norm(), 0.5);
}

TEST(ContactSystem, OnAHeavyLandingNothingStaysInsideNorBouncesBack) {
  const std::vector<Collider> colliders = {{"floor", Plane{}, 0.3, {}}};
  Particles particles({{0, 0.3, 0}, {1, 0.1, 0}}, 0.002);
  for (std::size_t i = 0; i < 2; ++i) particles.state.v.set(i, {0, -40, 0});
  particles.fall(colliders, {.time = 1, .step = 1.0 / 60});
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_NEAR(particles.state.position(i).y(), 0.001, 1e-6);  // half the thickness; floats round
    EXPECT_NEAR(particles.state.v.get(i).y(), 0, 1e-6) << "lands without a bounce";
  }
}

TEST(ContactSystem, BetweenTwoCollidersBothAreObeyed) {
  // In a groove of two planes: the push of one must not bring cloth into the other.
  const Mat3 left = rotation_from_angles_deg({0, 0, -30}), right = rotation_from_angles_deg({0, 0, 50});
  const std::vector<Collider> colliders = {{"left", Plane{Vec3::Zero(), left * Vec3::UnitY()}, 0.2, {}},
                                           {"right", Plane{Vec3::Zero(), right * Vec3::UnitY()}, 0.2, {}}};
  Particles particles({{0, 0.2, 0}, {0.05, 0.3, 1}}, 0.002);
  for (int s = 1; s <= 300; ++s) {
    particles.fall(colliders, {.time = s / 300.0, .step = 1.0 / 300});
    for (const std::size_t i : {0, 1}) {
      for (const Collider& c : colliders) {
        // Passes over the constraints end below 1e-6 m; floats round at 1e-8 m.
        EXPECT_GE(signed_distance(c.shape, particles.state.position(i)).distance, 0.001 - 1e-5)
            << c.name << s;
      }
    }
  }
  EXPECT_LT(particles.state.v.get(0).norm(), 1e-3) << "it has come to rest at the bottom";
}

TEST(ContactSystem, FastParticleDoesNotPassThroughASmallBall) {
  // 0.8 m within a step, through a ball of 0.1 m: the whole motion counts, unless it ends beyond.
  const std::vector<Collider> colliders = {{"ball", Sphere{Vec3::Zero(), 0.1}, 0.0, {}}};
  Particles particles({{0, 0.12, 0}, {1, 0.12, 0}}, 0.002);
  for (std::size_t i = 0; i < 2; ++i) particles.state.v.set(i, {0, -10, 0});
  particles.fall(colliders, {.time = 1, .step = 1.0 / 60});  // ends 0.05 m below the centre
  EXPECT_GT(particles.state.position(0).y(), 0.1) << "set back on the side that it came from";
  EXPECT_LT(particles.state.position(1).y(), 0) << "the other one has nothing in its way";
}

}  // namespace
}  // namespace weft::engine
