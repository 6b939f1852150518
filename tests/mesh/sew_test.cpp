#include "weft/mesh/sew.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>
#include <numbers>
#include <numeric>
#include <set>

#include "weft/core/random.h"
#include "weft/mesh/clean.h"
#include "weft/mesh/divide.h"
#include "weft/mesh/sample_meshes.h"

namespace weft::engine {
namespace {

int root(std::vector<int>& parent, int v) {
  while (parent[v] != v) v = parent[v] = parent[parent[v]];
  return v;
}

/// Surface properties of a mesh.
struct Shape {
  int pieces = 0, borders = 0, euler = 0;
  int most_triangles = 0;  // at an edge
  int repeated = 0;        // triangles
  double area = 0, least_area = 1e300;
};

Shape shape_of(const TriangleMesh& mesh) {
  Shape shape;
  std::vector<int> piece(mesh.positions.size());
  std::iota(piece.begin(), piece.end(), 0);
  std::vector<int> border = piece;
  std::set<int> at_border;
  const std::vector<Edge> edges = build_edges(mesh);
  for (const Edge& e : edges) {
    piece[root(piece, e.a)] = root(piece, e.b);
    shape.most_triangles = std::max(shape.most_triangles, e.num_triangles);
    if (e.num_triangles != 1) continue;
    border[root(border, e.a)] = root(border, e.b);
    at_border.insert({e.a, e.b});
  }
  for (int v = 0; v < mesh.num_vertices(); ++v) shape.pieces += piece[v] == v;
  for (const int v : at_border) shape.borders += border[v] == v;
  shape.euler = mesh.num_vertices() - static_cast<int>(edges.size()) + mesh.num_triangles();
  std::set<Triangle> seen;
  for (int t = 0; t < mesh.num_triangles(); ++t) {
    Triangle key = mesh.triangles[t];
    std::sort(key.begin(), key.end());
    shape.repeated += !seen.insert(key).second;
    shape.area += triangle_area(mesh, t);
    shape.least_area = std::min(shape.least_area, triangle_area(mesh, t));
  }
  return shape;
}

void expect_sound(const TriangleMesh& mesh, const SewnMesh& sewn, double distance) {
  const Shape shape = shape_of(sewn.mesh);
  EXPECT_LE(shape.most_triangles, 2);
  EXPECT_EQ(shape.repeated, 0);
  EXPECT_GT(shape.least_area, 1e-12);
  for (int v = 0; v < mesh.num_vertices(); ++v) {
    ASSERT_GE(sewn.vertex_of_source[v], 0);
    const double way = (sewn.mesh.positions[sewn.vertex_of_source[v]] - mesh.positions[v]).norm();
    EXPECT_LE(way, distance * (1 + 1e-8)) << "vertex " << v;
  }
}

void add(TriangleMesh& mesh, const TriangleMesh& piece, const std::function<Vec3(const Vec3&)>& map) {
  const int first = mesh.num_vertices();
  for (const Vec3& p : piece.positions) mesh.positions.push_back(map(p));
  for (const auto& [a, b, c] : piece.triangles) mesh.triangles.push_back({a + first, b + first, c + first});
}

/// A sheet in the x–z plane.
TriangleMesh sheet(double size_x, double size_z, int cells_x, int cells_z) {
  return build_grid_mesh({.size_x = size_x, .size_z = size_z, .cells_x = cells_x, .cells_z = cells_z},
                         GridDiagonals::alternating);
}

std::function<Vec3(const Vec3&)> moved(double x, double y, double z) {
  return [=](const Vec3& p) { return Vec3(p + Vec3(x, y, z)); };
}

/// Bent to a part of a cylinder around the x axis: z becomes the angle.
std::function<Vec3(const Vec3&)> rolled(double radius, double start = 0) {
  return [=](const Vec3& p) {
    const double angle = start + p.z() / radius;
    return Vec3(p.x(), radius * std::cos(angle), radius * std::sin(angle));
  };
}

// ---- Two pieces

TEST(Sew, JoinsBordersOfUnequalVertexCounts) {
  TriangleMesh mesh;
  add(mesh, sheet(0.1, 0.1, 4, 7), moved(0, 0, 0));
  add(mesh, sheet(0.1, 0.1, 4, 10), moved(0.1015, 0, 0));
  const SewnMesh sewn = sew_borders(mesh, 0.002);
  expect_sound(mesh, sewn, 0.002);
  const Shape shape = shape_of(sewn.mesh);
  EXPECT_EQ(shape.pieces, 1);
  EXPECT_EQ(shape.borders, 1);
  EXPECT_EQ(shape.euler, 1) << "a disc";
  EXPECT_EQ(sewn.num_seams, 1);
  EXPECT_NEAR(shape.area, 0.2015 * 0.1, 1e-9) << "the gap is filled by both halves";
  EXPECT_EQ(shape_of(sew_borders(mesh, 0.001).mesh).pieces, 2) << "too far apart for 1 mm";
}

TEST(Sew, DividesOneLongEdgeForAllThatMeetIt) {
  TriangleMesh mesh{{{0, 0, 0}, {0.1, 0, 0}, {0.05, 0, -0.05}}, {{0, 1, 2}}};
  add(mesh, sheet(0.1, 0.05, 10, 4), moved(0, 0, 0.001));
  const SewnMesh sewn = sew_borders(mesh, 0.002);
  expect_sound(mesh, sewn, 0.002);
  EXPECT_EQ(sewn.num_divided, 1);
  EXPECT_EQ(shape_of(sewn.mesh).euler, 1);
  EXPECT_EQ(sewn.mesh.num_triangles(), 10 + 80);
}

TEST(Sew, JoinsBordersOfUnequalLengthWithinTheDistance) {
  TriangleMesh mesh;
  add(mesh, sheet(0.1, 0.1, 4, 20), moved(-0.1, 0, 0));
  add(mesh, sheet(0.1, 0.1, 4, 33), [](const Vec3& p) {  // eased: a wave of 1 mm, 4 % longer
    return Vec3(p.x(), 0.001 * std::sin(2 * std::numbers::pi * p.z() / 0.0157), p.z());
  });
  const SewnMesh sewn = sew_borders(mesh, 0.002);
  expect_sound(mesh, sewn, 0.002);
  EXPECT_EQ(shape_of(sewn.mesh).euler, 1);
  EXPECT_EQ(shape_of(sewn.mesh).borders, 1);
}

TEST(Sew, DoesNotMindWhichWayTrianglesFaceOrBordersRun) {
  for (const bool turned : {false, true}) {
    TriangleMesh other = sheet(0.1, 0.1, 4, 9);
    if (turned) {
      for (Triangle& t : other.triangles) std::swap(t[1], t[2]);
    }
    for (const bool rotated : {false, true}) {
      TriangleMesh mesh;
      add(mesh, sheet(0.1, 0.1, 4, 7), moved(0, 0, 0));
      add(mesh, other, [=](const Vec3& p) {
        return rotated ? Vec3(0.2 - p.x(), 0, 0.1 - p.z()) : Vec3(0.1 + p.x(), 0, p.z());
      });
      const SewnMesh sewn = sew_borders(mesh, 0.002);
      expect_sound(mesh, sewn, 0.002);
      EXPECT_EQ(shape_of(sewn.mesh).euler, 1) << turned << rotated;
      EXPECT_EQ(shape_of(sewn.mesh).borders, 1) << turned << rotated;
    }
  }
}

TEST(Sew, SewsAStripToBothNeighbours) {
  TriangleMesh mesh;
  add(mesh, sheet(0.1, 0.3, 4, 11), moved(-0.101, 0, 0));
  add(mesh, sheet(0.02, 0.3, 2, 30), moved(0, 0, 0));
  add(mesh, sheet(0.1, 0.3, 4, 13), moved(0.021, 0, 0));
  const SewnMesh sewn = sew_borders(mesh, 0.002);
  expect_sound(mesh, sewn, 0.002);
  EXPECT_EQ(sewn.num_seams, 2);
  EXPECT_EQ(shape_of(sewn.mesh).euler, 1);
}

TEST(Sew, LeavesARibbonNarrowerThanTheDistanceOpen) {
  const TriangleMesh ribbon = sheet(0.001, 0.1, 1, 50);
  const SewnMesh sewn = sew_borders(ribbon, 0.002);
  EXPECT_EQ(sewn.num_seams, 0);
  EXPECT_EQ(sewn.mesh.positions, ribbon.positions);
  EXPECT_EQ(sewn.mesh.triangles, ribbon.triangles);
}

// ---- Closed borders and tubes

TEST(Sew, SetsASleeveIntoAnArmhole) {
  // A tube of 40 around and a flaring one of 57 around, end to end.
  const auto tube = [](int around, double x, double flare) {
    TriangleMesh mesh;
    add(mesh, sheet(0.1, 2 * std::numbers::pi * 0.06, 5, around), [=](const Vec3& p) {
      const double wide = 1 + flare * p.x();
      const Vec3 q = rolled(0.06)(p);
      return Vec3(x + q.x(), wide * q.y(), wide * q.z());
    });
    return clean_mesh(mesh, {.weld_distance = 1e-6}).mesh;
  };
  TriangleMesh mesh = tube(40, 0, 0);
  add(mesh, tube(57, 0.1012, 2), moved(0, 0, 0));
  ASSERT_EQ(shape_of(mesh).pieces, 2);
  const SewnMesh sewn = sew_borders(mesh, 0.002);
  expect_sound(mesh, sewn, 0.002);
  const Shape shape = shape_of(sewn.mesh);
  EXPECT_EQ(shape.pieces, 1);
  EXPECT_EQ(shape.borders, 2);
  EXPECT_EQ(shape.euler, 0) << "an open tube";
  EXPECT_EQ(sewn.num_seams, 1);
}

TEST(Sew, ClosesATubeOfOnePanel) {
  const double radius = 0.05, around = 2 * std::numbers::pi * radius;
  TriangleMesh mesh;
  add(mesh, build_random_mesh({.size_x = 0.2, .size_z = around - 0.0015, .cells_x = 12, .cells_z = 20}, 3),
      rolled(radius));
  const SewnMesh sewn = sew_borders(mesh, 0.002);
  expect_sound(mesh, sewn, 0.002);
  EXPECT_EQ(shape_of(sewn.mesh).euler, 0);
  EXPECT_EQ(shape_of(sewn.mesh).borders, 2);
}

TEST(Sew, ClosesASlitToItsTipAndLeavesCornersAndHolesOpen) {
  // A sheet cut from the middle of one side to its middle, the cut opened like a V of 1.5 mm; and a hole.
  const Grid grid{.size_x = 0.1, .size_z = 0.1, .cells_x = 10, .cells_z = 10};
  TriangleMesh mesh = build_grid_mesh(grid, GridDiagonals::alternating);
  std::erase_if(mesh.triangles, [&](const Triangle& t) { return t[0] == grid.index(2, 2); });
  const TriangleMesh whole = mesh;
  std::vector<int> other(mesh.positions.size());
  std::iota(other.begin(), other.end(), 0);
  for (int j = 0; j < 5; ++j) {
    other[grid.index(5, j)] = mesh.num_vertices();
    mesh.positions.push_back(mesh.positions[grid.index(5, j)] + Vec3(0.0003 * (5 - j), 0, 0));
  }
  for (Triangle& t : mesh.triangles) {
    const double x = (whole.positions[t[0]] + whole.positions[t[1]] + whole.positions[t[2]]).x() / 3;
    for (int& v : t) v = x > 0.05 ? other[v] : v;
  }
  const SewnMesh sewn = sew_borders(mesh, 0.002);
  expect_sound(mesh, sewn, 0.002);
  EXPECT_EQ(shape_of(sewn.mesh).borders, shape_of(whole).borders);
  EXPECT_EQ(shape_of(sewn.mesh).euler, shape_of(whole).euler);
}

TEST(Sew, TellsOfASlitInOnePanelAndOfNoneInANarrowRibbon) {
  // A panel rolled to a tube, whose two ends are 2 mm apart.
  TriangleMesh tube;
  constexpr double kRadius = 0.05, kAngle = 2 * 3.14159265358979 - 0.002 / kRadius;
  add(tube, sheet(1, 0.2, 40, 20), [](const Vec3& p) -> Vec3 {
    const double angle = kAngle * (p.x() - 0.5);
    return {kRadius * std::cos(angle), p.z(), kRadius * std::sin(angle)};
  });
  const OpenSeams open = find_open_seams(tube, 0.005);
  EXPECT_EQ(open.num_seams, 1);
  EXPECT_NEAR(open.gap, 0.002, 1e-4);
  EXPECT_EQ(find_open_seams(sew_borders(tube, 0.003).mesh, 0.005).num_seams, 0);

  for (const double width : {0.001, 0.003}) {
    TriangleMesh ribbon;
    add(ribbon, sheet(0.2, width, 60, 2), moved(0, 0, 0));
    EXPECT_EQ(find_open_seams(ribbon, 0.005).num_seams, 0) << width;
  }
}

// ---- Three and more

TEST(Sew, MeetsWhereThreeAndFourPiecesDo) {
  for (const int wide : {1, 2}) {  // a T: one piece above two; a cross: four
    TriangleMesh mesh;
    if (wide == 1) add(mesh, sheet(0.2012, 0.1, 11, 6), moved(0, 0, -0.1012));
    for (int k = 0; k < 2; ++k) {
      add(mesh, sheet(0.1, 0.1, 6 + k, 7 - 2 * k), moved(0.1012 * k, 0, 0));
      if (wide == 2) add(mesh, sheet(0.1, 0.1, 9 - k, 5 + k), moved(0.1012 * k, 0, -0.1012));
    }
    const SewnMesh sewn = sew_borders(mesh, 0.002);
    expect_sound(mesh, sewn, 0.002);
    EXPECT_EQ(shape_of(sewn.mesh).euler, 1) << wide;
    EXPECT_EQ(shape_of(sewn.mesh).borders, 1) << "no hole where they meet";
    EXPECT_EQ(shape_of(sewn.mesh).pieces, 1);
  }
}

TEST(Sew, SewsATWhateverTheVertexCounts) {
  int holes = 0;
  for (int above = 3; above < 23; ++above) {
    for (int below = 2; below < 12; ++below) {
      TriangleMesh mesh;
      add(mesh, sheet(0.2012, 0.1, above, 6), moved(0, 0, -0.1007));
      add(mesh, sheet(0.1, 0.1, below, 7), moved(0, 0, 0));
      add(mesh, sheet(0.1, 0.1, 13 - below, 5), moved(0.1009, 0, 0.0003));
      const SewnMesh sewn = sew_borders(mesh, 0.002);
      expect_sound(mesh, sewn, 0.002);
      EXPECT_EQ(shape_of(sewn.mesh).pieces, 1);
      holes += shape_of(sewn.mesh).borders - 1;
    }
  }
  EXPECT_EQ(holes, 0);
}

// ---- Layers

TEST(Sew, LeavesALiningApart) {
  // Flat, and rolled with a different mesh of the lining; 1 mm apart, so that borders are above each other.
  for (const double radius : {1e4, 0.1}) {
    TriangleMesh mesh;
    add(mesh, sheet(0.2, 0.2, 10, 20), rolled(radius));
    add(mesh, build_random_mesh({.size_x = 0.2, .size_z = 0.2, .cells_x = 13, .cells_z = 17}, 5),
        [=](const Vec3& p) -> Vec3 { return rolled(radius)(p) * ((radius - 0.001) / radius); });
    for (const double distance : {0.002, 0.005}) {
      EXPECT_EQ(sew_borders(mesh, distance).num_seams, 0) << radius;
      EXPECT_EQ(find_open_seams(mesh, distance).num_seams, 0) << radius;
    }
  }
}

TEST(Sew, SewsShellAndLiningEachForItself) {
  TriangleMesh mesh;
  for (const double y : {0.0, -0.001}) {
    add(mesh, sheet(0.1, 0.1, 5, y < 0 ? 9 : 7), moved(0, y, 0));
    add(mesh, sheet(0.1, 0.1, 5, 8), moved(0.1005, y, 0));
  }
  const SewnMesh sewn = sew_borders(mesh, 0.002);
  expect_sound(mesh, sewn, 0.002);
  EXPECT_EQ(sewn.num_seams, 2);
  EXPECT_EQ(shape_of(sewn.mesh).pieces, 2);
  for (const Vec3& p : sewn.mesh.positions)
    EXPECT_LT(std::min(std::abs(p.y()), std::abs(p.y() + 0.001)), 1e-12);
}

TEST(Sew, ClosesAPillowAndKeepsItsCorners) {
  // Two bulging panels with different meshes: 60° between them at the seam. Corners of both are triangles
  // with two border edges, which must not become duplicate triangles.
  for (const int cells : {12, 17}) {
    TriangleMesh mesh;
    const auto bulged = [](double sign) {
      return [=](const Vec3& p) {
        const double edge = std::min({p.x(), 0.3 - p.x(), p.z(), 0.3 - p.z()});
        return Vec3(p.x(), sign * 0.57735 * edge, p.z());
      };
    };
    add(mesh, sheet(0.3, 0.3, 12, 12), bulged(1));
    add(mesh, sheet(0.3, 0.3, cells, cells), bulged(-1));
    const SewnMesh sewn = sew_borders(mesh, 0.002);
    expect_sound(mesh, sewn, 0.002);
    EXPECT_EQ(shape_of(sewn.mesh).borders, 0);
    EXPECT_EQ(shape_of(sewn.mesh).euler, 2) << "a sphere, " << cells;
  }
}

// ---- Random cuts

/// A sheet cut along random edges. At the cut, edges of the right part and fewer of the left part are divided
/// at random points; then the right part is moved.
struct CutSheet {
  TriangleMesh whole, cut;
  double distance = 0, way = 0;  // [m]

  CutSheet(std::uint64_t seed, double max_distance) {
    constexpr int kCells = 15;
    const Grid grid{.size_x = 0.3, .size_z = 0.3, .cells_x = kCells, .cells_z = kCells};
    Random random(seed);
    const auto roll = [&](int sides) { return static_cast<int>(random.uniform(0, sides)); };
    whole = cut =
        seed % 2 ? build_random_mesh(grid, seed) : build_grid_mesh(grid, GridDiagonals::alternating);
    const int n = whole.num_vertices();
    std::vector<char> is_left(n, 0), is_right(n, 0);
    int column = kCells / 2;
    std::vector<int> columns;
    for (int j = 0; j < kCells; ++j) {
      columns.push_back(column);
      column = std::clamp(column + roll(3) - 1, 3, kCells - 4);
    }
    const auto lies_right = [&](int t) { return t / 2 % kCells >= columns[t / 2 / kCells]; };
    for (int t = 0; t < whole.num_triangles(); ++t) {
      for (const int v : whole.triangles[t]) (lies_right(t) ? is_right : is_left)[v] = 1;
    }
    std::vector<int> right(n);
    for (int v = 0; v < n; ++v) {
      right[v] = is_left[v] && is_right[v] ? cut.num_vertices() : v;
      if (right[v] != v) cut.positions.push_back(whole.positions[v]);
    }
    std::vector<char> moves(cut.positions.size(), 0);
    for (int t = 0; t < whole.num_triangles(); ++t) {
      if (!lies_right(t)) continue;
      for (int& v : cut.triangles[t]) moves[v = right[v]] = 1;
    }
    std::vector<EdgePoint> points;
    for (const Edge& e : build_edges(cut)) {
      const bool at_right = e.a >= n && e.b >= n;
      const bool at_left = e.b < n && is_right[e.a] && is_right[e.b] && !moves[e.a] && !moves[e.b];
      for (int k = roll(at_right ? 4 : 2); e.num_triangles == 1 && (at_right || at_left) && k > 0; --k) {
        const double t = random.uniform(0.05, 0.95);
        points.push_back({e.a, e.b, t, cut.num_vertices()});
        cut.positions.push_back((1 - t) * cut.positions[e.a] + t * cut.positions[e.b]);
        moves.push_back(at_right);
      }
    }
    cut.triangles = divide_edges(make_undivided(cut.triangles), points).triangles;
    distance = random.uniform(0.001, max_distance);
    Vec3 step(random.uniform(0, 1), random.uniform(-1, 1), random.uniform(-1, 1));
    way = random.uniform(0, distance);
    step *= way / step.norm();
    for (int v = 0; v < cut.num_vertices(); ++v) {
      if (moves[v]) cut.positions[v] += step;
    }
  }
};

TEST(Sew, MakesACutSheetWholeAgain) {
  for (std::uint64_t seed = 1; seed <= 300; ++seed) {
    const CutSheet sheet(seed, 0.005);
    ASSERT_EQ(shape_of(sheet.cut).pieces, 2);
    const SewnMesh sewn = sew_borders(sheet.cut, sheet.distance);
    expect_sound(sheet.cut, sewn, sheet.distance);
    const Shape was = shape_of(sheet.whole), is = shape_of(sewn.mesh);
    EXPECT_EQ(is.pieces, 1) << seed;
    EXPECT_EQ(is.borders, 1) << seed;
    EXPECT_EQ(is.euler, was.euler) << seed;
    // The separated sheet additionally has the area of the gap: at most its width along a cut of twice 0.3 m.
    EXPECT_NEAR(is.area, was.area, 0.01 * was.area + 0.6 * sheet.way) << seed;
  }
}

// ---- Attributes

TEST(Sew, SaysWhereTheCornersOfPartsLie) {
  const CutSheet sheet(7, 0.005);
  const SewnMesh sewn = sew_borders(sheet.cut, sheet.distance);
  ASSERT_EQ(sewn.corner_weights.size(), sewn.mesh.triangles.size());
  for (int t = 0; t < sewn.mesh.num_triangles(); ++t) {
    const auto& [a, b, c] = sheet.cut.triangles[sewn.source_triangle[t]];
    for (int k = 0; k < 3; ++k) {
      const Vec3& w = sewn.corner_weights[t][k];
      EXPECT_NEAR(w.sum(), 1, 1e-12);
      const Vec3 p =
          w[0] * sheet.cut.positions[a] + w[1] * sheet.cut.positions[b] + w[2] * sheet.cut.positions[c];
      EXPECT_LE((p - sewn.mesh.positions[sewn.mesh.triangles[t][k]]).norm(), sheet.distance * (1 + 1e-8));
    }
  }
}

TEST(Sew, KeepsTextureCoordinatesOfParts) {
  const CornerUv uv = {Eigen::Vector2d(0, 0), Eigen::Vector2d(1, 0),
                       Eigen::Vector2d::Constant(std::numeric_limits<double>::quiet_NaN())};
  const CornerUv part = interpolate(uv, {Vec3(1, 0, 0), Vec3(0.25, 0.75, 0), Vec3(0, 0, 1)});
  EXPECT_EQ(part[0], uv[0]);
  EXPECT_EQ(part[1], Eigen::Vector2d(0.75, 0));
  EXPECT_TRUE(std::isnan(part[2].x()));
}

TEST(CleanMesh, TellsWhatWasSewnAndWhatStaysOpen) {
  TriangleMesh mesh;
  add(mesh, sheet(0.1, 0.1, 4, 7), moved(0, 0, 0));
  add(mesh, sheet(0.1, 0.1, 4, 10), moved(0.1018, 0, 0));
  const CleanMesh open = clean_mesh(mesh, {.sew_distance = 0.001});
  EXPECT_EQ(open.warnings,
            std::vector<std::string>{"2 borders are 1.8 mm apart: sew = 0.002 would join them"});
  const CleanMesh sewn = clean_mesh(mesh, {.sew_distance = 0.002});
  EXPECT_TRUE(sewn.warnings.empty());
  ASSERT_EQ(sewn.notes.size(), 1u);
  EXPECT_TRUE(sewn.notes[0].starts_with("sewed 1 seam: 19 vertices, ")) << sewn.notes[0];
  EXPECT_EQ(sewn.vertex_of_source.size(), mesh.positions.size());
  EXPECT_TRUE(clean_mesh(mesh, {.is_cloth = false}).warnings.empty()) << "a collider has no seams";
}

}  // namespace
}  // namespace weft::engine
