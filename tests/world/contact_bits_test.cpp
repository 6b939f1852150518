/// Bit-identical results with contact, including self contact, for any number of threads and SIMD width.

#include <gtest/gtest.h>

#include "tests/support.h"
#include "weft/core/simd.h"

namespace weft::engine {
namespace {

/// A sheet that slips off a ball, folds on itself and lands on a floor.
std::uint64_t fall_in_a_heap(const char* integrator, int threads) {
  World world;
  world.set_jobs(make_jobs(threads));
  world.set_integrator({.integrator = integrator});
  world.add_collider({.name = "floor", .shape = Plane{}, .motion = {}});
  world.add_collider(
      {.name = "ball", .shape = Sphere{{0.4, 0.2, 0.5}, 0.12}, .friction = 0.1, .motion = {}});
  const auto topology = build_grid_topology(test::square(24), SpringModel::alternating);
  std::vector<Vec3> positions = topology->mesh.positions;
  for (Vec3& p : positions) p.y() += 0.42;
  world.add_cloth(
      {.topology = topology,
       .material = {.structural = 300, .shear = 150, .bend = 1, .damping = 1e-3, .thickness = 5e-3},
       .positions = positions});
  world.track_contacts(true);
  bool touches_itself = false;
  for (int step = 0; step < 45; ++step) {
    EXPECT_TRUE(world.step(1.0 / 60).ok);
    for (const ContactPoint& point : world.contact_points()) touches_itself |= point.other_cloth == 0;
  }
  EXPECT_TRUE(touches_itself);
  return world.state_hash();
}

TEST(ContactBits, AreTheSameForAnyNumberOfThreadsAndEveryVectorWidth) {
  for (const char* integrator : {"newton", "xpbd"}) {
    const std::uint64_t expected = fall_in_a_heap(integrator, 1);
    for (const SimdLevel level : {SimdLevel::baseline, SimdLevel::avx2, SimdLevel::avx512}) {
      if (level > best_simd_level()) continue;
      limit_simd_level(level);
      for (const int threads : {1, 2})
        EXPECT_EQ(fall_in_a_heap(integrator, threads), expected)
            << integrator << ", " << to_string(level) << ", " << threads;
    }
    limit_simd_level(best_simd_level());
  }
}

}  // namespace
}  // namespace weft::engine
