/// Steps of the fast integrators do not allocate memory after the first ones.

#include <gtest/gtest.h>

#include <atomic>
#include <cstdlib>
#include <new>

#include "tests/support.h"

namespace {
std::atomic<long> g_allocations{0};
}

// Not inlined: g++ would otherwise see free() applied to its own operator new, and warn.
[[gnu::noinline]] void* operator new(std::size_t size) {
  ++g_allocations;
  if (void* memory = std::malloc(size ? size : 1)) return memory;
  throw std::bad_alloc();
}
// std::stable_partition uses this one; a sanitizer's version would not match the free() below.
[[gnu::noinline]] void* operator new(std::size_t size, const std::nothrow_t&) noexcept {
  ++g_allocations;
  return std::malloc(size ? size : 1);
}
[[gnu::noinline]] void operator delete(void* memory) noexcept { std::free(memory); }
[[gnu::noinline]] void operator delete(void* memory, std::size_t) noexcept { std::free(memory); }

namespace weft::engine {
namespace {

TEST(World, StepsOfTheFastIntegratorsAllocateNothing) {
  for (const char* name : {"explicit", "paper", "paper_fixed", "newton", "xpbd"}) {
    for (const auto& topology :
         {build_grid_topology(test::square(12), SpringModel::simplified), test::mesh_of(test::square(12))}) {
      World world;
      world.set_integrator({.integrator = name});
      // Contacts in the solve allocate as they come: newton is tested without.
      const bool has_ball = std::string_view(name) != "newton";
      if (has_ball) world.add_collider({"ball", Sphere{{0.5, -0.1, 0.5}, 0.1}, 0.3, {}});
      const ClothId cloth =
          world.add_cloth({.topology = topology, .material = {.structural = 20, .shear = 10}});
      world.set_pins(cloth, {{.particles = {0, 12}, .motion = RigidMotion({{.time = 0}, {.time = 1}})}});
      const Attachment hand = make_attachment(world.model(cloth), world.state(cloth), 100, {0.2, 0.3, 0.5});
      world.set_attachments(cloth, {hand});
      const auto make_steps = [&] {
        for (int s = 0; s < 100; ++s) {
          world.set_attachment_target(cloth, 0, hand.target + Vec3(0, 1e-4 * s, 0));
          world.step(1.0 / 600);
        }
      };
      // Work space grows as contacts come: repeating the same motion must not allocate.
      const World::Snapshot start = world.snapshot();
      make_steps();
      world.restore(start);
      ASSERT_TRUE(world.step(1.0 / 600).ok);
      const long before = g_allocations;
      make_steps();
      EXPECT_EQ(g_allocations - before, 0) << name;
    }
  }
}

}  // namespace
}  // namespace weft::engine
