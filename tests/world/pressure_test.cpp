/// Gas in closed cloth that moves: a sphere's tension, the mylar balloon's shape, integrators against each other,
/// Boyle's law between plates, mistakes.

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <utility>

#include "tests/message_of.h"
#include "tests/same_continuation.h"
#include "weft/face/convert.h"
#include "weft/mesh/sample_meshes.h"
#include "weft/weft.h"

namespace weft {
namespace {

constexpr double kStep = 1.0 / 60;

/// Equally stiff in every direction: of equal strains E along all, the tension is (c11 + c12) E.
Fabric film(double c) {
  return {.density = 0.1,
          .c11 = c,
          .c22 = c,
          .c12 = 0.3 * c,
          .g = 0.35 * c,
          .bend_warp = 1e-7,
          .bend_weft = 1e-7,
          .bend_bias = 1e-7,
          .damping = 0.01};
}

TriangleMesh geodesic(double radius, int divisions) {
  return engine::from_engine(engine::build_geodesic_mesh(radius, divisions), {});
}

double area_of(const World& world, ClothId cloth) {
  double sum = 0;
  const std::vector<Vec3> x = world.positions(cloth);
  for (const auto& [a, b, c] : world.triangles(cloth)) sum += 0.5 * length(cross(x[b] - x[a], x[c] - x[a]));
  return sum;
}

World without_gravity() {
  World world;
  world.set_gravity({0, 0, 0});
  return world;
}

void settle(World& world, int steps) {
  for (int s = 0; s < steps; ++s) ASSERT_TRUE(world.step(kStep).ok);
}

/// p = 2 T / r, with T = (c11 + c12) (λ² − 1)/2 for the stretch λ. On the mesh, r = 3 V / A.
TEST(Pressure, ASphereHasTheTensionOfYoungAndLaplace) {
  for (const double pressure : {200.0, 1000.0, 4000.0}) {
    World world = without_gravity();
    const double c = 5000;
    const ClothId ball =
        world.add_cloth({.shape = geodesic(0.2, 3), .fabric = film(c), .warp = Vec3{1, 0, 0}});
    const double rest = area_of(world, ball);
    world.set_pressure(ball, pressure);
    settle(world, 120);
    const double area = area_of(world, ball), tension = 1.3 * c * 0.5 * (area / rest - 1);
    EXPECT_NEAR(pressure, 2 * tension * area / (3 * world.volume(ball)), 0.01 * pressure);
    EXPECT_EQ(world.pressure(ball), pressure);
  }
}

/// Two discs of radius a, joined and inflated: radius and thickness over those of the mylar balloon (W. Paulsen, What
/// is the shape of a mylar balloon?, 1994), which follow from a = ∫ r²/√(r⁴ − x⁴) dx and τ = 2 ∫ x²/√(r⁴ − x⁴) dx,
/// from 0 to r.
std::array<double, 2> inflate_discs(int num_rings) {
  const double a = 0.3, r = a / 1.3110287771, thickness = 2 * 0.5990701173 * r;
  const engine::TriangleMesh disc = engine::build_disc_mesh(a, num_rings);
  const int count = disc.num_vertices(), rim = count - 6 * num_rings;  // the first vertex of the last ring
  TriangleMesh both{.positions = engine::from_engine(disc.positions)};
  for (int v = 0; v < rim; ++v) {
    both.positions.push_back({both.positions[v].x, -1e-3, both.positions[v].z});
    both.positions[v].y = 1e-3;
  }
  for (const auto& [i, j, k] : disc.triangles) {
    const auto below = [&](int v) { return v < rim ? count + v : v; };
    both.triangles.push_back({i, j, k});
    both.triangles.push_back({below(i), below(k), below(j)});
  }
  World world = without_gravity();
  const ClothId balloon = world.add_cloth({.shape = both, .fabric = film(3000), .warp = Vec3{1, 0, 0}});
  world.set_pressure(balloon, 20);
  settle(world, 40);
  const std::vector<Vec3> x = world.positions(balloon);
  double radius = 0;
  for (int v = rim; v < count; ++v) radius += std::hypot(x[v].x, x[v].z) / (count - rim);
  return {radius / r, (x[0].y - x[count].y) / thickness};
}

/// The rim's wrinkles are as fine as its edges allow: the shape is that of the film in the limit.
TEST(Pressure, TwoDiscsApproachTheMylarBalloon) {
  const auto [coarse_radius, coarse_thickness] = inflate_discs(8);
  const auto [radius, thickness] = inflate_discs(16);
  EXPECT_GT(radius, 1);
  EXPECT_LT(radius - 1, 0.8 * (coarse_radius - 1));
  EXPECT_LT(thickness, 1);
  EXPECT_LT(1 - thickness, 0.7 * (1 - coarse_thickness));
}

TEST(Pressure, NewtonAndImplicitEulerInflateAlike) {
  for (const bool is_sealed : {false, true}) {
    std::vector<double> volumes, radii;
    for (const char* integrator : {"newton", "implicit_euler"}) {
      World world = without_gravity();
      world.set_integrator({.integrator = integrator});
      const ClothId ball =
          world.add_cloth({.shape = geodesic(0.2, 2), .fabric = film(2000), .warp = Vec3{1, 0, 0}});
      world.set_pressure(ball, 500, is_sealed);
      settle(world, 120);
      volumes.push_back(world.volume(ball));
      radii.push_back(length(world.positions(ball)[0]));
    }
    EXPECT_NEAR(volumes[0], volumes[1], 1e-4 * volumes[1]) << is_sealed;
    EXPECT_NEAR(radii[0], radii[1], 1e-3 * radii[1]) << is_sealed;
  }
}

/// The error of `xpbd` in equilibrium is about h²k/m and h τ k/m: it falls with the substeps.
TEST(Pressure, XpbdInflatesAlikeWithSubstepsEnough) {
  Fabric fabric = film(2000);
  fabric.damping = 1e-4;
  const auto inflate = [&](const IntegratorSettings& settings, bool is_sealed) {
    World world = without_gravity();
    world.set_integrator(settings);
    const ClothId ball =
        world.add_cloth({.shape = geodesic(0.2, 1), .fabric = fabric, .warp = Vec3{1, 0, 0}});
    const double rest = world.volume(ball);
    world.set_pressure(ball, 500, is_sealed);
    settle(world, 60);
    return world.volume(ball) / rest - 1;
  };
  for (const bool is_sealed : {false, true}) {
    const double expected = inflate({.integrator = "newton"}, is_sealed);
    const double few = inflate({.integrator = "xpbd", .xpbd = {.substeps = 100}}, is_sealed);
    const double many = inflate({.integrator = "xpbd", .xpbd = {.substeps = 400}}, is_sealed);
    EXPECT_NEAR(many, expected, 0.05 * expected) << is_sealed;
    EXPECT_LT(std::abs(many - expected), 0.5 * std::abs(few - expected)) << is_sealed;
  }
}

TEST(Pressure, OfXpbdChangesDuringARunAndGoesOnAfterASnapshot) {
  World world = without_gravity();
  world.set_integrator({.integrator = "xpbd"});
  const ClothId ball =
      world.add_cloth({.shape = geodesic(0.2, 2), .fabric = film(2000), .warp = Vec3{1, 0, 0}});
  world.add_pin(ball, {.particles = {0}});
  const Vec3 pinned = world.positions(ball)[0];
  double before = world.volume(ball);
  for (const double pressure : {20.0, 60.0}) {
    world.set_pressure(ball, pressure);
    settle(world, 10);
    EXPECT_GT(world.volume(ball), 1.001 * before);
    before = world.volume(ball);
  }
  EXPECT_LT(length(world.positions(ball)[0] - pinned), 1e-6);
  expect_same_continuation(world, 10, kStep);
}

TEST(Pressure, DoesNotMoveClothAsAWhole) {
  World world = without_gravity();
  TriangleMesh pear = geodesic(0.2, 2);
  for (Vec3& p : pear.positions) p.y *= p.y > 0 ? 2 : 1;
  const ClothId cloth = world.add_cloth({.shape = pear, .fabric = film(500), .warp = Vec3{1, 0, 0}});
  world.set_pressure(cloth, 800, true);
  const Vec3 start = world.center_of_mass(cloth);
  settle(world, 60);
  EXPECT_LT(length(world.center_of_mass(cloth) - start), 1e-4);
}

/// A sealed ball between plates keeps p V. Its force is the energy that a way of the plate takes, over the way.
TEST(Pressure, SealedGasResistsPlates) {
  World world = without_gravity();
  world.set_contact({.tracks_points = true});
  const ClothId ball =
      world.add_cloth({.shape = geodesic(0.2, 3), .fabric = film(20000), .warp = Vec3{1, 0, 0}});
  world.set_pressure(ball, 3000, true);
  const double product = (3000 + 101325) * world.volume(ball);
  world.add_collider({.name = "floor", .shape = Plane{.point = {0, -0.202, 0}, .normal = {0, 1, 0}}});
  const ColliderId plate = world.add_collider(
      {.name = "plate", .shape = OrientedBox{.center = {0, 0.302, 0}, .half_size = {0.4, 0.1, 0.4}}});
  const auto press = [&](double from, double to) {
    for (int s = 1; s <= 60; ++s) {
      world.move_collider(plate, {.translation = {0, from + (to - from) * s / 60, 0}});
      ASSERT_TRUE(world.step(kStep).ok);
    }
    settle(world, 60);
  };
  const auto force = [&] {
    double sum = 0;
    for (const ContactPoint& contact : world.contact_points()) {
      if (contact.collider == plate) sum -= contact.force.y;
    }
    return sum;
  };
  press(0, -0.1);
  const double energy = world.energies().total(), force_before = force();
  press(-0.1, -0.11);
  EXPECT_GT(world.pressure(ball), 3300);
  EXPECT_NEAR((world.pressure(ball) + 101325) * world.volume(ball), product, 1e-6 * product);
  const double mean = 0.5 * (force_before + force());
  EXPECT_NEAR(mean, (world.energies().total() - energy) / 0.01, 0.05 * mean);
}

TEST(Pressure, ActsOutwardsAlsoOnClothThatFacesInwards) {
  TriangleMesh inside_out = geodesic(0.2, 2);
  for (Triangle& t : inside_out.triangles) std::swap(t[1], t[2]);
  World world = without_gravity();
  const ClothId ball = world.add_cloth({.shape = inside_out, .fabric = film(2000), .warp = Vec3{1, 0, 0}});
  const double before = world.volume(ball);
  world.set_pressure(ball, 1000);
  settle(world, 60);
  EXPECT_GT(world.volume(ball), 1.01 * before);
}

TEST(Pressure, IsPartOfSnapshotsAndOfSavedWorlds) {
  World world = without_gravity();
  const ClothId ball =
      world.add_cloth({.shape = geodesic(0.2, 2), .fabric = film(2000), .warp = Vec3{1, 0, 0}});
  world.set_pressure(ball, 1000, true);
  settle(world, 3);
  expect_same_continuation(world, 5, kStep, [&] {
    world.set_pressure(ball, 0);
    EXPECT_EQ(world.pressure(ball), 0);
  });
  world.set_fabric(ball, film(1000));
  EXPECT_NE(world.pressure(ball), 0) << "another fabric keeps the gas";
}

TEST(Pressure, MistakesAreRefused) {
  World world;
  const ClothId sheet = world.add_cloth({.shape = Grid{1, 1, 4, 4}, .fabric = film(2000)});
  const ClothId ball =
      world.add_cloth({.shape = geodesic(0.2, 1), .fabric = film(2000), .warp = Vec3{1, 0, 0}});
  TriangleMesh flat{.positions = {{0, 0, 0}, {1, 0, 0}, {0, 0, 1}, {0.3, 0, 0.3}},
                    .triangles = {{0, 1, 2}, {0, 3, 1}, {1, 3, 2}, {2, 3, 0}}};
  const ClothId bag = world.add_cloth({.shape = flat, .fabric = film(2000), .warp = Vec3{1, 0, 0}});
  const std::string open =
      "cloth \"cloth\" is not closed: pressure requires a surface without a border, but 16 of its edges have "
      "one "
      "triangle, and 0 others join triangles that face opposite ways; join pieces with sew or weld";
  EXPECT_EQ(message_of([&] { world.set_pressure(sheet, 100); }), open);
  EXPECT_EQ(message_of([&] { world.volume(sheet); }), open);
  EXPECT_EQ(message_of([&] { world.set_pressure(ball, NAN); }),
            "cloth \"cloth 2\": its pressure must be finite");
  const std::string sealed =
      "cloth \"cloth 2\": sealed gas requires a volume, and a pressure above -101325 Pa";
  EXPECT_EQ(message_of([&] { world.set_pressure(ball, -101325, true); }), sealed);
  EXPECT_THROW(world.set_pressure(bag, 10, true), InputError);
  world.set_pressure(sheet, 0);
  World of_springs;
  const ClothId sprung = of_springs.add_cloth({.shape = geodesic(0.2, 1), .fabric = Springs{}});
  of_springs.set_pressure(sprung, 100);
  const std::string refusal =
      "cloth \"cloth\" has a pressure, but paper does not support it; use newton, implicit_euler or xpbd";
  EXPECT_EQ(message_of([&] { of_springs.set_integrator({.integrator = "paper"}); }), refusal);
  of_springs.set_pressure(sprung, 0);
  of_springs.set_integrator({.integrator = "paper"});
  EXPECT_EQ(message_of([&] { of_springs.set_pressure(sprung, 100); }), refusal);
}

}  // namespace
}  // namespace weft
