#include "weft/model/springs.h"

#include <gtest/gtest.h>

#include <set>

#include "tests/support.h"

namespace weft::engine {
namespace {

int count(const std::vector<Spring>& springs, SpringKind kind) {
  int n = 0;
  for (const Spring& s : springs) n += s.kind == kind;
  return n;
}

TEST(GridSprings, AreAsManyAsTheFiguresOfThePaperShow) {
  const Grid grid{.cells_x = 5, .cells_z = 4};  // 6 × 5 particles
  for (const SpringModel model : {SpringModel::basic, SpringModel::simplified, SpringModel::alternating}) {
    const std::vector<Spring> springs = build_grid_springs(grid, model);
    EXPECT_EQ(count(springs, SpringKind::structural), 5 * 5 + 6 * 4);
    EXPECT_EQ(count(springs, SpringKind::shear), (model == SpringModel::basic ? 2 : 1) * 5 * 4);
    EXPECT_EQ(count(springs, SpringKind::bend), 4 * 5 + 6 * 3);
  }
}

TEST(GridSprings, JoinEachPairOnceAtItsRestDistance) {
  const Grid grid{.size_x = 2, .size_z = 1, .cells_x = 5, .cells_z = 4};
  const TriangleMesh mesh = build_grid_mesh(grid, GridDiagonals::parallel);
  for (const SpringModel model : {SpringModel::basic, SpringModel::simplified, SpringModel::alternating}) {
    std::set<std::pair<int, int>> pairs;
    for (const Spring& s : build_grid_springs(grid, model)) {
      EXPECT_TRUE(pairs.insert(std::minmax(s.i, s.j)).second);
      EXPECT_NEAR((mesh.positions[s.i] - mesh.positions[s.j]).norm(), s.rest_length, 1e-14);
    }
  }
}

TEST(GridSprings, SimplifiedDiagonalsAreTheEdgesOfItsTriangles) {
  const Grid grid{.cells_x = 5, .cells_z = 4};
  for (const SpringModel model : {SpringModel::simplified, SpringModel::alternating}) {
    std::set<std::pair<int, int>> edges, springs;
    for (const Edge& e : build_edges(build_grid_mesh(grid, diagonals_of(model)))) edges.insert({e.a, e.b});
    for (const Spring& s : build_grid_springs(grid, model)) {
      if (s.kind != SpringKind::bend) springs.insert(std::minmax(s.i, s.j));
    }
    EXPECT_EQ(edges, springs);
  }
}

TEST(MeshSprings, AreTheEdgesAndOneBendingSpringAcrossEachInnerEdge) {
  const TriangleMesh mesh = build_grid_mesh(test::square(3), GridDiagonals::alternating);
  int inner = 0;
  const std::vector<Edge> edges = build_edges(mesh);
  for (const Edge& e : edges) inner += e.num_triangles == 2;
  const std::vector<Spring> springs = build_mesh_springs(mesh);
  EXPECT_EQ(count(springs, SpringKind::structural), static_cast<int>(edges.size()));
  EXPECT_EQ(count(springs, SpringKind::bend), inner);
}

TEST(ClothModel, WeighsDensityTimesArea) {
  for (const auto& topology :
       {build_grid_topology(test::square(7), SpringModel::simplified), test::mesh_of(test::square(7))}) {
    const auto model = build_cloth_model(topology, {.density = 0.3});
    double mass = 0;
    for (const double m : model->mass) mass += m;
    EXPECT_NEAR(mass, 0.3, 1e-12);
  }
}

TEST(ClothModel, NewNumbersShareTheTopology) {
  const auto topology = build_grid_topology(test::square(7), SpringModel::simplified);
  const auto a = build_cloth_model(topology, {}), b = build_cloth_model(topology, {.structural = 5});
  EXPECT_EQ(a->topology, b->topology);
  EXPECT_NE(a->id, b->id);
}

TEST(ClothState, FollowsACloth) {
  ClothState state = make_state({{0, 0, 0}, {0.5, 0, 0.25}});
  for (std::size_t i = 0; i < 2; ++i) state.x.set(i, state.x.get(i) + Vec3(0, -100.25, 0));
  const Vec3 before = state.position(1);
  follow_cloth(state);
  EXPECT_EQ(state.position(1), before);
  EXPECT_LT(state.x.get(1).norm(), 1);
}

}  // namespace
}  // namespace weft::engine
