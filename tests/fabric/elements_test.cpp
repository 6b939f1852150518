/// A fabric on a mesh: warp directions, and the elements of triangles and edges.

#include "weft/fabric/elements.h"

#include <gtest/gtest.h>

#include <cmath>

#include "weft/mesh/grid.h"

namespace weft::engine {
namespace {

const TriangleMesh kSheet =
    build_grid_mesh({.size_x = 2, .size_z = 1, .cells_x = 4, .cells_z = 2}, GridDiagonals::alternating);

std::vector<Vec2> uv_of(const TriangleMesh& mesh, const Vec3& u, const Vec3& v) {
  std::vector<Vec2> uv;
  for (const Vec3& p : mesh.positions) uv.push_back({p.dot(u) + 7, p.dot(v) - 3});
  return uv;
}

TEST(WarpField, GoesWhereUGrowsWhicheverWayUvAreTurnedOrMirrored) {
  const Vec3 u(0.6, 0, 0.8), v(-0.8, 0, 0.6);
  for (const Vec3& across : {v, Vec3(-v)}) {
    for (const Vec3& warp : warp_from_uv(kSheet, uv_of(kSheet, u, across)).warp) {
      EXPECT_LT((warp - u).norm(), 1e-12);
    }
  }
}

TEST(WarpField, FollowsThreadsWhereUvAreSkewed) {
  // u + v/2 also grows across the threads; warp is along constant v.
  for (const Vec3& warp : warp_from_uv(kSheet, uv_of(kSheet, Vec3(1, 0, 0.5), Vec3::UnitZ())).warp) {
    EXPECT_LT((warp - Vec3::UnitX()).norm(), 1e-12);
  }
}

TEST(WarpField, WithoutUvAreaIsGuessedAndCounted) {
  const WarpField field = warp_from_uv(kSheet, std::vector<Vec2>(kSheet.positions.size(), Vec2(0.5, 0.5)));
  EXPECT_EQ(field.num_guessed, kSheet.num_triangles());
  for (const Vec3& warp : field.warp) EXPECT_LT((warp - Vec3::UnitX()).norm(), 1e-12);
}

TEST(WarpField, FromADirectionLiesInEveryTriangle) {
  const TriangleMesh sphere = make_sphere_mesh(Vec3::Zero(), 1, 8);
  const WarpField field = warp_from_direction(sphere, Vec3::UnitY());
  EXPECT_EQ(field.num_guessed, 0);
  for (int t = 0; t < sphere.num_triangles(); ++t) {
    const auto& [a, b, c] = sphere.triangles[t];
    const Vec3 normal =
        (sphere.positions[b] - sphere.positions[a]).cross(sphere.positions[c] - sphere.positions[a]);
    EXPECT_NEAR(field.warp[t].norm(), 1, 1e-12);
    EXPECT_NEAR(field.warp[t].dot(normal.normalized()), 0, 1e-12);
  }
  EXPECT_EQ(warp_from_direction(kSheet, Vec3::UnitY()).num_guessed, kSheet.num_triangles());
}

TEST(Membranes, CoverTheMeshInItsOrder) {
  const std::vector<MembraneElement> membranes =
      build_membranes(kSheet, warp_from_direction(kSheet, Vec3(1, 0, 1)));
  ASSERT_EQ(static_cast<int>(membranes.size()), kSheet.num_triangles());
  double area = 0;
  for (int t = 0; t < kSheet.num_triangles(); ++t) {
    EXPECT_EQ(membranes[t].vertices, kSheet.triangles[t]);
    area += membranes[t].rest.area;
  }
  EXPECT_NEAR(area, 2, 1e-12);
}

TEST(Hinges, BendWarpAcrossEdgesAlongWeft) {
  const Fabric fabric{.bend_warp = 1, .bend_weft = 4, .bend_bias = 2};
  const WarpField warp = warp_from_direction(kSheet, Vec3::UnitX());
  int count[3] = {0, 0, 0};
  for (const HingeElement& hinge : build_hinges(kSheet, warp, fabric)) {
    const Vec3 edge = kSheet.positions[hinge.vertices[1]] - kSheet.positions[hinge.vertices[0]];
    // Both triangles have 1/8 m², edges 0.5 m: k = D |e|²/(1/4).
    const double rigidity = hinge.stiffness * 0.25 / edge.squaredNorm();
    const int kind = edge.x() == 0 ? 0 : edge.z() == 0 ? 1 : 2;
    const double expected[3] = {1, 4, 2};
    EXPECT_NEAR(rigidity, expected[kind], 1e-12);
    ++count[kind];
  }
  EXPECT_EQ(count[0], 6) << "inner edges along weft";
  EXPECT_EQ(count[1], 4) << "along warp";
  EXPECT_EQ(count[2], 8) << "diagonals";
}

}  // namespace
}  // namespace weft::engine
