/// Cloth with another rest shape than its mesh: all that follows from a rest shape follows from that one.

#include "weft/mesh/rest_mesh.h"

#include <gtest/gtest.h>

#include <cmath>

#include "weft/core/random.h"
#include "weft/fabric/mesh_springs.h"
#include "weft/mesh/sample_meshes.h"
#include "weft/model/cloth_model.h"

namespace weft::engine {
namespace {

const Fabric kFabric = [] {
  Fabric fabric = find_fabric("denim");
  fabric.bend_hysteresis_warp = 0.002;
  fabric.bend_hysteresis_weft = 0.001;
  return fabric;
}();

/// A crooked flat mesh, and the same triangles as the rest shape of a mesh that is stretched, sheared and turned.
struct Deformed {
  RestMesh flat;
  RestMesh deformed;
  std::vector<CornerUv> uv;

  Deformed() {
    flat = build_random_mesh({.size_x = 0.4, .size_z = 0.3, .cells_x = 8, .cells_z = 6}, 3);
    Mat3 stretch;
    stretch << 1.3, 0, 0.2, 0.4, 0, -0.9, 0, 1, 0.1;
    deformed = flat;
    for (Vec3& p : deformed.positions) p = stretch * p + Vec3(1, 2, 3);
    Random random(7);
    std::vector<TriangleCorners> pieces;
    for (int t = 0; t < flat.num_triangles(); ++t) {
      const Mat3 turn = (Eigen::AngleAxisd(random.uniform(-3, 3), Vec3::UnitX()) *
                         Eigen::AngleAxisd(random.uniform(-3, 3), Vec3::UnitZ()))
                            .toRotationMatrix() *
                        Vec3(t % 2 == 0 ? 1 : -1, 1, 1).asDiagonal();
      TriangleCorners piece = flat.corners(t);
      CornerUv& corners = uv.emplace_back();
      for (int c = 0; c < 3; ++c) corners[c] = {3 * piece[c].x() + piece[c].z(), piece[c].z()};
      const Vec3 place(random.uniform(-5, 5), random.uniform(-5, 5), random.uniform(-5, 5));
      for (Vec3& p : piece) p = turn * p + place;
      pieces.push_back(piece);
    }
    EXPECT_EQ(set_rest(deformed, pieces), 0);
  }
};

void expect_same(const BendingRows& a, const BendingRows& b) {
  ASSERT_EQ(a.begin, b.begin);
  ASSERT_EQ(a.vertex, b.vertex);
  for (std::size_t k = 0; k < a.weight.size(); ++k) EXPECT_NEAR(a.weight[k], b.weight[k], 1e-6);
  for (std::size_t r = 0; r < a.stiffness.size(); ++r)
    EXPECT_NEAR(a.stiffness[r], b.stiffness[r], 1e-9 * a.stiffness[r]);
}

TEST(RestMesh, HasTheLengthsAndAreasOfTheRestShape) {
  const Deformed it;
  for (const Edge& e : build_edges(it.flat))
    EXPECT_NEAR(edge_length(it.deformed, e), (it.flat.positions[e.b] - it.flat.positions[e.a]).norm(), 1e-14);
  const std::vector<double> expected = compute_vertex_areas(it.flat),
                            found = compute_vertex_areas(it.deformed);
  for (std::size_t v = 0; v < expected.size(); ++v) EXPECT_NEAR(found[v], expected[v], 1e-16);
}

TEST(RestMesh, HasTheElementsOfTheRestShape) {
  const Deformed it;
  const auto expected = build_mesh_elements(it.flat, warp_from_uv(it.flat, it.uv), kFabric);
  const auto found = build_mesh_elements(it.deformed, warp_from_uv(it.deformed, it.uv), kFabric);
  ASSERT_EQ(found->membranes.size(), expected->membranes.size());
  for (std::size_t t = 0; t < expected->membranes.size(); ++t) {
    const RestTriangle &a = expected->membranes[t].rest, &b = found->membranes[t].rest;
    EXPECT_NEAR(b.area, a.area, 1e-12 * a.area);
    for (int c = 0; c < 3; ++c)
      EXPECT_LT((b.gradient[c] - a.gradient[c]).norm(), 1e-9 * a.gradient[c].norm());
  }
  ASSERT_EQ(found->patches.size(), expected->patches.size());
  for (std::size_t p = 0; p < expected->patches.size(); ++p)
    EXPECT_EQ(found->patches[p].vertices, expected->patches[p].vertices);
  expect_same(expected->bending, found->bending);
  ASSERT_EQ(found->thread_bends.vertex, expected->thread_bends.vertex);
  for (std::size_t r = 0; r < expected->thread_bends.friction.size(); ++r)
    EXPECT_NEAR(found->thread_bends.friction[r], expected->thread_bends.friction[r],
                1e-9 * expected->thread_bends.friction[r]);
}

TEST(RestMesh, HasTheSpringsOfTheRestShape) {
  const Deformed it;
  const std::vector<Spring> expected = build_mesh_springs(it.flat), found = build_mesh_springs(it.deformed);
  ASSERT_EQ(found.size(), expected.size());
  for (std::size_t s = 0; s < expected.size(); ++s)
    EXPECT_NEAR(found[s].rest_length, expected[s].rest_length, 1e-12);
  const MeshSprings a = make_mesh_springs(it.flat, warp_from_uv(it.flat, it.uv), kFabric, "denim"),
                    b = make_mesh_springs(it.deformed, warp_from_uv(it.deformed, it.uv), kFabric, "denim");
  for (std::size_t s = 0; s < a.stiffness.size(); ++s)
    EXPECT_NEAR(b.stiffness[s], a.stiffness[s], 1e-3 + 1e-6 * a.stiffness[s]);
}

/// Bending springs keep the angle that the mesh has between two triangles.
TEST(RestMesh, SpringsAcrossAFoldKeepItsAngle) {
  RestMesh roof;
  roof.positions = {{0, 1, 0}, {1, 1, 0}, {0.5, 0, 1}, {0.5, 0, -1}};
  roof.triangles = {{0, 1, 3}, {1, 0, 2}};
  std::vector<TriangleCorners> half;
  for (int t = 0; t < 2; ++t) {
    TriangleCorners corners = roof.corners(t);
    for (Vec3& p : corners) p *= 0.5;
    half.push_back(corners);
  }
  const double before = build_mesh_springs(roof).back().rest_length;
  set_rest(roof, half);
  EXPECT_NEAR(build_mesh_springs(roof).back().rest_length, 0.5 * before, 1e-12);
}

TEST(RestMesh, TrianglesWithoutAreaKeepTheShapeOfTheMesh) {
  const Deformed it;
  RestMesh mesh = it.flat;
  std::vector<TriangleCorners> pieces(static_cast<std::size_t>(mesh.num_triangles()));
  for (int t = 0; t < mesh.num_triangles(); ++t) pieces[t] = mesh.corners(t);
  pieces[3] = {Vec3::Zero(), Vec3::Zero(), Vec3::Zero()};
  pieces[5] = {Vec3::Zero(), Vec3::UnitX(), Vec3(0.5, 0.01, 0)};
  pieces[8][1].x() = std::nan("");
  EXPECT_EQ(set_rest(mesh, pieces), 3);
  for (int t = 0; t < mesh.num_triangles(); ++t)
    EXPECT_NEAR(triangle_area(mesh, t), triangle_area(it.flat, t), 1e-15);
}

TEST(RestMesh, ScalesAlongWarpAndWeft) {
  const Deformed it;
  RestMesh mesh = it.flat;
  const WarpField warp = warp_from_direction(mesh, Vec3(1, 0, 2));
  scale_rest(mesh, warp, std::vector<Vec2>(mesh.positions.size(), Vec2(0.5, 2)));
  const auto before = build_membranes(it.flat, warp), after = build_membranes(mesh, warp);
  for (std::size_t t = 0; t < before.size(); ++t) {
    EXPECT_NEAR(after[t].rest.area, before[t].rest.area, 1e-12 * before[t].rest.area);
    for (int c = 0; c < 3; ++c) {
      EXPECT_NEAR(after[t].rest.gradient[c].x(), 2 * before[t].rest.gradient[c].x(), 1e-9);
      EXPECT_NEAR(after[t].rest.gradient[c].y(), 0.5 * before[t].rest.gradient[c].y(), 1e-9);
    }
  }
}

}  // namespace
}  // namespace weft::engine
