#include "weft/mesh/solid.h"

#include <gtest/gtest.h>

#include <cmath>
#include <utility>
#include <vector>

#include "weft/core/random.h"
#include "weft/mesh/clean.h"

namespace weft::engine {
namespace {

TriangleMesh box(const Vec3& center, double half_size) {
  const TriangleMesh mesh = make_box_mesh(center, Vec3::Constant(half_size), Mat3::Identity());
  return clean_mesh(mesh, {.weld_distance = 0}).mesh;
}

void turn_inside_out(TriangleMesh& mesh) {
  for (Triangle& t : mesh.triangles) std::swap(t[1], t[2]);
}

TriangleMesh join(TriangleMesh mesh, const TriangleMesh& other) {
  const int first = mesh.num_vertices();
  mesh.positions.insert(mesh.positions.end(), other.positions.begin(), other.positions.end());
  for (const auto& [a, b, c] : other.triangles) mesh.triangles.push_back({first + a, first + b, first + c});
  return mesh;
}

TEST(SurfaceEdges, OfAClosedSurfaceAreAllGood) {
  const SurfaceEdges edges = count_surface_edges(box(Vec3::Zero(), 1));
  EXPECT_TRUE(is_closed(edges));
  EXPECT_EQ(edges.non_manifold, 0);
  EXPECT_EQ(edges.twisted, 0);
}

TEST(SurfaceEdges, CountBordersTwistedTrianglesAndFins) {
  TriangleMesh open = box(Vec3::Zero(), 1);
  open.triangles.pop_back();
  EXPECT_EQ(count_surface_edges(open).border, 3);
  EXPECT_FALSE(is_closed(count_surface_edges(open)));

  TriangleMesh twisted = box(Vec3::Zero(), 1);
  std::swap(twisted.triangles[4][0], twisted.triangles[4][1]);
  EXPECT_EQ(count_surface_edges(twisted).twisted, 3);
  EXPECT_FALSE(is_closed(count_surface_edges(twisted))) << "one triangle's inside is the others' outside";

  TriangleMesh finned = box(Vec3::Zero(), 1);
  finned.positions.emplace_back(0, 0, 9);
  finned.triangles.push_back({finned.triangles[0][0], finned.triangles[0][1], 8});
  EXPECT_EQ(count_surface_edges(finned).non_manifold, 1);
  EXPECT_EQ(count_surface_edges(finned).border, 2);
  EXPECT_FALSE(is_closed(count_surface_edges(finned)));
}

TEST(SurfaceEdges, OfTwoSolidsThatMeetAtAnEdgeStillClose) {
  const TriangleMesh two =
      clean_mesh(join(box(Vec3::Zero(), 1), box(Vec3(2, 2, 0), 1)), {.weld_distance = 0}).mesh;
  EXPECT_EQ(count_surface_edges(two).non_manifold, 1);
  EXPECT_TRUE(is_closed(count_surface_edges(two)));
}

TEST(SurfaceEdges, OfASolidWithAWallInsideDoNotClose) {
  TriangleMesh walled = box(Vec3::Zero(), 1);
  const auto [a, b, c] = walled.triangles[0];
  walled.positions.emplace_back(0, 0, 0);
  walled.triangles.insert(walled.triangles.end(), {{a, b, 8}, {b, c, 8}, {c, a, 8}});
  const SurfaceEdges edges = count_surface_edges(walled);
  EXPECT_EQ(edges.non_manifold, 3);
  EXPECT_EQ(edges.border + edges.twisted, 0);
  EXPECT_FALSE(is_closed(edges));
}

TEST(SignedVolume, IsThatOfTheSolidWhereverItLies) {
  EXPECT_NEAR(compute_signed_volume(box(Vec3(1e3, -2e3, 3e3), 0.5)), 1, 1e-9);
  EXPECT_EQ(compute_signed_volume({}), 0);
}

TEST(SignedVolume, IsNegativeInsideOut) {
  TriangleMesh mesh = box(Vec3(1, 2, 3), 1);
  turn_inside_out(mesh);
  EXPECT_NEAR(compute_signed_volume(mesh), -8, 1e-12);
  EXPECT_EQ(count_surface_edges(mesh).twisted, 0);
}

TEST(WindingNumbers, AgreeWithTheSphere) {
  const Vec3 center(0.3, 0.2, 0.1);
  const TriangleMesh mesh = make_sphere_mesh(center, 0.5, 40);
  Random random(1);
  std::vector<Vec3> points;
  for (int i = 0; i < 4000; ++i)
    points.emplace_back(random.uniform(-0.5, 1), random.uniform(-0.5, 1), random.uniform(-0.5, 1));
  const std::vector<int> winding = compute_winding_numbers(mesh, points);
  int num_inside = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const double r = (points[i] - center).norm();
    if (r > 0.498 && r < 0.5)
      continue;  // between the sphere and its flat triangles: sagitta 0.5 (1 - cos 4.5°)
    EXPECT_EQ(winding[i], r < 0.5 ? 1 : 0) << points[i].transpose();
    EXPECT_EQ(compute_winding_number(mesh.triangles, mesh.positions, points[i]), winding[i]);
    num_inside += winding[i];
  }
  EXPECT_GT(num_inside, 400);
}

TEST(WindingNumbers, CountPointsBelowVerticesAndEdgesOnce) {
  // A grid of points above, in and below the box, in line with its corners and diagonals; and the same points
  // with a sphere, where a ray passes through the pole.
  std::vector<Vec3> points;
  for (const double y : {-2.0, -0.5, 0.0, 0.5, 2.0}) {
    for (int i = -4; i <= 4; ++i) {
      for (int j = -4; j <= 4; ++j) points.emplace_back(0.5 * i, y, 0.5 * j);
    }
  }
  const auto is_on_surface = [](const Vec3& p) { return p.cwiseAbs().maxCoeff() == 1; };
  for (const TriangleMesh& mesh : {box(Vec3::Zero(), 1), make_sphere_mesh(Vec3::Zero(), 1, 8)}) {
    const bool is_box = mesh.num_vertices() == 8;
    const std::vector<int> winding = compute_winding_numbers(mesh, points);
    for (std::size_t i = 0; i < points.size(); ++i) {
      const Vec3& p = points[i];
      if (is_box && is_on_surface(p)) continue;
      if (!is_box && p.norm() > 0.9 && p.norm() < 1.01) continue;  // sagitta of eight rings
      const bool is_inside = is_box ? p.cwiseAbs().maxCoeff() < 1 : p.norm() < 1;
      EXPECT_EQ(winding[i], is_inside ? 1 : 0) << p.transpose();
    }
  }
}

TEST(WindingNumbers, KnowOverlapsHollowsAndInsideOut) {
  const std::vector<Vec3> points = {{0.1, 0.2, 0.3}, {0.9, 0.8, 0.7}, {1.6, 1.7, 1.8}, {3, 3, 3}};
  const TriangleMesh overlapping = join(box(Vec3::Zero(), 1), box(Vec3::Ones(), 1));
  EXPECT_EQ(compute_winding_numbers(overlapping, points), (std::vector<int>{2, 2, 1, 0}));
  TriangleMesh hollow = box(Vec3::Zero(), 0.5);
  turn_inside_out(hollow);
  EXPECT_EQ(compute_winding_numbers(join(box(Vec3::Zero(), 1), hollow), points),
            (std::vector<int>{0, 1, 0, 0}));
  EXPECT_EQ(compute_winding_numbers(hollow, points), (std::vector<int>{-1, 0, 0, 0}));
}

TEST(Shells, ThatFaceInwardsAreTurnedButHollowsAreNot) {
  TriangleMesh hair = box(Vec3(0.5, 0.6, 0.5), 1), hollow = box(Vec3(0.2, 0.2, 0.2), 0.05);
  turn_inside_out(hair);
  turn_inside_out(hollow);
  TriangleMesh mesh = join(join(box(Vec3::Zero(), 1), hair), hollow);
  const TurnedShells shells = turn_shells_outwards(mesh);
  EXPECT_EQ(shells.count, 3);
  EXPECT_EQ(shells.turned, 1);
  const std::vector<Vec3> points = {{-0.7, 0.1, 0.1}, {0.7, 0.8, 0.9}, {1.2, 1.3, 1.2}, {0.21, 0.22, 0.23}};
  EXPECT_EQ(compute_winding_numbers(mesh, points), (std::vector<int>{1, 2, 1, 1}));
}

TEST(OrientTriangles, FlipsTheFewerOfEachPart) {
  Random random(1);
  for (int trial = 0; trial < 20; ++trial) {
    const TriangleMesh ball = clean_mesh(make_sphere_mesh(Vec3::Zero(), 1, 10), {.weld_distance = 0}).mesh;
    TriangleMesh mesh =
        join(ball, clean_mesh(make_sphere_mesh(Vec3(5, 0, 0), 1, 10), {.weld_distance = 0}).mesh);
    const TriangleMesh right = mesh;
    int flipped = 0;
    for (Triangle& t : mesh.triangles) {
      if (random.uniform(0, 1) > 0.3) continue;
      std::swap(t[1], t[2]);
      ++flipped;
    }
    EXPECT_EQ(orient_triangles(mesh), flipped);
    EXPECT_TRUE(is_closed(count_surface_edges(mesh)));
    EXPECT_NEAR(compute_signed_volume(mesh), compute_signed_volume(right), 1e-12);
    EXPECT_EQ(orient_triangles(mesh), 0);
  }
}

TEST(OrientTriangles, LeavesAStripWithOneSide) {
  TriangleMesh strip;  // of Möbius
  constexpr int kCells = 12;
  for (int k = 0; k < kCells; ++k) {
    const double turn = 2 * 3.141592653589793 * k / kCells;
    for (const double across : {-0.3, 0.3}) {
      const double r = 1 + across * std::cos(turn / 2);
      strip.positions.emplace_back(r * std::cos(turn), across * std::sin(turn / 2), r * std::sin(turn));
    }
    const int a = 2 * k, b = a + 1, c = k + 1 < kCells ? a + 2 : 1, d = k + 1 < kCells ? a + 3 : 0;
    strip.triangles.insert(strip.triangles.end(), {{a, b, c}, {b, d, c}});
  }
  const std::vector<Triangle> before = strip.triangles;
  EXPECT_EQ(orient_triangles(strip), 0);
  EXPECT_EQ(strip.triangles, before);
  EXPECT_GT(count_surface_edges(strip).twisted, 0);
}

TEST(WindingNumbers, OfManyPointsAreThoseOfEach) {
  const TriangleMesh flat = join(box(Vec3::Zero(), 1), box(Vec3(4, 0, 4), 0.5));
  Random random(3);
  std::vector<Vec3> points;
  for (int k = 0; k < 2000; ++k)
    points.emplace_back(random.uniform(-2, 6), random.uniform(-1.2, 1.2), random.uniform(-2, 6));
  for (int i = -8; i <= 24; ++i) {  // in line with corners, edges, diagonals and the borders of cells
    for (int k = -8; k <= 24; ++k) points.emplace_back(0.25 * i, 0.1, 0.25 * k);
  }
  const std::vector<int> winding = compute_winding_numbers(flat, points);
  for (std::size_t p = 0; p < points.size(); ++p) {
    EXPECT_EQ(winding[p], compute_winding_number(flat.triangles, flat.positions, points[p]));
  }
}

TEST(SolidPart, IsThatOfTheClosedShells) {
  TriangleMesh open = box(Vec3(1, 0, 0), 2);
  open.triangles.pop_back();
  const TriangleMesh mesh = join(join(box(Vec3::Zero(), 1), open), box(Vec3(9, 0, 0), 1));
  const TriangleMesh solid = find_solid_part(mesh);
  EXPECT_EQ(solid.num_vertices(), mesh.num_vertices());
  EXPECT_NEAR(compute_signed_volume(solid), 8 + 8, 1e-12);
  EXPECT_EQ(compute_winding_numbers(solid, {Vec3::Zero(), Vec3(2, 0, 0), Vec3(9, 0, 0)}),
            (std::vector<int>{1, 0, 1}));
}

TEST(Shells, ThatAreOpenAreNeitherTurnedNorHollows) {
  TriangleMesh open = box(Vec3::Zero(), 3);  // around the other one, facing inwards
  open.triangles.pop_back();
  turn_inside_out(open);
  TriangleMesh inwards = box(Vec3::Zero(), 1);
  turn_inside_out(inwards);
  TriangleMesh mesh = join(open, inwards);
  const TurnedShells shells = turn_shells_outwards(mesh);
  EXPECT_EQ(shells.count, 2);
  EXPECT_EQ(shells.turned, 1);
  EXPECT_EQ(mesh.triangles[0], open.triangles[0]);
  EXPECT_NEAR(compute_signed_volume(find_solid_part(mesh)), 8, 1e-12);
}

}  // namespace
}  // namespace weft::engine
