#include "weft/verify/passages.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "weft/core/random.h"
#include "weft/mesh/grid.h"
#include "weft/verify/pair_motion.h"

namespace weft::engine::verify {
namespace {

using Kind = FeaturePair::Kind;

Vec3 random_vector(Random& random, double size) {
  return {random.uniform(-size, size), random.uniform(-size, size), random.uniform(-size, size)};
}

Mat3 random_rotation(Random& random) {
  const Eigen::Vector4d q(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1), 1);
  return Eigen::Quaterniond(q.normalized()).toRotationMatrix();
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

/// A cloth of one triangle, far smaller than a sheet's, with its first corner at p.
TriangleMesh needle(const Vec3& p) { return {{p, p + Vec3(1e-3, 1, 0), p + Vec3(0, 1, 1e-3)}, {{0, 1, 2}}}; }

NamedCloth cloth(const std::string& name, const TriangleMesh& mesh) {
  return {name, mesh.positions, mesh.triangles};
}

NamedCollider body(const std::string& name, const TriangleMesh& mesh) {
  return {name, MeshView{mesh.positions, mesh.triangles, mesh.triangles}};
}

/// Passages from each frame to the next: meshes as cloths, in their order.
std::vector<std::vector<FeaturePair>> passages(const std::vector<std::vector<TriangleMesh>>& moments) {
  const auto frame_of = [](const std::vector<TriangleMesh>& meshes) {
    Frame frame;
    for (const TriangleMesh& mesh : meshes) frame.cloths.push_back(cloth("cloth", mesh));
    return frame;
  };
  PassageWatch watch(frame_of(moments[0]));
  std::vector<std::vector<FeaturePair>> found;
  for (std::size_t k = 1; k < moments.size(); ++k) found.push_back(watch.advance(frame_of(moments[k])));
  return found;
}

std::vector<FeaturePair> passages(const std::vector<TriangleMesh>& start,
                                  const std::vector<TriangleMesh>& end) {
  return passages(std::vector{start, end})[0];
}

/// Single particles and a collider.
class Particles {
 public:
  Particles(std::vector<Vec3> at, const Solid& solid, std::optional<Mat3> rotation = {})
      : positions_(std::move(at)), watch_(frame(solid, rotation)) {}

  int num_passages(std::vector<Vec3> to, const Solid& solid, std::optional<Mat3> rotation = {}) {
    positions_ = std::move(to);
    const std::vector<FeaturePair> found = watch_.advance(frame(solid, rotation));
    EXPECT_TRUE(
        std::ranges::all_of(found, [](const FeaturePair& p) { return p.kind == Kind::particle_shape; }));
    return static_cast<int>(found.size());
  }

 private:
  Frame frame(const Solid& solid, const std::optional<Mat3>& rotation) const {
    return {{{"dust", positions_, {}}}, {{"solid", solid, rotation}}};
  }

  std::vector<Vec3> positions_;
  PassageWatch watch_;
};

int num_passages(const Vec3& from, const Vec3& to, const Solid& before, const Solid& after) {
  return Particles({from}, before).num_passages({to}, after);
}

bool contains(const std::vector<FeaturePair>& pairs, const FeaturePair& pair) {
  return std::ranges::find(pairs, pair) != pairs.end();
}

// ---- Planted passages ----

TEST(Passages, OfAParticleThroughAnyTriangleAreFound) {
  Random random(1);
  const TriangleMesh flat = sheet(10);
  for (int i = 0; i < 300; ++i) {
    const int t = static_cast<int>(random.next() % flat.triangles.size());
    const auto& [a, b, c] = flat.triangles[t];
    const double u = random.uniform(0.01, 0.98), v = random.uniform(0.01, 0.99 - u);
    const Vec3 at = flat.positions[a] + u * (flat.positions[b] - flat.positions[a]) +
                    v * (flat.positions[c] - flat.positions[a]);
    const Mat3 turn = random_rotation(random);  // a rotation of everything, and a common motion
    const Vec3 travel = random_vector(random, 10);
    const double depth = random.uniform(1e-6, 0.5);
    const auto place = [&](const TriangleMesh& mesh, const Vec3& by) {
      return mapped(mesh, [&](const Vec3& p) { return Vec3(turn * p + by); });
    };
    const TriangleMesh above = needle(at + Vec3(0, 1e-6, 0)), below = needle(at - Vec3(0, depth, 0));
    const auto found = passages({place(flat, Vec3::Zero()), place(above, Vec3::Zero())},
                                {place(flat, travel), place(below, travel)});
    ASSERT_TRUE(contains(found, {Kind::vertex_triangle, 1, 0, {0, 0}, {t, t}})) << i;
  }
}

TEST(Passages, OfAHemOverAHemAreFound) {
  Random random(2);
  for (int i = 0; i < 300; ++i) {
    // Two adjacent triangles, so that only one edge of each can meet.
    const Mat3 turn = random_rotation(random);
    const Vec3 travel = random_vector(random, 3);
    const double lean = random.uniform(-0.5, 0.5), low = random.uniform(-0.4, -1e-6),
                 high = random.uniform(1e-6, 0.4);
    const TriangleMesh left{{{0, 0, -1}, {0, 0, 1}, {-1, 0, 0}}, {{0, 1, 2}}};
    const auto right = [&](double height) {
      return TriangleMesh{{{-0.1, height, -lean - 0.3}, {0.4, height, lean}, {1, height, 5}}, {{2, 0, 1}}};
    };
    const auto place = [&](const TriangleMesh& mesh, const Vec3& by) {
      return mapped(mesh, [&](const Vec3& p) { return Vec3(turn * p + by); });
    };
    const auto found = passages({place(left, Vec3::Zero()), place(right(high), Vec3::Zero())},
                                {place(left, travel), place(right(low), travel)});
    ASSERT_TRUE(contains(found, {Kind::edge_edge, 0, 1, {0, 1}, {0, 1}})) << i;
  }
}

TEST(Passages, OfWholeSheetsAreFoundThoughTheyCrossAtNoMoment) {
  Random random(3);
  for (int i = 0; i < 200; ++i) {
    const TriangleMesh low = sheet(4), high = moved(sheet(5), {0.1, random.uniform(0.001, 0.2), 0.03});
    const TriangleMesh beyond = moved(high, {random.uniform(-0.2, 0.2), -0.3, random.uniform(-0.2, 0.2)});
    const Mat3 turn = random_rotation(random);
    const auto placed = [&](const TriangleMesh& mesh) {
      return mapped(mesh, [&](const Vec3& p) { return Vec3(turn * p); });
    };
    const TriangleMesh a = placed(low), b = placed(high), c = placed(beyond);
    for (const TriangleMesh& other : {b, c}) {
      const SurfaceView views[] = {{a.positions, a.triangles}, {other.positions, other.triangles}};
      ASSERT_TRUE(find_crossings(views).empty());
    }
    EXPECT_GT(passages({a, b}, {a, c}).size(), 10u) << i;
    EXPECT_TRUE(passages({a, b}, {a, b}).empty());
  }
}

TEST(Passages, OfParticlesThroughPlainShapesAreFoundIfDeepEnough) {
  Random random(4);
  int num_shallow = 0, num_deep = 0;
  for (int i = 0; i < 1000; ++i) {
    // A straight path past the centre at a given distance, whose deepest point is known.
    const Vec3 middle = random_vector(random, 1), travel = random_vector(random, 0.3);
    const Mat3 turn = random_rotation(random);
    const double size = random.uniform(0.01, 0.5), depth = random.uniform(-2e-4, 4e-4);
    const double away = size - depth, reach = 4;
    Solid before, after;
    Vec3 from, to;
    if (i % 3 == 0) {
      before = Sphere{middle, size};
      after = Sphere{middle + travel, size};
      from = middle + turn * Vec3(reach, away, 0);
      to = middle + travel + turn * Vec3(-reach, away, 0);
    } else if (i % 3 == 1) {
      const auto capsule = [&](const Vec3& at) {
        return Capsule{at + turn * Vec3(0, 0, -0.3), at + turn * Vec3(0, 0, 0.3), size};
      };
      before = capsule(middle);
      after = capsule(middle + travel);
      from = middle + turn * Vec3(reach, away, 0.1);
      to = middle + travel + turn * Vec3(-reach, away, 0.1);
    } else {  // along a face, and the box also rotates
      const Mat3 turn_after = turn * Eigen::AngleAxisd(random.uniform(-0.3, 0.3), Vec3::UnitZ());
      const Vec3 half(0.7, size, 0.6);
      before = OrientedBox{middle, half, turn};
      after = OrientedBox{middle + travel, half, turn_after};
      from = middle + turn * Vec3(reach, away, 0.1);
      to = middle + travel + turn_after * Vec3(-reach, away, 0.1);
    }
    if (std::abs(depth - 1e-4) < 1e-9) continue;
    const bool is_deep = depth > 1e-4;
    ++(is_deep ? num_deep : num_shallow);
    ASSERT_EQ(num_passages(from, to, before, after), is_deep ? 1 : 0) << i;
    ASSERT_EQ(num_passages(from, from + travel, before, before), 0) << i;
  }
  EXPECT_GT(num_deep, 300);
  EXPECT_GT(num_shallow, 300);
}

TEST(Passages, OfShapesSmallerThanATriangleAreFound) {
  const TriangleMesh flat = sheet(2);
  const auto found = [&](const Solid& before, const Solid& after) {
    PassageWatch watch({{cloth("sheet", flat)}, {{"bullet", before}}});
    return watch.advance({{cloth("sheet", flat)}, {{"bullet", after}}}).size();
  };
  const Vec3 above(0.3, 0.5, 0.2), below(0.32, -0.4, 0.22);
  EXPECT_EQ(found(Sphere{above, 0.01}, Sphere{below, 0.01}), 1u);
  EXPECT_EQ(found(Sphere{above, 0.01}, Sphere{above, 0.01}), 0u);
  const Vec3 along(0.01, 0.02, 0);
  EXPECT_EQ(found(Capsule{above, above + along, 0.01}, Capsule{below, below + along, 0.01}), 2u)
      << "both ends";
  EXPECT_GE(found(OrientedBox{above, {0.01, 0.02, 0.01}}, OrientedBox{below, {0.01, 0.02, 0.01}}), 8u);
  EXPECT_EQ(found(OrientedBox{above, {0.01, 0.49995, 0.01}}, OrientedBox{above, {0.01, 0.50005, 0.01}}), 0u)
      << "no deeper than the tolerance";
}

TEST(Passages, AreFoundAfterALongWayThroughNothing) {
  const TriangleMesh flat = sheet(4);
  std::vector<std::vector<TriangleMesh>> moments;
  for (int k = 0; k < 140; ++k) moments.push_back({flat, needle({0.3, 1.005 - 0.01 * k, 0.4})});
  const auto found = passages(moments);
  for (std::size_t k = 0; k < found.size(); ++k) EXPECT_EQ(found[k].size(), k == 100 ? 1u : 0u) << k;
}

// ---- No passages ----

/// n triangles without common vertices.
TriangleMesh soup(int n, double size, Random& random) {
  TriangleMesh mesh;
  for (int t = 0; t < n; ++t) {
    const Vec3 center = random_vector(random, 1);
    for (int k = 0; k < 3; ++k) mesh.positions.push_back(center + random_vector(random, size));
    mesh.triangles.push_back({3 * t, 3 * t + 1, 3 * t + 2});
  }
  return mesh;
}

std::vector<std::array<int, 2>> edges_of(const TriangleMesh& mesh) {
  std::vector<std::array<int, 2>> edges;
  for (const Edge& edge : build_edges(mesh)) edges.push_back({edge.a, edge.b});
  return edges;
}

/// Every vertex with every triangle, every edge with every other edge.
std::vector<FeaturePair> all_passages(const std::vector<TriangleMesh>& start,
                                      const std::vector<TriangleMesh>& end, int num_cloths) {
  std::vector<FeaturePair> found;
  const auto motion = [&](int s, int v) { return PointMotion{start[s].positions[v], end[s].positions[v]}; };
  const int num_meshes = static_cast<int>(start.size());
  for (int s = 0; s < num_meshes; ++s) {
    for (int r = 0; r < num_meshes; ++r) {
      if (s >= num_cloths && r >= num_cloths) continue;
      for (int t = 0; t < start[r].num_triangles(); ++t) {
        const auto& [a, b, c] = start[r].triangles[t];
        for (int v = 0; v < start[s].num_vertices(); ++v) {
          if (s == r && (v == a || v == b || v == c)) continue;
          if (test_vertex_triangle(motion(s, v), {motion(r, a), motion(r, b), motion(r, c)}).passes)
            found.push_back({Kind::vertex_triangle, s, r, {v, v}, {t, t}});
        }
      }
      if (r < s) continue;
      for (const auto& e : edges_of(start[s])) {
        for (const auto& f : edges_of(start[r])) {
          if (s == r && (f <= e || e[0] == f[0] || e[0] == f[1] || e[1] == f[0] || e[1] == f[1])) continue;
          if (test_edge_edge({motion(s, e[0]), motion(s, e[1])}, {motion(r, f[0]), motion(r, f[1])}).passes)
            found.push_back({Kind::edge_edge, s, r, e, f});
        }
      }
    }
  }
  std::sort(found.begin(), found.end());
  return found;
}

TEST(Passages, AreThoseOfAllPairs) {
  // Small steps, for which pairs are listed, and long ones, for which they are not; flying cloth, a body at
  // rest, far pairs and near ones.
  for (const double way : {0.002, 0.02, 0.3}) {
    Random random(5);
    std::vector<TriangleMesh> now = {soup(40, 0.15, random), sheet(5), soup(20, 0.3, random)};
    const auto frame_of = [](const std::vector<TriangleMesh>& meshes) {
      return Frame{{cloth("soup", meshes[0]), cloth("sheet", meshes[1])}, {body("body", meshes[2])}};
    };
    PassageWatch watch(frame_of(now));
    std::size_t num_found = 0;
    for (int step = 0; step < 25; ++step) {
      std::vector<TriangleMesh> next = now;
      const Vec3 flight = 3 * random_vector(random, way);
      for (int s = 0; s < 2; ++s) {
        for (Vec3& p : next[s].positions) p += (s == 0 ? flight : -flight) + random_vector(random, way);
      }
      if (step % 10 > 6) next[2] = moved(now[2], random_vector(random, way));
      const auto expected = all_passages(now, next, 2), found = watch.advance(frame_of(next));
      ASSERT_EQ(found, expected) << way << " " << step;
      num_found += found.size();
      now = next;
    }
    EXPECT_GT(num_found, 20u) << way;
  }
}

TEST(Passages, AreNoneInWildMotionOfASheetThatStaysAGraph) {
  // Height fields over a plane with arbitrary changes, and sheets that stay above each other: nothing can
  // pass.
  Random random(6);
  std::vector<std::vector<TriangleMesh>> moments;
  for (int step = 0; step < 20; ++step) {
    const Vec3 travel = random_vector(random, 2);
    std::vector<TriangleMesh> layers;
    for (int layer = 0; layer < 3; ++layer) {
      layers.push_back(mapped(sheet(12), [&](const Vec3& p) {
        return Vec3(travel + p + Vec3(0, layer + random.uniform(0, 0.999), 0));
      }));
    }
    moments.push_back(layers);
  }
  for (const auto& found : passages(moments)) EXPECT_TRUE(found.empty());
}

TEST(Passages, AreNoneWhereAParticleGrazesOrComesBack) {
  const TriangleMesh flat = sheet(3);
  // The particle dips through because the sheet waves as it flies past: in and out again, within one motion.
  // The triangle rotates about an axis, and linear motion makes it shrink through the particle and back.
  const TriangleMesh left{{{-1, 0, -1}, {-1, 0, 1}, {-3, 0, 0}}, {{0, 1, 2}}};
  EXPECT_TRUE(passages({left, needle({-1.5, 0.2, 0})}, {left, needle({5, 0.1, 0})}).empty());
  EXPECT_TRUE(passages({flat, needle({-0.5, 1e-9, 0.4})}, {flat, needle({1.5, 1e-9, 0.45})}).empty());
  const auto along = passages({flat, needle({-0.5, 0, 0.4})}, {flat, needle({1.5, 0, 0.45})});
  EXPECT_EQ(along.size() % 2, 0u) << "exactly in its plane: over it, or in at one hem and out at another";
  const TriangleMesh on_edge = needle({0.5, 0, 0.5});
  EXPECT_TRUE(passages({flat, on_edge}, {flat, on_edge}).empty()) << "lies on it, exactly";
}

TEST(Passages, InAPlaneAreNone) {
  const TriangleMesh flat = sheet(4), other = moved(sheet(4), {2, 0, 0.125});  // exact also where tilted
  EXPECT_TRUE(passages({flat, other}, {flat, moved(other, {-3.7, 0, 0.05})}).empty());
  const auto tilted = [](const TriangleMesh& mesh) {
    return mapped(mesh, [](const Vec3& p) { return Vec3(p.x(), p.x() + p.z(), p.z()); });
  };
  EXPECT_TRUE(
      passages({tilted(flat), tilted(other)}, {tilted(flat), tilted(moved(other, {-3.75, 0, 0}))}).empty());
}

// ---- Exactly through vertices and edges ----

/// Number of passages of the tip of a needle, the second mesh, through the first.
int num_through(const std::vector<FeaturePair>& found) {
  return static_cast<int>(std::ranges::count_if(found, [](const FeaturePair& p) {
    return p.kind == Kind::vertex_triangle && p.surface == 1 && p.feature[0] == 0;
  }));
}

TEST(Passages, ThroughAVertexOrAnEdgeOfASheetAreOddInNumber) {
  for (const auto diagonals : {GridDiagonals::parallel, GridDiagonals::alternating}) {
    const TriangleMesh flat = sheet(4, diagonals);
    for (int i = 1; i < 8; ++i) {
      for (int j = 1; j < 8; ++j) {  // vertices, edge midpoints, cell centres, all on the grid
        const Vec3 at(i / 8.0, 0, j / 8.0);
        for (const Vec3& slope : {Vec3(0, 0, 0), Vec3(0.125, 0, 0.125), Vec3(0.25, 0, 0)}) {
          const auto found = passages({flat, needle(at + slope + Vec3(0, 0.5, 0))},
                                      {flat, needle(at - slope - Vec3(0, 0.5, 0))});
          EXPECT_EQ(num_through(found) % 2, 1) << i << " " << j;
        }
      }
    }
  }
}

TEST(Passages, ThatPauseExactlyOnASheetAreToldWhenTheyAreThrough) {
  const TriangleMesh flat = sheet(4);
  for (const Vec3& at :
       {Vec3(0.3, 0, 0.35), Vec3(0.5, 0, 0.5), Vec3(0.375, 0, 0.5)}) {  // inside, vertex, edge
    const auto run = [&](const std::vector<double>& heights) {
      std::vector<std::vector<TriangleMesh>> moments;
      for (const double h : heights) moments.push_back({flat, needle(at + Vec3(0, h, 0))});
      std::vector<int> counts;
      for (const auto& found : passages(moments)) counts.push_back(num_through(found) % 2);
      return counts;
    };
    EXPECT_EQ(run({0.1, 0, -0.1}), (std::vector{0, 1}));
    EXPECT_EQ(run({0.1, 0, 0, 0, -0.1}), (std::vector{0, 0, 0, 1}));
    EXPECT_EQ(run({0.1, 0, 0.1}), (std::vector{0, 0}));
    EXPECT_EQ(run({-0.1, 0, 0, -0.1}), (std::vector{0, 0, 0}));
    EXPECT_EQ(run({0, 0, -0.1}), (std::vector{0, 0})) << "on which side it was nobody knows";
    EXPECT_EQ(run({0, 0.1, -0.1}), (std::vector{0, 1}));
  }
}

// ---- Shapes ----

TEST(Passages, OfAVisitThatTakesSeveralMomentsAreToldAtItsEnd) {
  const Sphere ball{Vec3::Zero(), 1};
  Particles through({{-2, 0, 0}}, ball);
  EXPECT_EQ(through.num_passages({{-0.5, 0, 0}}, ball), 0);
  EXPECT_EQ(through.num_passages({{0.5, 0, 0}}, ball), 0);
  EXPECT_EQ(through.num_passages({{2, 0, 0}}, ball), 1);
  EXPECT_EQ(through.num_passages({{3, 0, 0}}, ball), 0);
  Particles from_inside({{-0.5, 0, 0}}, ball);
  EXPECT_EQ(from_inside.num_passages({{0.5, 0, 0}}, ball), 0);
  EXPECT_EQ(from_inside.num_passages({{2, 0, 0}}, ball), 0) << "it started inside";
  EXPECT_EQ(from_inside.num_passages({{-2, 0, 0}}, ball), 1);
  Particles pressed({{0, 1.1, 0}}, ball);
  EXPECT_EQ(pressed.num_passages({{0, 1 - 5e-5, 0}}, ball), 0);
  EXPECT_EQ(pressed.num_passages({{0, 1.1, 0}}, ball), 0) << "no deeper than the tolerance";
}

TEST(Passages, AreNoneOnABallThatSpins) {
  // Rotation of half a radian per frame: the straight path of a corotating particle goes deep into a static
  // ball, that of a static particle goes deep into a rotating one.
  const Sphere ball{{0.3, 0.2, 0.1}, 1};
  const auto turned = [](double angle) { return Eigen::AngleAxisd(angle, Vec3::UnitY()).toRotationMatrix(); };
  const Vec3 rides(1.001, 0, 0), rests(0, 0, 1.001);
  const auto at = [&](double angle) {
    return std::vector<Vec3>{ball.center + turned(angle) * rides, ball.center + rests};
  };
  Particles dust(at(0), ball, turned(0));
  for (int k = 1; k < 20; ++k) EXPECT_EQ(dust.num_passages(at(0.5 * k), ball, turned(0.5 * k)), 0);
  Particles unknown(at(0), ball);
  EXPECT_EQ(unknown.num_passages(at(0.5), ball), 1) << "where the turn is not known";
}

TEST(Passages, OfAHalfSpaceAreNone) {
  EXPECT_EQ(num_passages({0, 1, 0}, {0, -1, 0}, Plane{}, Plane{}), 0) << "it is inside: check_frame";
  EXPECT_EQ(num_passages({0, 1, 0}, {5, 1, 0}, Plane{}, Plane{{0, 0.5, 0}, Vec3::UnitX()}), 0);
}

// ---- Skipped motions, and names ----

TEST(Passages, AreNoneOfThingsThatMayPass) {
  const TriangleMesh low = sheet(3), high = moved(sheet(4), {0.1, 0.5, 0.1}),
                     beyond = moved(high, {0, -1, 0});
  for (const auto& pair : {std::array<std::string, 2>{"low", "high"}, {"high", "low"}}) {
    PassageWatch watch({{cloth("low", low), cloth("high", high)}, {}, {pair}});
    EXPECT_TRUE(watch.advance({{cloth("low", low), cloth("high", beyond)}, {}, {pair}}).empty());
  }
}

TEST(Passages, AreNamed) {
  const TriangleMesh flat = sheet(1, GridDiagonals::parallel), above = needle({0.6, 0.1, 0.3}),
                     below = needle({0.6, -0.1, 0.3});
  const auto first = [](const Frame& before, const Frame& after) {
    PassageWatch watch(before);
    const std::vector<FeaturePair> found = watch.advance(after);
    return found.empty() ? "" : describe(after, found[0]);
  };
  EXPECT_EQ(first({{cloth("sheet", flat), cloth("rag", above)}, {}},
                  {{cloth("sheet", flat), cloth("rag", below)}, {}}),
            "cloth \"rag\" particle 0 passes through cloth \"sheet\" triangle 1");
  EXPECT_EQ(
      first({{cloth("sheet", flat)}, {body("nail", above)}}, {{cloth("sheet", flat)}, {body("nail", below)}}),
      "collider \"nail\" vertex 0 passes through cloth \"sheet\" triangle 1");
  const Vec3 p(0.6, 0.1, 0.3), q(0.6, -0.1, 0.3);
  EXPECT_EQ(first({{cloth("sheet", flat)}, {{"shot", Sphere{p, 0.01}}}},
                  {{cloth("sheet", flat)}, {{"shot", Sphere{q, 0.01}}}}),
            "collider \"shot\" passes through cloth \"sheet\" triangle 1");
  EXPECT_EQ(first({{cloth("rag", above)}, {{"ball", Sphere{{0.6, 0, 0.28}, 0.05}}}},
                  {{cloth("rag", below)}, {{"ball", Sphere{{0.6, 0, 0.28}, 0.05}}}}),
            "cloth \"rag\" particle 0 passes through collider \"ball\"");
  TriangleMesh fold{{{0, 0, 0}, {1, 0, 0}, {0, 0, 1}, {0.2, 0.1, 0.2}, {0.2, 1, 0.3}, {0.3, 1, 0.2}},
                    {{0, 1, 2}, {3, 4, 5}}};
  const TriangleMesh open = fold;
  fold.positions[3].y() = -0.1;
  EXPECT_EQ(first({{cloth("sheet", open)}, {}}, {{cloth("sheet", fold)}, {}}),
            "cloth \"sheet\" particle 3 passes through its triangle 0");
}

TEST(Passages, LeaveOutMotionsThatFlingClothAbout) {
  Random random(7);
  const TriangleMesh flat = sheet(30), low = moved(flat, {0, -1, 0});
  const TriangleMesh flung = mapped(flat, [&](const Vec3&) { return random_vector(random, 1e20); });
  PassageWatch watch({{cloth("sheet", flat), cloth("low", low)}, {}});
  EXPECT_TRUE(watch.advance({{cloth("sheet", flung), cloth("low", low)}, {}}).empty());
  EXPECT_TRUE(watch.advance({{cloth("sheet", flat), cloth("low", low)}, {}}).empty());
  EXPECT_EQ(watch.num_left_out(), 2);
  const TriangleMesh high = moved(flat, {0, 1, 0}), under = moved(flat, {0, -2, 0});
  EXPECT_TRUE(watch.advance({{cloth("sheet", high), cloth("low", low)}, {}}).empty());
  EXPECT_FALSE(watch.advance({{cloth("sheet", under), cloth("low", low)}, {}}).empty())
      << "as a whole, though far";
  EXPECT_EQ(watch.num_left_out(), 2);
}

TEST(Passages, LeaveOutMomentsThatAreNotFinite) {
  const TriangleMesh low = sheet(3), high = moved(sheet(4), {0.1, 0.5, 0.1}),
                     beyond = moved(high, {0, -1, 0});
  const TriangleMesh lost = mapped(high, [](const Vec3& p) { return Vec3(p / 0.0); });
  PassageWatch watch({{cloth("low", low), cloth("high", high)}, {}});
  EXPECT_TRUE(watch.advance({{cloth("low", low), cloth("high", lost)}, {}}).empty());
  EXPECT_EQ(watch.num_left_out(), 1);
  EXPECT_FALSE(watch.advance({{cloth("low", low), cloth("high", beyond)}, {}}).empty());
}

}  // namespace
}  // namespace weft::engine::verify
