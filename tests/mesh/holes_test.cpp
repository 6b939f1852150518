#include "weft/mesh/holes.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "weft/core/random.h"
#include "weft/mesh/sample_meshes.h"
#include "weft/mesh/solid.h"

namespace weft::engine {
namespace {

constexpr double kAny = std::numeric_limits<double>::infinity();

TriangleMesh make_ball() { return build_geodesic_mesh(1, 3); }

/// Without the triangles around the vertices.
TriangleMesh without(TriangleMesh mesh, const std::vector<int>& vertices) {
  std::erase_if(mesh.triangles, [&](const Triangle& t) {
    return std::ranges::any_of(vertices, [&](int v) { return t[0] == v || t[1] == v || t[2] == v; });
  });
  return mesh;
}

TEST(FillHoles, ClosesASphereAtLittleCost) {
  TriangleMesh mesh = without(make_ball(), {20, 200});
  const FilledHoles filled = fill_holes(mesh, 0.05);
  EXPECT_EQ(filled.count, 2);
  EXPECT_TRUE(is_closed(count_surface_edges(mesh)));
  EXPECT_NEAR(compute_signed_volume(mesh), compute_signed_volume(make_ball()), 0.005);
  // Six triangles are about as large as the hole's circle.
  const double area = 6 * 4 * std::numbers::pi / make_ball().num_triangles();
  EXPECT_NEAR(filled.largest, 2 * std::sqrt(area / std::numbers::pi), 0.1 * filled.largest);
}

TEST(FillHoles, ClosesHolesThatTouch) {
  // Two vertices with one neighbour in common, and not joined: their holes touch there.
  const TriangleMesh ball = make_ball();
  const auto is_joined = [&](int v, int w) {
    return std::ranges::any_of(ball.triangles, [&](const Triangle& t) {
      return std::ranges::count(t, v) + std::ranges::count(t, w) == 2;
    });
  };
  int num_pairs = 0;
  for (int v = 0; v < 60; ++v) {
    for (int w = 0; w < v; ++w) {
      int common = 0;
      for (int u = 0; u < ball.num_vertices(); ++u) common += is_joined(u, v) && is_joined(u, w) ? 1 : 0;
      if (is_joined(v, w) || common != 1) continue;
      ++num_pairs;
      TriangleMesh mesh = without(ball, {v, w});
      EXPECT_EQ(fill_holes(mesh, kAny).count, 2);
      EXPECT_TRUE(is_closed(count_surface_edges(mesh)));
    }
  }
  EXPECT_GT(num_pairs, 3);
}

TEST(FillHoles, LeavesWhatIsOpenByDesign) {
  TriangleMesh bowl = make_ball();
  std::erase_if(bowl.triangles, [&](const Triangle& t) {
    return bowl.positions[t[0]].y() + bowl.positions[t[1]].y() + bowl.positions[t[2]].y() > 0;
  });
  const TriangleMesh before = bowl;
  EXPECT_EQ(fill_holes(bowl, 0.05).count, 0);
  EXPECT_EQ(bowl.triangles, before.triangles);
  EXPECT_EQ(fill_holes(bowl, kAny).count, 1);
  EXPECT_EQ(compute_winding_numbers(bowl, {Vec3(0, -0.5, 0), Vec3(0, 0.5, 0)}), (std::vector<int>{1, 0}));

  TriangleMesh floor = build_disc_mesh(1, 6);
  EXPECT_EQ(fill_holes(floor, 0.05).count, 0);
}

TEST(FillHoles, JudgesEachShellByItself) {
  TriangleMesh mesh = without(make_ball(), {30});
  const TriangleMesh card = build_disc_mesh(0.1, 2);
  const int first = mesh.num_vertices();
  for (const Vec3& p : card.positions) mesh.positions.push_back(p + Vec3(0, 1.2, 0));
  for (const auto& [a, b, c] : card.triangles) mesh.triangles.push_back({first + a, first + b, first + c});
  EXPECT_EQ(fill_holes(mesh, 0.05).count, 1);
  EXPECT_NEAR(compute_signed_volume(find_solid_part(mesh)), 4.1, 0.1);
}

TEST(FillHoles, ClosesWhateverIsLeftOfASphere) {
  Random random(7);
  for (int trial = 0; trial < 200; ++trial) {
    TriangleMesh mesh = make_ball();
    const double left = 0.05 + 0.9 * random.uniform(0, 1);
    std::erase_if(mesh.triangles, [&](const Triangle&) { return random.uniform(0, 1) > left; });
    if (mesh.triangles.empty()) continue;
    fill_holes(mesh, kAny);
    EXPECT_TRUE(is_closed(count_surface_edges(mesh))) << trial;
  }
}

}  // namespace
}  // namespace weft::engine
