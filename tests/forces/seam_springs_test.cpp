/// Seams: force and Hessian are derivatives of the energy; the time in which they close.

#include "weft/forces/seam_springs.h"

#include <gtest/gtest.h>

#include "tests/support.h"
#include "weft/fabric/elements.h"
#include "weft/forces/terms.h"
#include "weft/model/seams.h"

namespace weft::engine {
namespace {

TEST(SeamSprings, ForceAndHessianAreDerivatives) {
  Random random(3);
  const SeamSpring spring{.particles = {0, 1, 2}, .share = 0.3, .start = 0.4, .stiffness = 700};
  for (int trial = 0; trial < 50; ++trial) {
    const Vec3 gap = test::random_vector(random, 0.5);
    const double closed = 0.01, opening = 0.5, h = 1e-6;
    const SeamPull pull = seam_pull(spring, closed, opening, gap);
    Vec3 force;
    Mat3 hessian;
    for (int c = 0; c < 3; ++c) {
      const SeamPull more = seam_pull(spring, closed, opening, gap + h * Vec3::Unit(c)),
                     less = seam_pull(spring, closed, opening, gap - h * Vec3::Unit(c));
      force[c] = -(more.energy - less.energy) / (2 * h);
      hessian.col(c) = -(more.force - less.force) / (2 * h);
    }
    EXPECT_LT((force - pull.force).norm(), 1e-5);
    EXPECT_LT((hessian - pull.hessian()).norm(), 1e-3);
  }
  EXPECT_EQ(seam_pull(spring, 0.01, 0, {0.005, 0, 0}).along, 0) << "closed seams do not push";
}

std::shared_ptr<const ClothModel> two_points(double time) {
  auto topology =
      std::make_shared<ClothTopology>(*test::chain({{0, 0, 0}, {0.3, 0, 0}, {0.3, 0.1, 0}}, 1, 1));
  topology->seams = {{{.particles = {0, 1, 2}, .share = 0, .start = 0.3, .stiffness = 1}}, time};
  return build_cloth_model(topology, {.thickness = 0.01});
}

TEST(SeamSprings, CloseSmoothlyInTheirTime) {
  const auto model = two_points(2);
  ClothState state = make_state(model->topology->mesh.positions);
  EXPECT_NEAR(make_seam_term(*model, state)->energy(to_doubles(state.x)), 0, 1e-12) << "slack at the start";
  advance_seams(*model, 0.5, state);
  EXPECT_DOUBLE_EQ(seam_opening(*model, state), 1 - 5.0 / 32);
  const double closed = closed_seam(*model), rest = closed + (1 - 5.0 / 32) * (0.3 - closed);
  EXPECT_NEAR(make_seam_term(*model, state)->energy(to_doubles(state.x)), 0.5 * (0.3 - rest) * (0.3 - rest),
              1e-8);
  EXPECT_FALSE(find_open_seam(*model, state));
  advance_seams(*model, 3, state);
  EXPECT_EQ(seam_opening(*model, state), 0);
  EXPECT_FALSE(are_seams_closing(*model, state));
  EXPECT_NEAR(find_open_seam(*model, state)->width, 0.3 - closed, 1e-7);
  const auto at_once = two_points(0);
  EXPECT_EQ(seam_opening(*at_once, make_state(at_once->topology->mesh.positions)), 0);
}

/// Work of a step: the pull at its end times the shortening.
TEST(SeamSprings, WorkIsThatOfTheShortening) {
  const auto model = two_points(1);
  ClothState before = make_state(model->topology->mesh.positions), after = before;
  advance_seams(*model, 0.25, after);
  const double shortening = 5.0 / 32 * (0.3 - closed_seam(*model));
  EXPECT_NEAR(seam_work(*model, before, after), shortening * shortening, 1e-8);
}

/// A border of 4 edges on one of 5: as stiff as their mean length says, each point at its share.
TEST(SeamSprings, JoinPointsAtEqualSharesOfBothBorders) {
  TriangleMesh mesh;
  std::vector<int> a, b;
  for (int k = 0; k <= 4; ++k) {
    a.push_back(mesh.num_vertices());
    mesh.positions.emplace_back(0.25 * k, 0, 0);
  }
  for (int k = 0; k <= 5; ++k) {
    b.push_back(mesh.num_vertices());
    mesh.positions.emplace_back(0.22 * k, 0, 0.1);
  }
  double stiffness = 0;
  for (const SeamSpring& spring : make_seam_springs(mesh, a, b, 1000)) {
    stiffness += spring.stiffness;
    const auto weights = spring.weights();
    const Vec3 other =
        -weights[1] * mesh.positions[spring.particles[1]] - weights[2] * mesh.positions[spring.particles[2]];
    const Vec3& own = mesh.positions[spring.particles[0]];
    EXPECT_NEAR(own.x() / (own.z() == 0 ? 1 : 1.1), other.x() / (own.z() == 0 ? 1.1 : 1), 1e-12);
    EXPECT_NEAR(spring.start, (own - other).norm(), 1e-12);
  }
  EXPECT_NEAR(stiffness, 1000 * 1.05, 1e-9);
}

/// A dart: its two sides meet at a vertex, which needs no spring.
TEST(SeamSprings, OfADartLeaveItsTipAlone) {
  const TriangleMesh mesh{{{0, 0, 0}, {1, 0, 0.1}, {1, 0, -0.1}}, {}};
  const std::vector<SeamSpring> springs = make_seam_springs(mesh, std::vector{0, 1}, std::vector{0, 2}, 1);
  ASSERT_EQ(springs.size(), 2u);
  EXPECT_EQ(springs[0].particles[0], 1);
  EXPECT_EQ(springs[1].particles[0], 2);
}

TEST(SeamSprings, AreAsStiffAsTheirLengthAtRest) {
  RestMesh mesh =
      build_grid_mesh({.size_x = 1, .size_z = 1, .cells_x = 4, .cells_z = 4}, GridDiagonals::alternating);
  const std::vector<std::array<int, 2>> pairs = {
      {5, 9}, {0, 12}, {7, 7}};  // borders, a corner and the middle; none
  const std::array<int, 3> a = {0, 5, 10}, b = {4, 9, 14};
  const auto stitches = make_stitches(mesh, pairs, 1000.0, 0), seam = make_seam_springs(mesh, a, b, 1000);
  ASSERT_EQ(stitches.size(), 2u);
  EXPECT_NEAR(stitches[0].stiffness, 250, 1e-9);  // an edge of border at both ends
  EXPECT_NEAR(make_stitches(mesh, pairs, {}, 50)[0].stiffness * 2,
              50 * 2 * stitches[0].stiffness * 2 / (stitches[0].stiffness + stitches[1].stiffness), 1e-9)
      << "the mean stitch has the stiffness of an edge";
  const double mean = mean_edge(mesh, a, b);
  scale_rest(mesh, warp_from_direction(mesh, Vec3::UnitX()), std::vector<Vec2>(25, Vec2(0.5, 0.5)));
  EXPECT_NEAR(mean_edge(mesh, a, b), 0.5 * mean, 1e-12);
  EXPECT_NEAR(make_stitches(mesh, pairs, 1000.0, 0)[0].stiffness, 125, 1e-9);
  EXPECT_NEAR(make_seam_springs(mesh, a, b, 1000)[1].stiffness, 0.5 * seam[1].stiffness, 1e-9);
  EXPECT_EQ(make_seam_springs(mesh, a, b, 1000)[1].start, seam[1].start)
      << "the way they draw is that of the mesh";
}

}  // namespace
}  // namespace weft::engine
