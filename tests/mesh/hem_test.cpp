#include "weft/mesh/hem.h"

#include <gtest/gtest.h>

#include "weft/mesh/grid.h"
#include "weft/mesh/vertex_normals.h"

namespace weft::engine {
namespace {

TEST(Hem, IsATubeOfTheRadiusAroundEveryBorderEdge) {
  const TriangleMesh grid =
      build_grid_mesh({.size_x = 1, .size_z = 1, .cells_x = 4, .cells_z = 3}, GridDiagonals::alternating);
  std::vector<float> positions;
  for (const Vec3& p : grid.positions) {
    for (const double c : p) positions.push_back(static_cast<float>(c));
  }
  const Hem hem(grid.triangles, grid.num_vertices());
  ASSERT_EQ(hem.centers().size(), 14u);
  EXPECT_EQ(hem.triangles().size(), 14u * 2 * Hem::kSides);
  const std::vector<float> normals = compute_vertex_normals(grid.triangles, positions);
  const std::vector<float> placed = hem.place(positions, normals, 0.01);
  const auto vertex = [&](int v) { return Vec3(placed[3 * v], placed[3 * v + 1], placed[3 * v + 2]); };
  for (int v = 0; v < static_cast<int>(placed.size()) / 3; ++v)
    EXPECT_NEAR((vertex(v) - grid.positions[hem.centers()[v / Hem::kSides]]).norm(), 0.01, 1e-6);
  // Not twisted: no side of a quad crosses the tube.
  for (const auto& [a, b, c] : hem.triangles()) {
    const double longest = std::max(
        {(vertex(a) - vertex(b)).norm(), (vertex(b) - vertex(c)).norm(), (vertex(c) - vertex(a)).norm()});
    EXPECT_LT(longest, 1.0 / 3 + 0.02);
    EXPECT_NE(a / Hem::kSides == b / Hem::kSides, b / Hem::kSides == c / Hem::kSides);
  }
}

TEST(Hem, AClosedMeshHasNone) {
  const TriangleMesh ball = make_sphere_mesh(Vec3::Zero(), 1, 8);
  EXPECT_TRUE(Hem(ball.triangles, ball.num_vertices()).triangles().empty());
}

}  // namespace
}  // namespace weft::engine
