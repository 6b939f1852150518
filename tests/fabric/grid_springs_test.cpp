/// Springs on a grid: the fabric's stiffness recovered from their energy.

#include "weft/fabric/grid_springs.h"

#include <gtest/gtest.h>

#include "weft/error.h"
#include "weft/fabric.h"
#include "weft/forces/spring.h"
#include "weft/model/springs.h"

namespace weft::engine {
namespace {

const Fabric kFabric{.c11 = 400, .c22 = 900, .c12 = 50, .g = 50};

SpringModel model_of(CellDiagonals diagonals) {
  switch (diagonals) {
    case CellDiagonals::both:
      return SpringModel::basic;
    case CellDiagonals::alternating:
      return SpringModel::alternating;
    case CellDiagonals::parallel:
      break;
  }
  return SpringModel::simplified;
}

/// Energy per area, over ½, of a grid under the homogeneous strain (ε11, ε22, γ) of its axes.
double twice_density(const Grid& grid, CellDiagonals diagonals, const GridSprings& springs,
                     const Vec3& strain) {
  const TriangleMesh mesh = build_grid_mesh(grid, GridDiagonals::parallel);
  const auto place = [&](int v) {
    const Vec3& p = mesh.positions[v];
    return Vec3(p.x() * (1 + strain[0]) + 0.5 * strain[2] * p.z(), 0,
                p.z() * (1 + strain[1]) + 0.5 * strain[2] * p.x());
  };
  double energy = 0;
  for (const Spring& s : build_grid_springs(grid, model_of(diagonals))) {
    const Vec3 rest = mesh.positions[s.j] - mesh.positions[s.i];
    if (s.kind == SpringKind::bend) continue;
    double k = springs.diagonal;
    if (s.kind == SpringKind::structural) {
      const bool is_x = rest.z() == 0;
      const double across = is_x ? mesh.positions[s.i].z() : mesh.positions[s.i].x();
      const bool is_border = across == 0 || across == (is_x ? grid.size_z : grid.size_x);
      k = (is_x ? springs.along_x : springs.along_z) * (is_border ? 0.5 : 1.0);
    }
    energy += spring_energy(k, s.rest_length, place(s.j) - place(s.i));
  }
  return 2 * energy / (grid.size_x * grid.size_z);
}

TEST(GridSprings, HaveTheFabricsStiffnessOnAnyCellsAtAnyResolution) {
  constexpr double kStrain = 1e-4;  // the springs' energy is quadratic up to terms of that order
  constexpr double kTolerated = 5e-4;
  for (const auto diagonals : {CellDiagonals::both, CellDiagonals::alternating, CellDiagonals::parallel}) {
    for (const GridWarp warp : {GridWarp::first_axis, GridWarp::second_axis}) {
      for (const Grid& grid :
           {Grid{1, 1, 4, 4}, Grid{1, 1, 16, 16}, Grid{2, 1, 32, 32}, Grid{1, 0.5, 8, 6}}) {
        const GridSprings springs = make_grid_springs(grid, diagonals, warp, kFabric, "mine");
        const auto recovered = [&](const Vec3& e) {
          return twice_density(grid, diagonals, springs, kStrain * e) / (kStrain * kStrain);
        };
        const bool is_first = warp == GridWarp::first_axis;
        const double xx = recovered({1, 0, 0}), zz = recovered({0, 1, 0});
        EXPECT_NEAR(xx / (is_first ? 400 : 900), 1, kTolerated);
        EXPECT_NEAR(zz / (is_first ? 900 : 400), 1, kTolerated);
        EXPECT_NEAR(recovered({0, 0, 1}) / 50, 1, kTolerated);
        EXPECT_NEAR((recovered({1, 1, 0}) - xx - zz) / 2 / 50, 1, 0.01) << "a difference of large numbers";
        // C16 is the coupling of parallel diagonals: G dx/dz.
        const double expected =
            diagonals == CellDiagonals::parallel ? grid.spacing_x() / grid.spacing_z() : 0;
        const double c16 = (recovered({1, 0, 1}) - xx - recovered({0, 0, 1})) / 2;
        EXPECT_NEAR(std::abs(c16) / 50, expected, 0.01);
      }
    }
  }
}

TEST(GridSprings, OnSquaresAreTheTextbooksOnes) {
  const Grid square{1, 1, 10, 10};
  const GridSprings two =
      make_grid_springs(square, CellDiagonals::both, GridWarp::first_axis, kFabric, "mine");
  EXPECT_NEAR(two.diagonal, 50, 1e-9);
  EXPECT_NEAR(two.along_x, 350, 1e-9);
  EXPECT_NEAR(two.along_z, 850, 1e-9);
  EXPECT_TRUE(two.warnings.empty()) << two.warnings[0];
  const GridSprings one =
      make_grid_springs(square, CellDiagonals::alternating, GridWarp::first_axis, kFabric, "mine");
  EXPECT_NEAR(one.diagonal, 100, 1e-9);
}

TEST(GridSprings, ChangesAreNamed) {
  const Fabric& denim = find_fabric("11oz_black_denim");
  const GridSprings springs =
      make_grid_springs({1, 1, 10, 10}, CellDiagonals::parallel, GridWarp::first_axis, denim, "denim");
  ASSERT_EQ(springs.warnings.size(), 2u);
  EXPECT_EQ(springs.warnings[0],
            "fabric \"denim\": springs impose c12 = g: c12 is 53.4 N/m instead of 20.5 N/m (membrane = "
            "\"triangle\" preserves it)");
  EXPECT_NE(springs.warnings[1].find("c16 = 53.4 N/m, c26 = 53.4 N/m"), std::string::npos);
}

TEST(GridSprings, FabricsThatSpringsCannotBeAreRefusedWithWhatToDo) {
  const auto complaint = [](const Grid& grid, const Fabric& fabric) -> std::string {
    try {
      make_grid_springs(grid, CellDiagonals::both, GridWarp::first_axis, fabric, "jersey");
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_EQ(complaint({1, 1, 10, 10}, find_fabric("gray_interlock")),
            "fabric \"jersey\": springs cannot represent it: c11 = 33.2 N/m must exceed g = 36.9 N/m; use "
            "membrane = "
            "\"triangle\", a smaller g, or a larger c11");
  EXPECT_NE(complaint({4, 1, 10, 10}, kFabric).find("times the cells' (length/width)² = 800 N/m"),
            std::string::npos);
}

}  // namespace
}  // namespace weft::engine
