#include "weft/verify/crossings.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "weft/core/random.h"
#include "weft/mesh/grid.h"

namespace weft::engine::verify {
namespace {

// ---- Slow exact reference in integers ----

__extension__ typedef __int128 Integer;
using Point = std::array<std::int64_t, 3>;
using IntegerCorners = std::array<Point, 3>;

Point minus(const Point& a, const Point& b) { return {a[0] - b[0], a[1] - b[1], a[2] - b[2]}; }

Point cross(const Point& a, const Point& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

std::int64_t dot(const Point& a, const Point& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

Point normal(const IntegerCorners& t) { return cross(minus(t[1], t[0]), minus(t[2], t[0])); }

struct Fraction {
  Integer numerator, denominator;  // > 0

  bool operator<(const Fraction& other) const {
    return numerator * other.denominator < other.numerator * denominator;
  }
};

/// Intersection of a triangle's interior with a plane, as an interval along `direction`; empty if it is on
/// one side.
std::optional<std::pair<Fraction, Fraction>> cut(const IntegerCorners& t, const IntegerCorners& plane,
                                                 const Point& direction) {
  std::array<std::int64_t, 3> height;
  for (int k = 0; k < 3; ++k) height[k] = dot(normal(plane), minus(t[k], plane[0]));
  if (!(std::ranges::max(height) > 0 && std::ranges::min(height) < 0)) return {};
  std::vector<Fraction> ends;
  for (int k = 0; k < 3; ++k) {
    const int l = (k + 1) % 3;
    if (height[k] == 0) ends.push_back({dot(direction, t[k]), 1});
    if (!((height[k] > 0 && height[l] < 0) || (height[k] < 0 && height[l] > 0))) continue;
    const Integer sign = height[l] > height[k] ? 1 : -1;
    ends.push_back({sign * (static_cast<Integer>(dot(direction, t[k])) * height[l] -
                            static_cast<Integer>(dot(direction, t[l])) * height[k]),
                    sign * (height[l] - height[k])});
  }
  return std::pair(*std::min_element(ends.begin(), ends.end()), *std::max_element(ends.begin(), ends.end()));
}

bool insides_cross_in_integers(const IntegerCorners& a, const IntegerCorners& b) {
  const Point direction = cross(normal(a), normal(b));
  const auto cut_a = cut(a, b, direction), cut_b = cut(b, a, direction);
  if (!cut_a || !cut_b) return false;
  return std::max(cut_a->first, cut_b->first) < std::min(cut_a->second, cut_b->second);
}

// ---- Surfaces ----

Vec3 to_vec(const Point& p) {
  return {static_cast<double>(p[0]), static_cast<double>(p[1]), static_cast<double>(p[2])};
}

Corners to_corners(const IntegerCorners& t) { return {to_vec(t[0]), to_vec(t[1]), to_vec(t[2])}; }

Point random_point(Random& random, int reach) {
  Point p;
  for (auto& coordinate : p) {
    coordinate = static_cast<std::int64_t>(random.next() % static_cast<std::uint64_t>(2 * reach + 1)) - reach;
  }
  return p;
}

Vec3 random_vector(Random& random, double size) {
  return {random.uniform(-size, size), random.uniform(-size, size), random.uniform(-size, size)};
}

SurfaceView view(const TriangleMesh& mesh, bool is_cloth = true) {
  return {mesh.positions, mesh.triangles, is_cloth};
}

std::vector<Crossing> crossings(const TriangleMesh& a, const TriangleMesh& b) {
  const SurfaceView views[] = {view(a), view(b)};
  return find_crossings(views);
}

std::vector<Crossing> crossings(const TriangleMesh& a) {
  const SurfaceView views[] = {view(a)};
  return find_crossings(views);
}

TriangleMesh sheet(int cells, GridDiagonals diagonals = GridDiagonals::alternating) {
  return build_grid_mesh({.size_x = 1, .size_z = 1, .cells_x = cells, .cells_z = cells}, diagonals);
}

template <class Map>
TriangleMesh mapped(TriangleMesh mesh, Map map) {
  for (Vec3& p : mesh.positions) p = map(p);
  return mesh;
}

TriangleMesh moved(const TriangleMesh& mesh, const Vec3& by) {
  return mapped(mesh, [&](const Vec3& p) { return Vec3(p + by); });
}

/// The sheet x, z in [0, 1] turned upright: x in [0, 1], y in [-1/2, 1/2], z = 1/2.
TriangleMesh upright(const TriangleMesh& mesh) {
  return mapped(mesh, [](const Vec3& p) { return Vec3(p.x(), p.z() - 0.5, 0.5); });
}

/// n triangles of about the given size, without common vertices.
TriangleMesh soup(int n, double size, std::uint64_t seed) {
  Random random(seed);
  TriangleMesh mesh;
  for (int t = 0; t < n; ++t) {
    const Vec3 center = random_vector(random, 1);
    for (int k = 0; k < 3; ++k) mesh.positions.push_back(center + random_vector(random, size));
    mesh.triangles.push_back({3 * t, 3 * t + 1, 3 * t + 2});
  }
  return mesh;
}

Corners corners(const TriangleMesh& mesh, int t) {
  const auto& [a, b, c] = mesh.triangles[t];
  return {mesh.positions[a], mesh.positions[b], mesh.positions[c]};
}

// ---- Two triangles ----

TEST(InsidesCross, AgreesWithIntegersOnDegenerateTriangles) {
  Random random(1);
  int num_crossing = 0;
  for (int i = 0; i < 1000000; ++i) {
    const int reach = 1 + i % 3;
    IntegerCorners a, b;
    for (Point& p : a) p = random_point(random, reach);
    for (Point& p : b) p = random_point(random, reach);
    if (i % 4 == 0) b[i / 4 % 3] = a[i / 12 % 3];  // a shared vertex
    const bool expected = insides_cross_in_integers(a, b);
    num_crossing += expected;
    ASSERT_EQ(insides_cross(to_corners(a), to_corners(b)), expected) << i;
    ASSERT_EQ(insides_cross(to_corners(b), to_corners(a)), expected) << i;
    ASSERT_EQ(insides_cross(to_corners({a[2], a[1], a[0]}), to_corners({b[1], b[2], b[0]})), expected) << i;
  }
  EXPECT_GT(num_crossing, 50000);
}

TEST(InsidesCross, NotWithASharedEdgeNorInOnePlane) {
  Random random(2);
  for (int i = 0; i < 100000; ++i) {
    const Vec3 a = random_vector(random, 1), b = random_vector(random, 1), c = random_vector(random, 1);
    EXPECT_FALSE(insides_cross({a, b, c}, {b, a, random_vector(random, 1)}));
    EXPECT_FALSE(insides_cross({a, b, c}, {a, b, c}));
  }
}

TEST(InsidesCross, WithASharedVertexIfTheLineFromItRunsThroughBoth) {
  const Vec3 tip(0, 0, 0);
  const Corners flat = {tip, {-1, 0, 1}, {1, 0, 1}};
  EXPECT_TRUE(insides_cross(flat, {tip, {0, -1, 1}, {0, 1, 1}}));
  EXPECT_TRUE(insides_cross(flat, {tip, {0, -1, 9}, {0, 1, 9}}))
      << "also where the opposite edge passes beyond";
  EXPECT_FALSE(insides_cross(flat, {tip, {0, -1, -1}, {0, 1, -1}})) << "from the tip the other way";
  EXPECT_FALSE(insides_cross(flat, {tip, {0, 0, 1}, {0, 1, 1}})) << "an edge lies on it";
  EXPECT_FALSE(insides_cross(flat, {tip, {-1, -1, 1}, {-1, 1, 1}})) << "edges lie on each other";
}

// ---- Surfaces that cross ----

TEST(FindCrossings, AreThoseOfAllPairs) {
  for (const std::uint64_t seed : {1, 2, 3}) {
    const TriangleMesh cloth = soup(400, 0.15, seed), other = soup(200, 0.3, seed + 10),
                       body = soup(50, 0.8, seed + 20);
    const SurfaceView views[] = {view(body, false), view(cloth), view(other), view(body, false)};
    const TriangleMesh* meshes[] = {&body, &cloth, &other, &body};
    std::vector<Crossing> expected;
    for (int s = 0; s < 4; ++s) {
      for (int r = 0; r < 4; ++r) {
        for (int t = 0; t < meshes[s]->num_triangles(); ++t) {
          for (int u = 0; u < meshes[r]->num_triangles(); ++u) {
            const TriangleId a{s, t}, b{r, u};
            if (!views[s].is_cloth || (views[r].is_cloth && !(a < b))) continue;
            if (insides_cross(corners(*meshes[s], t), corners(*meshes[r], u))) expected.push_back({a, b});
          }
        }
      }
    }
    std::sort(expected.begin(), expected.end());
    EXPECT_GT(expected.size(), 500u);
    EXPECT_EQ(find_crossings(views), expected);
  }
}

TEST(FindCrossings, NotOfCollidersAmongThemselves) {
  const TriangleMesh a = sheet(4), b = upright(sheet(4));
  const SurfaceView views[] = {view(a, false), view(b, false)};
  EXPECT_TRUE(find_crossings(views).empty());
  const SurfaceView with_cloth[] = {view(a, false), view(b, true)};
  ASSERT_FALSE(find_crossings(with_cloth).empty());
  EXPECT_EQ(find_crossings(with_cloth)[0].a.surface, 1) << "the cloth is named first";
}

TEST(FindCrossings, FindEveryPlantedOne) {
  // A needle through each single triangle of a sheet, at any point.
  const TriangleMesh cloth = sheet(12);
  Random random(3);
  for (int t = 0; t < cloth.num_triangles(); ++t) {
    const Corners c = corners(cloth, t);
    const double u = random.uniform(0.01, 0.98), v = random.uniform(0.01, 0.99 - u);
    const Vec3 at = c[0] + u * (c[1] - c[0]) + v * (c[2] - c[0]);
    const TriangleMesh needle = {
        {at + Vec3(0, 1e-6, 0), at + Vec3(1e-7, -1e-6, 0), at + Vec3(0, -1e-6, 1e-7)}, {{0, 1, 2}}};
    const auto found = crossings(cloth, needle);
    ASSERT_FALSE(found.empty()) << t;
    EXPECT_EQ(found[0], (Crossing{{0, t}, {1, 0}}));
  }
}

TEST(FindCrossings, SeeSheetsThatCrossWhereverTheirVerticesLie) {
  // The intersection line runs through interiors, along edges of one or of both, and through vertices.
  for (const int cells : {3, 4, 7, 8}) {
    for (const auto diagonals : {GridDiagonals::parallel, GridDiagonals::alternating}) {
      const TriangleMesh a = sheet(cells, diagonals);
      for (const int other_cells : {3, 4, 6, 8}) {
        const TriangleMesh b = upright(sheet(other_cells, diagonals));
        for (const double shift : {0.0, 0.125, 0.01, -0.25}) {
          EXPECT_GE(static_cast<int>(crossings(a, moved(b, {shift, 0, 0})).size()),
                    std::min(cells, other_cells) - 2)
              << cells << " " << other_cells << " " << shift;
          EXPECT_FALSE(crossings(a, moved(b, {0, shift, shift})).empty())
              << cells << " " << other_cells << " " << shift;
        }
      }
    }
  }
}

TEST(FindCrossings, OnSheetsThatTouchAndTurnBackAreNone) {
  // A fold whose crease is exactly on a sheet: along its edges, across them, from above and from below.
  for (const int cells : {1, 2, 3, 4}) {
    const TriangleMesh flat = sheet(4);
    for (const double side : {-1.0, 1.0}) {
      for (const double across : {0.5, 0.3}) {
        const TriangleMesh fold = mapped(sheet(2 * cells), [&](const Vec3& p) {
          return Vec3(p.x(), side * std::abs(p.z() - 0.5), across + 0.3 * (p.z() - 0.5));
        });
        EXPECT_TRUE(crossings(flat, fold).empty());
        const TriangleMesh through = mapped(sheet(2 * cells), [&](const Vec3& p) {
          return Vec3(p.x(), side * (p.z() - 0.5), across + 0.3 * std::abs(p.z() - 0.5));
        });
        EXPECT_FALSE(crossings(flat, through).empty());
      }
    }
  }
}

/// Whether a triangle of each are coplanar, or one is degenerate.
bool have_triangles_in_one_plane(const TriangleMesh& a, const TriangleMesh& b) {
  const auto is_on = [](const Corners& plane, const Corners& t) {
    const Vec3 n = (plane[1] - plane[0]).cross(plane[2] - plane[0]);
    return std::ranges::all_of(t, [&](const Vec3& p) { return n.dot(p - plane[0]) == 0; });
  };
  for (int t = 0; t < a.num_triangles(); ++t) {
    for (int u = 0; u < b.num_triangles(); ++u) {
      if (is_on(corners(a, t), corners(b, u)) || is_on(corners(b, u), corners(a, t))) return true;
    }
  }
  return false;
}

TEST(FindCrossings, AreWhatNoSmallMovementOfTheVerticesUndoes) {
  // Two strips with small integer corners, so that every degeneracy occurs. Where they are reported to cross,
  // small movements of the corners cannot separate them. The moved corners are in no other's plane, so only
  // interiors count. Where they are reported to touch, one of some hundred small movements separates them.
  Random random(4);
  int num_crossing = 0, num_touching = 0;
  for (int i = 0; i < 20000; ++i) {
    TriangleMesh a{{}, {{0, 1, 2}, {2, 1, 3}}}, b = a;
    for (int k = 0; k < 4; ++k) {
      a.positions.push_back(to_vec(random_point(random, 2)));
      b.positions.push_back(to_vec(random_point(random, 2)));
    }
    const auto shaken = [&](const TriangleMesh& mesh, double noise) {
      return mapped(mesh, [&](const Vec3& p) { return Vec3(p + random_vector(random, noise)); });
    };
    if (!crossings(a, b).empty()) {
      ++num_crossing;
      for (int k = 0; k < 10; ++k) ASSERT_FALSE(crossings(shaken(a, 1e-4), shaken(b, 1e-4)).empty()) << i;
    } else if (!have_triangles_in_one_plane(a, b)) {
      ++num_touching;
      bool is_parted = false;
      for (int k = 0; k < 500 && !is_parted; ++k) {
        const TriangleMesh other = moved(shaken(b, 1e-4), random_vector(random, 1e-4));
        is_parted = crossings(shaken(a, k % 3 * 1e-4), other).empty();
      }
      ASSERT_TRUE(is_parted) << i;
    }
  }
  EXPECT_GT(num_crossing, 2000);
  EXPECT_GT(num_touching, 2000);
}

TEST(FindCrossings, CountPairsAlongACut) {
  // Each of the four columns of cells is cut once across, through both of its triangles; twice 4 + 4 − 1
  // pairs if neither mesh has a vertex on the cut.
  const TriangleMesh a = sheet(4, GridDiagonals::parallel);
  const auto found = crossings(a, moved(upright(sheet(1, GridDiagonals::parallel)), {0, 0.3, 0.1}));
  EXPECT_GE(found.size(), 8u);
  EXPECT_LE(found.size(), 9u) << "the other sheet's one diagonal adds a pair";
}

TEST(FindCrossings, OfClothWithItself) {
  // A strip bent so that its end passes through its middle.
  const TriangleMesh strip =
      build_grid_mesh({.size_x = 1, .size_z = 0.2, .cells_x = 40, .cells_z = 4}, GridDiagonals::alternating);
  const auto bend = [&](double turns) {
    return crossings(mapped(strip, [&](const Vec3& p) {
      const double angle = 2 * 3.14159265 * turns * p.x();
      return Vec3(0.2 * std::sin(angle), 0.2 * std::cos(angle) + 0.1 * p.x(), p.z() + 0.01 * p.x());
    }));
  };
  EXPECT_TRUE(bend(0.9).empty());
  const TriangleMesh loop = mapped(strip, [](const Vec3& p) {  // a loop crosses itself at its neck
    const double s = 4 * (p.x() - 0.5);
    return Vec3(s * s * s - s, s * s, p.z());
  });
  EXPECT_GE(crossings(loop).size(), 4u);
}

// ---- Surfaces that do not ----

TEST(FindCrossings, AreNoneWhereThereIsNone) {
  for (const auto diagonals : {GridDiagonals::parallel, GridDiagonals::alternating}) {
    const TriangleMesh flat = sheet(16, diagonals);
    EXPECT_TRUE(crossings(flat).empty()) << "flat";
    EXPECT_TRUE(crossings(flat, flat).empty()) << "twice in the same place";
    EXPECT_TRUE(crossings(flat, moved(flat, {0.03, 0, 0.0171})).empty()) << "overlapping in one plane";
    EXPECT_TRUE(crossings(flat, moved(sheet(13), {0.03, 1e-12, 0.0171})).empty()) << "a hair apart";
    const auto folded = [&](double crease) {
      return crossings(mapped(flat, [&](const Vec3& p) { return Vec3(std::abs(p.x() - crease), 0, p.z()); }));
    };
    EXPECT_TRUE(folded(0.5).empty()) << "folded flat along edges";
    EXPECT_TRUE(folded(0.47).empty()) << "folded flat through cells";
    const TriangleMesh diagonal = mapped(flat, [](const Vec3& p) { return Vec3(p.x(), p.x(), p.z()); });
    EXPECT_TRUE(crossings(diagonal, moved(diagonal, {0.25, 0.25, 0.1})).empty())
        << "in a plane that is not level";
    EXPECT_TRUE(crossings(flat, moved(upright(flat), {0, 0.5, 0})).empty())
        << "standing on it, edge on edges";
    EXPECT_TRUE(crossings(flat, moved(upright(flat), {0.013, 0.5, 0.02})).empty()) << "standing on it";
    EXPECT_TRUE(crossings(flat, moved(flat, {1, 0, 0})).empty()) << "edge to edge";
  }
}

TEST(FindCrossings, AreNoneInSmoothAndCrumpledSurfacesWithoutOverhang) {
  // Height fields over a plane: the surface cannot intersect itself, nor its copy a millimetre above.
  Random random(5);
  for (const double height : {1e-9, 1e-3, 0.3}) {
    const TriangleMesh rough =
        mapped(sheet(40), [&](const Vec3& p) { return Vec3(p.x(), height * random.uniform(-1, 1), p.z()); });
    EXPECT_TRUE(crossings(rough).empty());
    EXPECT_TRUE(crossings(rough, moved(rough, {0, 0.001, 0})).empty());
  }
}

TEST(FindCrossings, IgnoreTrianglesWithoutArea) {
  const TriangleMesh collapsed = mapped(sheet(5), [](const Vec3& p) { return Vec3(p.x(), 0, 0); });
  EXPECT_TRUE(crossings(collapsed).empty());
  EXPECT_TRUE(crossings(collapsed, upright(sheet(4))).empty());
}

}  // namespace
}  // namespace weft::engine::verify
