#include "weft/world/attachment.h"

#include <gtest/gtest.h>

#include "tests/support.h"
#include "weft/error.h"
#include "weft/world/measures.h"

namespace weft::engine {
namespace {

constexpr int kCells = 8;
const Vec3 kWeights(0.2, 0.3, 0.5);

/// A square metre of cloth, 200 g, as stiff as real fabric.
struct Sheet {
  World world;
  ClothId cloth;

  explicit Sheet(std::string_view integrator, double stiffness = 2000) {
    world.set_integrator({.integrator = std::string(integrator)});
    world.set_contact(false);
    cloth = world.add_cloth(
        {.topology = build_grid_topology(test::square(kCells), SpringModel::alternating),
         .material = {
             .structural = stiffness, .shear = stiffness / 2, .bend = stiffness / 100, .damping = 0.01}});
  }

  Attachment middle() const {
    return make_attachment(world.model(cloth), world.state(cloth), kCells * kCells, kWeights);
  }

  void hold(double stiffness, double damping, const Vec3& target) {
    Attachment attachment = middle();
    attachment.stiffness = stiffness;
    attachment.damping = damping;
    attachment.target = target;
    world.set_attachments(cloth, {attachment});
  }

  Vec3 held_point() const {
    const Triangle& t = world.model(cloth).topology->mesh.triangles[kCells * kCells];
    Vec3 point = Vec3::Zero();
    for (int corner = 0; corner < 3; ++corner)
      point += kWeights[corner] * world.state(cloth).position(t[corner]);
    return point;
  }

  double height() const { return compute_center_of_mass(world.model(cloth), world.state(cloth)).y(); }

  void advance(int num_steps, double step) {
    for (int s = 0; s < num_steps; ++s) ASSERT_TRUE(world.step(step).ok) << "step " << s;
  }
};

TEST(Attachment, SharesTheSpringAmongTheSurroundingsOfAPoint) {
  const Sheet sheet("desbrun");
  const Attachment attachment = sheet.middle();
  double sum = 0;
  for (const double share : attachment.shares) {
    EXPECT_GT(share, 0);
    sum += share;
  }
  EXPECT_NEAR(sum, 1, 1e-12);
  EXPECT_GE(attachment.particles.size(), 3u);
  EXPECT_LT(attachment.particles.size(), 20u) << "a patch of a few cells, not the whole cloth";
  EXPECT_LT((attachment.target - sheet.held_point()).norm(), 1e-7)
      << "rounding: nothing jumps when cloth is grabbed";
}

TEST(Attachment, IsStableAtAnyStiffnessAndReachesItsTargetWithEveryIntegrator) {
  const Vec3 aim(0.4, 0.3, 0.6);
  for (const std::string_view name : integrator_names()) {
    // The paper's scheme needs soft springs: the test is about the attachment.
    const double cloth_stiffness = name == "paper" || name == "explicit" ? 20 : 2000;
    for (const double step : {1.0 / 60, 1.0 / 600}) {
      for (const double k : {1.0, 1e2, 1e4, 1e6, 1e8}) {
        SCOPED_TRACE(std::string(name) + ", " + std::to_string(k) + " N/m, step " + std::to_string(step));
        Sheet sheet(name, cloth_stiffness);
        sheet.hold(k, 0.06 * k, aim);
        sheet.advance(static_cast<int>(3 / step), step);
        // At rest the spring carries the cloth: 1.96 N, and up to three times that in paper_fixed, which
        // filters the load of its springs but not the weight. The paper's damping ends a swing slowly, and a
        // spring of 1 N/m is still on its way down.
        if (k < 100) continue;
        const double weight = name == "paper_fixed" ? 6 : 1.96;
        EXPECT_LT((sheet.held_point() - aim).norm(), weight / k + 0.02);
      }
    }
  }
}

TEST(Attachment, HoldsHeavyClothByOneLightParticle) {
  // A ten-thousandth of the cloth's mass, and a spring of any stiffness.
  for (const double k : {1e2, 1e5, 1e8}) {
    Sheet sheet("desbrun");
    Attachment attachment{
        .particles = {40}, .shares = {1}, .offsets = {Vec3::Zero()}, .stiffness = k, .damping = 0.06 * k};
    attachment.target = sheet.world.state(sheet.cloth).position(40) + Vec3(0, 0.2, 0);
    sheet.world.set_attachments(sheet.cloth, {attachment});
    sheet.advance(240, 1.0 / 60);
    // Desbrun's constant matrix damps the end of the swing slowly.
    EXPECT_LT((sheet.world.state(sheet.cloth).position(40) - attachment.target).norm(), 1.96 / k + 0.02) << k;
  }
}

TEST(Attachment, GivesTheMomentumThatItSaysItGives) {
  for (const char* name : {"explicit", "desbrun", "implicit_euler"}) {
    for (const double k : {10.0, 1e3, 1e6}) {
      Sheet sheet(name, 200);
      sheet.world.set_gravity(Vec3::Zero());
      sheet.hold(k, 0.06 * k, {0.8, 0.2, 0.1});
      Vec3 given = Vec3::Zero();
      for (int s = 0; s < 20; ++s) {
        ASSERT_TRUE(sheet.world.step(1.0 / 240).ok);
        given += sheet.world.attachment_impulse(sheet.cloth);
      }
      const Vec3 momentum = compute_momentum(sheet.world.model(sheet.cloth), sheet.world.state(sheet.cloth));
      EXPECT_GT(momentum.norm(), 0.005) << name << " has been set in motion";
      // Floats: h k times a distance with an error of 1e-7 m, over 20 steps. implicit_euler stops at 1e-2 m/s
      // per particle, at worst 2e-3 kg m/s for the whole cloth.
      const double tolerance =
          1e-5 + 20.0 / 240 * k * 2e-7 + (std::string(name) == "implicit_euler" ? 2e-3 : 0);
      EXPECT_LT((momentum - given).norm(), tolerance) << name << ", " << k;
    }
  }
}

TEST(Attachment, LetsGoOfClothThatThenFallsFreely) {
  Sheet sheet("desbrun");
  sheet.hold(1e4, 600, sheet.held_point());
  sheet.advance(60, 1.0 / 60);
  sheet.world.set_attachments(sheet.cloth, {});
  const double before = sheet.height();
  const double speed =
      compute_momentum(sheet.world.model(sheet.cloth), sheet.world.state(sheet.cloth)).y() / 0.2;
  sheet.advance(30, 1.0 / 60);
  const double t = 0.5;
  // The fall of implicit Euler, h/2 ahead; floats.
  EXPECT_NEAR(sheet.height() - before, speed * t - 0.5 * 9.81 * t * (t + 1.0 / 60), 1e-3);
  EXPECT_EQ(sheet.world.attachment_impulse(sheet.cloth), Vec3(Vec3::Zero()));
}

TEST(Attachment, LeavesPinsWhereTheyAre) {
  Sheet sheet("paper_fixed");
  sheet.world.set_pins(sheet.cloth, {{.particles = {40}, .motion = {}}});
  const Vec3 pinned = sheet.world.state(sheet.cloth).position(40);
  sheet.hold(1e3, 60, {0.5, 1, 0.5});
  sheet.advance(30, 1.0 / 60);
  EXPECT_LT((sheet.world.state(sheet.cloth).position(40) - pinned).norm(), 1e-6);
}

TEST(Attachment, TwoHandsOnOnePatchAddUp) {
  Sheet one("desbrun"), two("desbrun");
  one.hold(1e3, 60, {0.5, 0.4, 0.5});
  Attachment half = two.middle();
  half.stiffness = 5e2;
  half.damping = 30;
  half.target = {0.5, 0.4, 0.5};
  two.world.set_attachments(two.cloth, {half, half});
  one.advance(20, 1.0 / 60);
  two.advance(20, 1.0 / 60);
  EXPECT_LT((one.held_point() - two.held_point()).norm(), 1e-5) << "rounding";
}

TEST(Attachment, RefusesParticlesThatAreNotThere) {
  Sheet sheet("desbrun");
  Attachment attachment = sheet.middle();
  attachment.particles[0] = 1000;
  EXPECT_THROW(sheet.world.set_attachments(sheet.cloth, {attachment}), InputError);
  attachment = sheet.middle();
  attachment.stiffness = -1;
  EXPECT_THROW(sheet.world.set_attachments(sheet.cloth, {attachment}), InputError);
}

}  // namespace
}  // namespace weft::engine
