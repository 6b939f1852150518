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

/// A tube around y without its ends, and with a slit of this angle.
TriangleMesh make_collar(double slit) {
  constexpr int kAround = 40;
  TriangleMesh mesh;
  for (int k = 0; k <= kAround; ++k) {
    const double angle = (2 * std::numbers::pi - slit) * k / kAround;
    for (const double y : {0.0, 1.0}) mesh.positions.emplace_back(std::cos(angle), y, std::sin(angle));
    if (k == kAround) break;
    const int a = 2 * k, b = a + 1, c = a + 2, d = a + 3;
    mesh.triangles.insert(mesh.triangles.end(), {{a, b, c}, {b, d, c}});
  }
  return mesh;
}

TEST(FillHoles, LeavesCurledSheets) {
  for (const double slit : {0.3, 0.1, 0.01, 0.0}) {
    TriangleMesh collar = make_collar(slit);
    EXPECT_EQ(fill_holes(collar, 0.05).count, 0) << slit;
  }
}

TEST(FillHoles, LeavesSheetsWithoutVolume) {
  for (TriangleMesh sheet : {build_disc_mesh(1, 1), build_disc_mesh(1, 6)}) {
    const std::size_t before = sheet.triangles.size();
    EXPECT_EQ(fill_holes(sheet, kAny).count, 0);
    EXPECT_EQ(sheet.triangles.size(), before);
  }
}

/// Fins on an edge, and cards on a vertex, are no holes of the body.
TEST(FillHoles, LeavesWhatIsAttachedToABody) {
  TriangleMesh finned = make_ball();
  const auto [a, b, c] = finned.triangles[0];
  finned.positions.push_back(2 * finned.positions[a]);
  finned.triangles.push_back({a, b, finned.num_vertices() - 1});
  const std::size_t before = finned.triangles.size();
  EXPECT_NEAR(compute_signed_volume(find_solid_part(finned)), 4.1, 0.1) << "solid without the fin";
  EXPECT_EQ(fill_holes(finned, kAny).count, 0);
  EXPECT_EQ(finned.triangles.size(), before);

  TriangleMesh with_card = without(make_ball(), {30});
  const int first = with_card.num_vertices();
  const auto [i, j, k] = with_card.triangles[9];
  with_card.positions.push_back(1.3 * with_card.positions[i]);
  with_card.positions.push_back(1.3 * with_card.positions[j]);
  with_card.triangles.push_back({i, first, first + 1});
  EXPECT_EQ(fill_holes(with_card, 0.05).count, 1);
  EXPECT_NEAR(compute_signed_volume(find_solid_part(with_card)), 4.1, 0.1);
  (void)k;
}

TEST(FillHoles, LeavesAGapWithoutArea) {
  // Removed by mesh cleaning where a vertex lies on the edge of a neighbour.
  TriangleMesh mesh = make_ball();
  const auto [a, b, c] = mesh.triangles[5];
  mesh.positions[b] = 0.5 * (mesh.positions[a] + mesh.positions[c]);
  mesh.triangles.erase(mesh.triangles.begin() + 5);
  EXPECT_EQ(fill_holes(mesh, 0.05).count, 0);
}

TEST(FillHoles, ClosesASphereWithManyHoles) {
  Random random(7);
  int num_filled = 0, num_open = 0;
  for (int trial = 0; trial < 200; ++trial) {
    TriangleMesh mesh = make_ball();
    const int num_holes = 1 + static_cast<int>(random.uniform(0, 12));
    for (int k = 0; k < num_holes; ++k) {
      const Vec3 middle = mesh.positions[static_cast<int>(random.uniform(0, mesh.num_vertices()))];
      const double radius = random.uniform(0.05, 0.5);
      std::erase_if(mesh.triangles, [&](const Triangle& t) {
        return ((mesh.positions[t[0]] + mesh.positions[t[1]] + mesh.positions[t[2]]) / 3 - middle).norm() <
               radius;
      });
    }
    const TriangleMesh before = mesh;
    num_filled += fill_holes(mesh, kAny).count;
    EXPECT_TRUE(std::equal(before.triangles.begin(), before.triangles.end(), mesh.triangles.begin()));
    for (const Shell& shell : find_shells(mesh)) {
      const bool is_nearly_flat = shell.triangles.size() < 100;
      num_open += shell.is_closed || is_nearly_flat ? 0 : 1;
    }
  }
  EXPECT_GT(num_filled, 600);
  EXPECT_LE(num_open, 4) << "of those with islands that touch a hole's border";
}

}  // namespace
}  // namespace weft::engine
