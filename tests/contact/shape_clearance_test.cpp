/// ShapeClearance against exhaustive measurement: shapes and points that wander, jump and stop.

#include "weft/contact/shape_clearance.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "tests/support.h"

namespace weft::engine {
namespace {

constexpr int kPoints = 60;
constexpr double kStep = 0.1;  // [s]

std::vector<Collider> make_colliders() {
  const RigidMotion turning({{0, {0, 0, 0}, {0, 0, 0}}, {10, {1, 0.5, 0}, {200, 90, 400}}});
  const RigidMotion sliding({{0, {0, 0, 0}, {0, 0, 0}}, {10, {0, 2, 1}, {0, 0, 0}}});
  std::vector<Collider> colliders(6);
  colliders[0].shape = Sphere{{0, 0, 0}, 0.3};
  colliders[1].shape = Plane{{0, -1, 0}, Vec3::UnitY()};
  colliders[2].shape = Capsule{{-1, 0, 0}, {1, 0.5, 0}, 0.2};
  colliders[3].shape = OrientedBox{{1, 1, 1}, {0.5, 0.1, 0.3}};
  colliders[4].shape = Plane{{0, -1, 0}, Vec3::UnitY()};
  colliders[5].shape = Sphere{{2, 0, 0}, 0.5};
  for (const int c : {2, 3, 4}) colliders[c].motion = turning;
  colliders[5].motion = sliding;
  return colliders;
}

std::vector<MovingShape> shapes_at(const std::vector<Collider>& colliders, double time) {
  std::vector<MovingShape> shapes;
  for (const Collider& c : colliders) {
    shapes.push_back({&c, shape_at(c, time), shape_at(c, time + kStep), c.motion.at(time),
                      c.motion.at(time + kStep), pivot(c.shape)});
  }
  return shapes;
}

TEST(ShapeClearance, LeavesOutNoPointThatComesNear) {
  Random random(5);
  const std::vector<Collider> colliders = make_colliders();
  ShapeClearance clearance;
  SurfaceMotion motion;
  for (int v = 0; v < kPoints; ++v) motion.start.push_back(test::random_vector(random, 3));
  std::vector<Vec3> before = motion.start;
  double time = 0;
  int num_near = 0, num_looked_at = 0, num_all = 0;
  std::vector<int> near;
  for (int step = 0; step < 400; ++step) {
    const bool jumps = step % 50 == 49;  // to another state, like a restart
    if (jumps) {
      time = random.uniform(0, 9);
      for (Vec3& p : motion.start) p = test::random_vector(random, 3);
    }
    const double speed = step % 3 == 0 ? 0.0 : 0.02;
    motion.end = motion.start;
    for (Vec3& p : motion.end) p += test::random_vector(random, speed);
    double travel_sq = 0;
    for (int v = 0; v < kPoints; ++v) travel_sq = farther_sq(travel_sq, motion.start[v] - before[v]);
    before = motion.start;
    const std::vector<MovingShape> shapes = shapes_at(colliders, time);
    clearance.begin_step(shapes, kPoints, std::sqrt(travel_sq));
    for (int s = 0; s < static_cast<int>(shapes.size()); ++s) {
      const double reach = random.uniform(0, 0.2);
      clearance.find_near(s, farthest_way(motion, kPoints), reach, near);
      ASSERT_TRUE(std::is_sorted(near.begin(), near.end()));
      for (int v = 0; v < kPoints; ++v) {
        const double at_start = signed_distance(shapes[s].before, motion.start[v]).distance,
                     at_end = signed_distance(shapes[s].after, motion.end[v]).distance;
        const bool is_looked_at = std::binary_search(near.begin(), near.end(), v);
        num_looked_at += is_looked_at;
        ++num_all;
        if (std::min(at_start, at_end) > reach) continue;
        ++num_near;
        ASSERT_TRUE(is_looked_at) << "step " << step << ", shape " << s;
      }
      for (const int v : near) {
        clearance.set(s, v, signed_distance(shapes[s].after, motion.end[v]).distance,
                      (motion.end[v] - motion.start[v]).norm());
      }
    }
    motion.start = motion.end;
    time += random.uniform(0, kStep / 10);
  }
  EXPECT_GT(num_near, 1000);
  EXPECT_LT(num_looked_at, num_all / 2) << "most need not be measured";
}

/// A failed step has no effect on later ones.
TEST(ShapeClearance, MeasuresAgainWhatWasNoNumber) {
  const std::vector<Collider> colliders = make_colliders();
  const std::vector<MovingShape> shapes = shapes_at(colliders, 0);
  ShapeClearance clearance;
  std::vector<int> near;
  clearance.begin_step(shapes, 1, 0);
  clearance.set(0, 0, std::numeric_limits<double>::quiet_NaN(), 0);
  clearance.find_near(0, 0, 0, near);
  EXPECT_EQ(near.size(), 1u);
  clearance.set(0, 0, 5, 0);
  clearance.find_near(0, 0, 0, near);
  EXPECT_TRUE(near.empty());
  clearance.find_near(0, std::numeric_limits<double>::quiet_NaN(), 0, near);
  EXPECT_EQ(near.size(), 1u);
  clearance.begin_step(shapes, 1, std::numeric_limits<double>::quiet_NaN());
  clearance.find_near(0, 0, 0, near);
  EXPECT_EQ(near.size(), 1u);
}

}  // namespace
}  // namespace weft::engine
