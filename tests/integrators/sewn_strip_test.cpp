/// A seam between non-matching borders carries load like continuous cloth.

#include <gtest/gtest.h>

#include "tests/integrators/fabric_sheets.h"
#include "tests/support.h"
#include "weft/mesh/sew.h"

namespace weft::engine {
namespace {

constexpr double kLength = 0.4, kWidth = 0.1;  // of the strip, its length along x [m]

/// A part of the strip that begins at x, with the given number of rows across.
TriangleMesh part(double x, double length, int rows) {
  TriangleMesh mesh = build_grid_mesh({.size_x = length, .size_z = kWidth, .cells_x = 10, .cells_z = rows},
                                      GridDiagonals::alternating);
  for (Vec3& p : mesh.positions) p.x() += x;
  return mesh;
}

TriangleMesh join(TriangleMesh mesh, const TriangleMesh& other) {
  const int first = mesh.num_vertices();
  mesh.positions.insert(mesh.positions.end(), other.positions.begin(), other.positions.end());
  for (const auto& [a, b, c] : other.triangles) mesh.triangles.push_back({a + first, b + first, c + first});
  return mesh;
}

/// Extension of the strip, held at x = 0, under its weight along x.
double extension(const TriangleMesh& mesh) {
  const Fabric fabric = {.density = 0.2,
                         .c11 = 100,
                         .c22 = 80,
                         .c12 = 15,
                         .g = 20,
                         .bend_warp = 1e-6,
                         .bend_weft = 1e-6,
                         .bend_bias = 1e-6,
                         .damping = 0.1,
                         .strain_limit = 0,
                         .stretch_warp = {},
                         .stretch_weft = {}};
  const auto topology = build_mesh_topology(mesh);
  const auto model =
      build_cloth_model(topology, {.density = fabric.density, .structural = 0, .shear = 0, .bend = 0},
                        build_mesh_elements(mesh, warp_from_direction(mesh, Vec3::UnitX()), fabric));
  std::vector<int> held;
  for (int v = 0; v < mesh.num_vertices(); ++v) {
    if (mesh.positions[v].x() < 1e-9) held.push_back(v);
  }
  Environment environment = test::hung_by(*model, held);
  environment.gravity = {150, 0, 0};
  ClothState state = make_state(mesh.positions);
  test::advance(*test::integrator("newton"), *model, environment, 1.0 / 60, 600, state);
  double sum = 0;
  int count = 0;
  for (int v = 0; v < mesh.num_vertices(); ++v) {
    if (mesh.positions[v].x() < kLength - 1e-9) continue;
    sum += state.position(v).x() - kLength;
    ++count;
  }
  return sum / count;
}

TEST(SewnStrip, StretchesAsOneThatWasNeverCut) {
  const double gap = 0.0015;
  const TriangleMesh cut = join(part(0, 0.2, 5), part(0.2 + gap, 0.2 - gap, 7));
  const SewnMesh sewn = sew_borders(cut, 0.002);
  ASSERT_EQ(sewn.num_seams, 1);
  const TriangleMesh whole = build_grid_mesh(
      {.size_x = kLength, .size_z = kWidth, .cells_x = 20, .cells_z = 5}, GridDiagonals::alternating);
  const double expected = extension(whole);
  EXPECT_GT(expected, 0.01);
  EXPECT_NEAR(extension(sewn.mesh), expected, 0.02 * expected) << "another mesh of the same strip";
}

}  // namespace
}  // namespace weft::engine
