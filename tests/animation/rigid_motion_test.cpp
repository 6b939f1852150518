#include "weft/animation/rigid_motion.h"

#include <gtest/gtest.h>

#include "weft/error.h"

namespace weft::engine {
namespace {

TEST(RigidMotion, InterpolatesBetweenKeysAndStaysOutside) {
  const RigidMotion motion({{1, {0, 0, 0}, {0, 0, 0}}, {3, {2, 0, 0}, {0, 180, 0}}});
  EXPECT_EQ(motion.at(0).translation, Vec3(0, 0, 0));
  EXPECT_EQ(motion.at(2).translation, Vec3(1, 0, 0));
  EXPECT_EQ(motion.at(5).translation, Vec3(2, 0, 0));
  EXPECT_EQ(motion.at(2).rotation * Vec3::UnitX(), -Vec3::UnitZ()) << "half of a half turn about y";
}

TEST(RigidMotion, GoesRoundSeveralTimes) {
  const RigidMotion motion({{.time = 0}, {.time = 1, .angles_deg = {0, 0, 720}}});
  EXPECT_LT((motion.at(0.125).rotation * Vec3::UnitX() - Vec3::UnitY()).norm(), 1e-15);
}

TEST(RigidMotion, InverseTakesPointsBack) {
  const Pose pose{{1, 2, 3}, rotation_from_angles_deg({20, 50, -70})};
  const Vec3 pivot(0.3, 0.2, 0.1), p(5, 4, 3);
  EXPECT_LT((apply_inverse(pose, pivot, apply(pose, pivot, p)) - p).norm(), 1e-14);
}

TEST(RigidMotion, RefusesKeysThatDoNotGoForward) {
  EXPECT_THROW(RigidMotion({{.time = 1}, {.time = 1}}), InputError);
}

}  // namespace
}  // namespace weft::engine
