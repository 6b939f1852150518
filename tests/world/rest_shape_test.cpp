/// Rest shapes of cloth in a world: tension, size at rest, patterns, mistakes.

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>
#include <string>

#include "tests/message_of.h"
#include "tests/same_continuation.h"
#include "weft/weft.h"

namespace weft {
namespace {

constexpr double kStep = 1.0 / 60;

std::vector<int> all_of(const Grid& grid) {
  std::vector<int> vertices(static_cast<std::size_t>(grid.num_particles()));
  std::iota(vertices.begin(), vertices.end(), 0);
  return vertices;
}

/// No stiffness across, so that a strip's tension is that of its warp.
Fabric plain() {
  return {.density = 0.2, .c11 = 200, .c22 = 150, .c12 = 0, .g = 40, .damping = 0.02, .thickness = 1e-3};
}

/// Elastic held at its own length pulls with c11 (λ² − 1)/2 λ per width at rest, λ = 1/0.8.
TEST(RestScale, StretchedElasticPullsByItsLaw) {
  for (const std::string integrator : {"newton", "implicit_euler", "xpbd"}) {
    const Grid grid{.size_x = 0.4, .size_z = 0.1, .cells_x = 8, .cells_z = 2};
    World world;
    world.set_integrator({.integrator = integrator});
    world.set_gravity({0, 0, 0});
    const ClothId strip = world.add_cloth(
        {.shape = grid, .rest_scales = {{.vertices = all_of(grid), .warp = 0.8}}, .fabric = plain()});
    Pin left, right;
    for (int j = 0; j <= grid.cells_z; ++j) {
      left.particles.push_back(grid.index(0, j));
      right.particles.push_back(grid.index(grid.cells_x, j));
    }
    world.add_pin(strip, left);
    world.add_pin(strip, right);
    const int division = integrator == "xpbd" ? 32 : 1;
    for (int s = 0; s < 60 * division; ++s) ASSERT_TRUE(world.step(kStep / division).ok);
    const double stretch = 1 / 0.8, tension = 200 * 0.5 * (stretch * stretch - 1) * stretch * 0.1;
    double pull = 0;
    const std::vector<Vec3> forces = world.pin_forces(strip);
    const std::vector<int> pinned = world.pinned_particles(strip);
    for (std::size_t k = 0; k < pinned.size(); ++k) {
      if (pinned[k] % grid.num_columns() == 0) pull += forces[k].x;
    }
    const double error = integrator == "xpbd" ? 0.05 : 0.002;
    EXPECT_NEAR(std::abs(pull), tension, error * tension) << integrator;
  }
}

TEST(RestScale, FreeClothTakesItsRestSize) {
  const Grid grid{.size_x = 0.4, .size_z = 0.3, .cells_x = 8, .cells_z = 6};
  World world;
  world.set_gravity({0, 0, 0});
  const std::vector<int> all = all_of(grid);
  // Factors multiply: 0.8 along warp, 1.1 · 0.9 along weft.
  const ClothId cloth =
      world.add_cloth({.shape = grid, .rest_scales = {{all, 0.8, 1.1}, {all, 1, 0.9}}, .fabric = plain()});
  for (int s = 0; s < 240; ++s) ASSERT_TRUE(world.step(kStep).ok);
  const std::vector<Vec3> x = world.positions(cloth);
  EXPECT_NEAR(length(x[grid.index(8, 3)] - x[grid.index(0, 3)]), 0.8 * 0.4, 1e-4);
  EXPECT_NEAR(length(x[grid.index(4, 6)] - x[grid.index(4, 0)]), 0.99 * 0.3, 1e-4);
}

/// A third of the mesh's length: triangles that collapse keep the shape of their rest, not of the mesh.
TEST(RestScale, MuchShorterClothIsNotCrushed) {
  const Grid grid{.size_x = 0.4, .size_z = 0.3, .cells_x = 8, .cells_z = 6};
  for (const char* integrator : {"newton", "implicit_euler"}) {
    World world;
    world.set_integrator({.integrator = integrator});
    world.set_gravity({0, 0, 0});
    const ClothId cloth =
        world.add_cloth({.shape = grid, .rest_scales = {{all_of(grid), 0.33, 0.33}}, .fabric = plain()});
    for (int s = 0; s < 240; ++s) ASSERT_TRUE(world.step(kStep).ok);
    const std::vector<Vec3> x = world.positions(cloth);
    EXPECT_NEAR(length(x[grid.index(8, 3)] - x[grid.index(0, 3)]), 0.33 * 0.4, 2e-4) << integrator;
    EXPECT_NEAR(length(x[grid.index(4, 6)] - x[grid.index(4, 0)]), 0.33 * 0.3, 2e-4) << integrator;
  }
}

TEST(RestScale, ClothThatHasItKeepsAFabric) {
  const Grid grid{.cells_x = 4, .cells_z = 4};
  World world;
  const ClothId cloth =
      world.add_cloth({.shape = grid, .rest_scales = {{all_of(grid), 0.8, 1}}, .fabric = plain()});
  EXPECT_EQ(message_of([&] { world.set_fabric(cloth, Springs()); }),
            "cloth \"cloth\": rest_scales follow warp and weft, which springs do not have; give it a fabric");
  world.set_fabric(cloth, find_fabric("denim"));
  World::load(world.save());
}

/// A sleeve: a polygonal tube along x that is one piece in space, and flat with a cut in texture space.
TriangleMesh sleeve(double unit, bool is_mirrored) {
  constexpr int kAround = 12, kAlong = 6;
  constexpr double kRadius = 0.05, kLength = 0.3;
  const double side = 2 * kRadius * std::sin(std::acos(-1.0) / kAround);
  TriangleMesh mesh;
  for (int i = 0; i <= kAlong; ++i) {
    for (int k = 0; k < kAround; ++k) {
      const double angle = 2 * std::acos(-1.0) * k / kAround;
      mesh.positions.push_back({kLength * i / kAlong, kRadius * std::cos(angle), kRadius * std::sin(angle)});
    }
  }
  const auto add = [&](std::array<int, 2> a, std::array<int, 2> b, std::array<int, 2> c) {
    Triangle& triangle = mesh.triangles.emplace_back();
    CornerUv& uv = mesh.uv.emplace_back();
    int corner = 0;
    for (const auto& [i, k] : {a, b, c}) {
      triangle[corner] = i * kAround + k % kAround;
      uv[corner++] = {kLength * i / kAlong / unit, (is_mirrored ? -1 : 1) * side * k / unit};
    }
  };
  for (int i = 0; i < kAlong; ++i) {
    for (int k = 0; k < kAround; ++k) {
      add({i, k}, {i + 1, k}, {i + 1, k + 1});
      add({i, k}, {i + 1, k + 1}, {i, k + 1});
    }
  }
  return mesh;
}

double largest_move(const World& world, ClothId cloth, const TriangleMesh& mesh) {
  double largest = 0;
  for (std::size_t v = 0; v < mesh.positions.size(); ++v)
    largest = std::max(largest, length(world.positions(cloth)[v] - mesh.positions[v]));
  return largest;
}

TEST(RestFromUv, APatternOfTheMeshLeavesItAtRest) {
  for (const bool is_mirrored : {false, true}) {
    const TriangleMesh mesh = sleeve(0.37, is_mirrored);
    for (const std::optional<double> scale : {std::optional<double>(), std::optional<double>(0.37)}) {
      Fabric fabric = plain();
      fabric.bend_warp = fabric.bend_weft = fabric.bend_bias = 0;
      World world;
      world.set_gravity({0, 0, 0});
      const ClothId cloth =
          world.add_cloth({.shape = mesh, .rest = rest_from_uv(mesh, scale), .fabric = fabric});
      for (int s = 0; s < 30; ++s) ASSERT_TRUE(world.step(kStep).ok);
      EXPECT_LT(largest_move(world, cloth, mesh), 1e-5);
      EXPECT_TRUE(world.notes(cloth).warnings.empty());
    }
  }
}

TEST(RestFromUv, ASmallerPatternMakesASmallerSleeve) {
  const TriangleMesh mesh = sleeve(1, false);
  World world;
  world.set_gravity({0, 0, 0});
  Fabric fabric = plain();
  fabric.bend_warp = fabric.bend_weft = fabric.bend_bias = 0;
  const ClothId cloth = world.add_cloth({.shape = mesh, .rest = rest_from_uv(mesh, 0.9), .fabric = fabric});
  for (int s = 0; s < 240; ++s) ASSERT_TRUE(world.step(kStep).ok);
  const std::vector<Vec3> x = world.positions(cloth);
  EXPECT_NEAR(length(x[6 * 12] - x[0]), 0.9 * 0.3, 1e-3);
  double girth = 0;  // the tube may flatten
  for (int k = 0; k < 12; ++k) girth += length(x[36 + (k + 1) % 12] - x[36 + k]);
  EXPECT_NEAR(girth, 0.9 * 12 * 2 * 0.05 * std::sin(std::acos(-1.0) / 12), 1e-3);
}

/// Mesh cleaning moves triangles from one end of a short edge to the other; their pattern moves along.
TEST(RestFromUv, ACollapsedEdgeLeavesTheMeshAtRest) {
  TriangleMesh mesh;
  for (int j = 0; j <= 4; ++j) {
    for (int i = 0; i <= 4; ++i)
      mesh.positions.push_back({0.007 * i, 0, 0.007 * j + (i == 2 && j == 3 ? -0.0063 : 0)});
  }
  for (int j = 0; j < 4; ++j) {
    for (int i = 0; i < 4; ++i) {
      const int a = 5 * j + i;
      mesh.triangles.push_back({a, a + 5, a + 6});
      mesh.triangles.push_back({a, a + 6, a + 1});
    }
  }
  for (const auto& t : mesh.triangles) {
    CornerUv& uv = mesh.uv.emplace_back();
    for (int c = 0; c < 3; ++c) uv[c] = {mesh.positions[t[c]].x, mesh.positions[t[c]].z};
  }
  World world;
  world.set_gravity({0, 0, 0});
  const ClothId cloth = world.add_cloth({.shape = mesh, .rest = rest_from_uv(mesh, 1.0), .fabric = plain()});
  ASSERT_LT(world.num_particles(cloth), mesh.num_vertices()) << "no edge was collapsed";
  for (const TriangleStrain& strain : world.triangle_strains(cloth)) {
    EXPECT_NEAR(strain.warp, 0, 1e-4);
    EXPECT_NEAR(strain.weft, 0, 1e-4);
  }
}

TEST(RestFromUv, TextureCoordinatesThatAreNoPatternAreReported) {
  TriangleMesh mesh = sleeve(1, false);
  for (CornerUv& uv : mesh.uv) {
    for (auto& [u, v] : uv) u *= 2;
  }
  World world;
  const ClothId cloth = world.add_cloth({.shape = mesh, .rest = rest_from_uv(mesh), .fabric = plain()});
  ASSERT_EQ(world.notes(cloth).warnings.size(), 1u);
  EXPECT_NE(world.notes(cloth).warnings[0].find("is this the pattern of this mesh, and its scale right?"),
            std::string::npos)
      << world.notes(cloth).warnings[0];
}

TEST(RestFromUv, RefusesWhatHasNone) {
  TriangleMesh mesh = sleeve(1, false);
  EXPECT_EQ(message_of([&] { rest_from_uv(mesh, 0.0); }),
            "the scale of texture coordinates must be above 0 m");
  for (CornerUv& uv : mesh.uv) uv = {};
  EXPECT_EQ(message_of([&] { rest_from_uv(mesh); }), "the texture coordinates of the mesh have no area");
  mesh.uv.clear();
  EXPECT_EQ(
      message_of([&] { rest_from_uv(mesh); }),
      "a rest shape from texture coordinates requires them for each triangle; the mesh has 144 triangles, "
      "0 with texture coordinates");
}

/// Seams that are sewn by distance cut triangles; their parts are cut at rest too.
TEST(RestShape, OfSewnPiecesIsCutWithThem) {
  TriangleMesh mesh;
  for (const auto& [x0, rows] : {std::pair(0.0, 4), std::pair(0.1, 5)}) {
    const int first = mesh.num_vertices();
    for (int j = 0; j <= rows; ++j) {
      for (int i = 0; i < 2; ++i) mesh.positions.push_back({x0 + 0.1 * i, 0, 0.2 * j / rows});
    }
    for (int j = 0; j < rows; ++j) {
      const int a = first + 2 * j;
      mesh.triangles.push_back({a, a + 2, a + 3});
      mesh.triangles.push_back({a, a + 3, a + 1});
    }
  }
  std::vector<TriangleCorners> rest;
  for (const auto& [a, b, c] : mesh.triangles)
    rest.push_back({0.5 * mesh.positions[a], 0.5 * mesh.positions[b], 0.5 * mesh.positions[c]});
  World world;
  world.set_gravity({0, 0, 0});
  const ClothId cloth = world.add_cloth({.shape = mesh, .rest = rest, .fabric = plain(), .sew = 1e-4});
  EXPECT_GT(world.num_particles(cloth), mesh.num_vertices() - 8);
  double mass = 0;
  for (const double m : world.masses(cloth)) mass += m;
  EXPECT_NEAR(mass, 0.2 * 0.2 * 0.2 / 4, 1e-12);
  std::vector<int> all(mesh.positions.size());
  std::iota(all.begin(), all.end(), 0);
  const ClothId scaled =
      world.add_cloth({.shape = mesh, .rest_scales = {{all, 0.5, 0.5}}, .fabric = plain(), .sew = 1e-4});
  double scaled_mass = 0;
  for (const double m : world.masses(scaled)) scaled_mass += m;
  EXPECT_NEAR(scaled_mass, mass, 1e-12) << "also where sewing adds particles";
}

TEST(RestShape, WorldsWithItContinueTheSame) {
  const Grid grid{.size_x = 0.4, .size_z = 0.3, .cells_x = 8, .cells_z = 6};
  const TriangleMesh mesh = sleeve(1, false);
  World world;
  world.add_cloth({.shape = mesh, .rest = rest_from_uv(mesh, 0.9), .fabric = plain()});
  world.add_cloth({.shape = grid, .rest_scales = {{{0, 1, 2, 3}, 0.7, 1}}, .fabric = plain()});
  for (int s = 0; s < 5; ++s) ASSERT_TRUE(world.step(kStep).ok);
  expect_same_continuation(world, 10, kStep);
}

TEST(RestShape, RefusesMistakes) {
  const Grid grid;
  const TriangleMesh mesh = sleeve(1, false);
  const auto refusal = [](const ClothDesc& desc) { return message_of([&] { World().add_cloth(desc); }); };
  EXPECT_EQ(refusal({.shape = grid, .rest = {{}}}),
            "cloth \"cloth\": only the triangles of a mesh have another rest shape");
  EXPECT_EQ(refusal({.shape = mesh, .rest = {{}}}),
            "cloth \"cloth\": its rest shape has 1 triangles, but the mesh has 144");
  EXPECT_EQ(refusal({.shape = grid, .rest_scales = {{{0}, 0.5, 1}}, .fabric = Springs()}),
            "cloth \"cloth\": rest_scales follow warp and weft, which springs do not have; give it a fabric");
  EXPECT_EQ(refusal({.shape = grid, .rest_scales = {{{0}, 0, 1}}, .fabric = plain()}),
            "cloth \"cloth\": rest scale 0: its factors must be above 0");
  EXPECT_EQ(refusal({.shape = grid, .rest_scales = {{{5000}, 0.5, 1}}, .fabric = plain()}),
            "cloth \"cloth\": rest scale 0: vertex 5000 is not one of the shape's 1089");
}

}  // namespace
}  // namespace weft
