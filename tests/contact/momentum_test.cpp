/// Momentum conservation of touching cloths does not move cloth without contact.

#include <gtest/gtest.h>

#include "tests/support.h"
#include "weft/world/measures.h"

namespace weft::engine {
namespace {

const ClothMaterial kSoft{.structural = 20, .shear = 10, .bend = 0.2, .damping = 5e-3};

/// Two unconnected squares next to each other, 40 cm each, a metre apart.
std::shared_ptr<const ClothTopology> make_two_squares() {
  TriangleMesh both = build_grid_mesh(test::square(6, 0.4), GridDiagonals::alternating);
  const int n = both.num_vertices();
  const std::vector<Triangle> triangles = both.triangles;
  for (int v = 0; v < n; ++v) both.positions.push_back(both.positions[v] + Vec3(1.4, 0, 0));
  for (const Triangle& t : triangles) both.triangles.push_back({t[0] + n, t[1] + n, t[2] + n});
  return build_mesh_topology(both);
}

TEST(ContactMomentum, OfAClothInPiecesLeavesTheOneThatFliesAlone) {
  World world;
  world.set_gravity(Vec3::Zero());
  const auto pieces = make_two_squares();
  const ClothId below =
      world.add_cloth({.name = "below", .topology = pieces, .material = kSoft, .velocity = Vec3(0, 1, 0)});
  const auto square = test::mesh_of(test::square(5, 0.3));
  std::vector<Vec3> above;
  for (const Vec3& p : square->mesh.positions) above.push_back(p + Vec3(0.06, 0.05, 0.05));
  world.add_cloth({.name = "above", .topology = square, .material = kSoft, .positions = above});
  for (int s = 0; s < 12; ++s) ASSERT_TRUE(world.step(1.0 / 60).ok);
  const ClothState& state = world.state(below);
  const std::size_t n = state.x.size() / 2;
  EXPECT_LT(state.v.get(0).y(), 0.95) << "the first piece has met the other cloth";
  for (std::size_t i = n; i < 2 * n; ++i)
    EXPECT_LT((state.v.get(i) - Vec3(0, 1, 0)).norm(), 1e-5) << "particle " << i;
}

TEST(ContactMomentum, OfClothThatSomethingElseHoldsIsNotTheirs) {
  // The lower sheet is pinned at its border and catches the upper one, which must come to rest on it.
  World world;
  const auto square = test::mesh_of(test::square(8, 0.4));
  const ClothId below = world.add_cloth({.name = "below", .topology = square, .material = kSoft});
  std::vector<int> border;
  for (int i = 0; i < square->num_particles(); ++i) {
    const Vec3& p = square->mesh.positions[i];
    if (std::min({p.x(), 0.4 - p.x(), p.z(), 0.4 - p.z()}) < 1e-6) border.push_back(i);
  }
  world.set_pins(below, {{.particles = border}});
  std::vector<Vec3> places;
  const auto small = test::mesh_of(test::square(6, 0.2));
  for (const Vec3& p : small->mesh.positions) places.push_back(p + Vec3(0.1, 0.03, 0.1));
  const ClothId above =
      world.add_cloth({.name = "above", .topology = small, .material = kSoft, .positions = places});
  for (int s = 0; s < 180; ++s) ASSERT_TRUE(world.step(1.0 / 60).ok);
  EXPECT_LT(compute_momentum(world.model(above), world.state(above)).norm(), 2e-3);
}

}  // namespace
}  // namespace weft::engine
