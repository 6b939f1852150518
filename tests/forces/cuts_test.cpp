/// Where cloth tears: tension across cuts against the exact one of uniform strain.

#include "weft/forces/cuts.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/support.h"
#include "weft/forces/membrane_patch.h"
#include "weft/mesh/tear.h"

namespace weft::engine {
namespace {

constexpr double kAlongWarp = 1800, kAlongWeft = 900;  // [N/m]

struct Sheet {
  std::shared_ptr<const ClothModel> model;
  ClothState state;
  std::vector<char> holds;
};

/// A sheet of which all is stretched alike, seen from above: x' = stretch x. `crooked`: vertices are moved in the plane,
/// as a share of a cell.
Sheet stretch(GridDiagonals diagonals, double crooked, const Mat3& stretch) {
  const Grid grid{.size_x = 0.1, .size_z = 0.08, .cells_x = 10, .cells_z = 8};
  RestMesh mesh = build_grid_mesh(grid, diagonals);
  Random random(3);
  for (int j = 1; j < grid.cells_z; ++j) {
    for (int i = 1; i < grid.cells_x; ++i) {
      Vec3 shift = crooked * grid.spacing_x() * test::random_vector(random, 1);
      shift.y() = 0;
      mesh.positions[grid.index(i, j)] += shift;
    }
  }
  const Fabric fabric{.density = 0.15, .c11 = kAlongWarp, .c22 = kAlongWeft, .c12 = 0, .g = 60};
  const auto elements = build_mesh_elements(mesh, warp_from_direction(mesh, Vec3::UnitX()), fabric);
  Sheet sheet{build_cloth_model(build_mesh_topology(mesh), {.density = fabric.density}, elements), {}, {}};
  std::vector<Vec3> positions;
  for (const Vec3& p : mesh.positions) positions.push_back(stretch * p);
  sheet.state = make_state(positions);
  sheet.holds.assign(positions.size(), 0);
  return sheet;
}

/// Of a strip of stretched yarn per width at rest: forces/membrane.h.
double tension(double stiffness, double stretch) { return stiffness * stretch * (stretch * stretch - 1) / 2; }

Mat3 along(double x, double z) { return Vec3(x, 1, z).asDiagonal(); }

TEST(Cuts, UniformTensionIsExactInsideAndAtBorders) {
  for (const GridDiagonals diagonals : {GridDiagonals::parallel, GridDiagonals::alternating}) {
    const Sheet sheet = stretch(diagonals, 0, along(1.1, 1));
    const double exact = tension(kAlongWarp, 1.1);
    EXPECT_TRUE(find_cuts(*sheet.model, sheet.state, sheet.holds, 1.0001 * exact).empty());
    const std::vector<Cut> cuts = find_cuts(*sheet.model, sheet.state, sheet.holds, 0.99 * exact);
    ASSERT_FALSE(cuts.empty());
    for (const Cut& cut : cuts) EXPECT_NEAR(cut.tension, exact, 1e-3 * exact);
  }
}

TEST(Cuts, RunAcrossTheThreadsThatPull) {
  const Sheet sheet = stretch(GridDiagonals::alternating, 0, along(1, 1.2));
  const double exact = tension(kAlongWeft, 1.2);
  const std::vector<Cut> cuts = find_cuts(*sheet.model, sheet.state, sheet.holds, 0.99 * exact);
  ASSERT_FALSE(cuts.empty());
  for (const Cut& cut : cuts) {
    for (const int end : cut.ends) {
      if (end < 0) continue;
      const Vec3 edge =
          sheet.model->topology->mesh.positions[end] - sheet.model->topology->mesh.positions[cut.particle];
      EXPECT_NEAR(std::abs(edge.normalized().x()), 1, 1e-9);
    }
  }
}

TEST(Cuts, OnCrookedMeshesTheTensionIsNeverMore) {
  const Sheet sheet = stretch(GridDiagonals::parallel, 0.2, along(1.1, 1));
  const double exact = tension(kAlongWarp, 1.1);
  EXPECT_TRUE(find_cuts(*sheet.model, sheet.state, sheet.holds, 1.0001 * exact).empty());
  double least = exact;
  const std::vector<Cut> cuts = find_cuts(*sheet.model, sheet.state, sheet.holds, 0.5 * exact);
  ASSERT_FALSE(cuts.empty());
  for (const Cut& cut : cuts) least = std::min(least, cut.tension);
  EXPECT_GT(least, 0.9 * exact);
}

TEST(Cuts, CompressedSlackAndRotatedClothHasNone) {
  const Mat3 turn = Eigen::AngleAxisd(0.7, Vec3(1, 2, 3).normalized()).toRotationMatrix();
  for (const Mat3& how : {along(0.9, 0.9), Mat3(turn), along(0.8, 1)}) {
    const Sheet sheet = stretch(GridDiagonals::parallel, 0.2, how);
    for (const Cut& cut : find_cuts(*sheet.model, sheet.state, sheet.holds, 1))
      ADD_FAILURE() << cut.particle << ' ' << cut.ends[0] << ' ' << cut.ends[1] << ' ' << cut.tension << "\n"
                    << how;
  }
}

TEST(Cuts, ParticlesThatHoldHaveNoneAndEndNone) {
  constexpr int kColumns = 11, kFree = 6;
  Sheet sheet = stretch(GridDiagonals::parallel, 0, along(1.1, 1));
  std::ranges::fill(sheet.holds, 1);
  sheet.holds[4 * kColumns + kFree] = 0;  // all cuts through it end at particles that hold
  EXPECT_TRUE(find_cuts(*sheet.model, sheet.state, sheet.holds, 1).empty());
  for (std::size_t i = kFree; i < sheet.holds.size(); i += kColumns) sheet.holds[i] = 0;
  const std::vector<Cut> cuts = find_cuts(*sheet.model, sheet.state, sheet.holds, 1);
  ASSERT_FALSE(cuts.empty());
  for (const Cut& cut : cuts) {
    EXPECT_EQ(cut.particle % kColumns, kFree);
    for (const int end : cut.ends) EXPECT_TRUE(end < 0 || end % kColumns == kFree);
  }
}

TEST(Cuts, FloatingPointRotationsChangeTheTensionByRoundingOnly) {
  const Mat3 turn = Eigen::AngleAxisd(1.1, Vec3(3, -2, 1).normalized()).toRotationMatrix();
  const Sheet plain = stretch(GridDiagonals::parallel, 0.2, along(1.1, 1.05)),
              turned = stretch(GridDiagonals::parallel, 0.2, turn * along(1.1, 1.05));
  const auto worst = [](const Sheet& sheet) {
    double most = 0;
    for (const Cut& cut : find_cuts(*sheet.model, sheet.state, sheet.holds, 1))
      most = std::max(most, cut.tension);
    return most;
  };
  EXPECT_NEAR(worst(turned), worst(plain), 1e-4 * worst(plain));
}

TEST(Cuts, TriangleForcesOfPatchesAreTheirForce) {
  const Sheet sheet = stretch(GridDiagonals::alternating, 0.2, along(1.1, 0.95));
  std::vector<Vec3> x = positions_of(sheet.state);
  Random random(5);
  for (Vec3& p : x) p += test::random_vector(random, 2e-3);
  const PatchLaw law = sheet.model->elements->law();
  for (const MembranePatch& patch : sheet.model->elements->patches) {
    const PatchCorners corners = corners_of(patch, x), force = patch_force(patch, law, corners);
    PatchCorners sum;
    sum.fill(Vec3::Zero());
    const auto own = patch_triangle_forces(patch, law, corners);
    for (int t = 0; t < patch.num_triangles; ++t) {
      Vec3 total = Vec3::Zero();
      for (int c = 0; c < 3; ++c) {
        sum[patch.corners[t][c]] += own[t][c];
        total += own[t][c];
      }
      EXPECT_LT(total.norm(), 1e-9);
    }
    for (int v = 0; v < patch.num_vertices(); ++v) EXPECT_LT((sum[v] - force[v]).norm(), 1e-12);
  }
}

}  // namespace
}  // namespace weft::engine
