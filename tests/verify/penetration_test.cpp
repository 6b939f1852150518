#include "weft/verify/penetration.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "weft/core/random.h"
#include "weft/mesh/grid.h"

namespace weft::engine::verify {
namespace {

constexpr double kRounding = 1e-12;  // lengths here are about 1

Vec3 random_vector(Random& random, double size) {
  return {random.uniform(-size, size), random.uniform(-size, size), random.uniform(-size, size)};
}

Mat3 random_rotation(Random& random) {
  return Eigen::AngleAxisd(random.uniform(-3, 3), random_vector(random, 1).normalized()).toRotationMatrix();
}

// ---- Depth of a point, by definition ----

double depth(const Sphere& s, const Vec3& p) { return s.radius - (p - s.center).norm(); }

double depth(const Plane& plane, const Vec3& p) { return -(p - plane.point).dot(plane.normal); }

double depth(const Capsule& c, const Vec3& p) {
  const Vec3 axis = c.b - c.a;
  const double s = std::clamp((p - c.a).dot(axis) / std::max(axis.squaredNorm(), 1e-300), 0.0, 1.0);
  return c.radius - (p - c.a - s * axis).norm();
}

double depth(const OrientedBox& box, const Vec3& p) {
  return (box.half_size - (box.rotation.transpose() * (p - box.center)).cwiseAbs()).minCoeff();
}

/// Maximum depth over sample points of the triangle, `steps` per side.
template <class Shape>
double sampled_depth(const Shape& shape, const Corners& t, int steps) {
  double deepest = -1e300;
  for (int i = 0; i <= steps; ++i) {
    for (int j = 0; i + j <= steps; ++j) {
      const Vec3 p = t[0] + (i * (t[1] - t[0]) + j * (t[2] - t[0])) / steps;
      deepest = std::max(deepest, depth(shape, p));
    }
  }
  return deepest;
}

/// No sample is deeper than depth_in's result, and some sample is nearly as deep: depth changes by at most
/// the distance.
template <class Shape>
void expect_as_sampled(const Shape& shape, const Corners& t) {
  constexpr int kSteps = 60;
  const double sampled = sampled_depth(shape, t, kSteps), found = depth_in(shape, t);
  const double spacing =
      std::max({(t[1] - t[0]).norm(), (t[2] - t[0]).norm(), (t[2] - t[1]).norm()}) / kSteps;
  if (found <= 0) {
    EXPECT_LE(sampled, kRounding);
    return;
  }
  EXPECT_LE(sampled, found + kRounding);
  EXPECT_GE(sampled, found - spacing);
}

TEST(DepthOfATriangle, IsThatOfItsDeepestPoint) {
  Random random(1);
  for (int i = 0; i < 3000; ++i) {
    const Vec3 at = random_vector(random, 1);
    const double size = i % 2 == 0 ? 0.3 : 2;
    Corners t;
    for (Vec3& p : t) p = at + random_vector(random, size);
    if (i % 10 == 0) t[2] = 0.5 * (t[0] + t[1]);  // without area
    if (i % 33 == 0) t[1] = t[2] = t[0];
    const Vec3 a = random_vector(random, 0.7);
    expect_as_sampled(Sphere{a, random.uniform(0.1, 1)}, t);
    expect_as_sampled(Plane{a, random_vector(random, 1).normalized()}, t);
    expect_as_sampled(Capsule{a, i % 7 == 0 ? a : random_vector(random, 1), random.uniform(0.1, 0.6)}, t);
    const Vec3 half_size = Vec3(0.55, 0.55, 0.55) + random_vector(random, 0.5);
    expect_as_sampled(OrientedBox{a, half_size, i % 3 == 0 ? Mat3::Identity() : random_rotation(random)}, t);
  }
}

TEST(DepthOfATriangle, WhoseCornersAreAllOutside) {
  const Corners t = {Vec3(-3, 0, -3), Vec3(3, 0, -3), Vec3(0, 0, 5)};
  EXPECT_NEAR(depth_in(Sphere{{0, -0.3, 0}, 0.5}, t), 0.2, kRounding);
  EXPECT_NEAR(depth_in(Capsule{{0, -2, 0}, {0, -0.3, 0}, 0.5}, t), 0.2, kRounding);
  EXPECT_NEAR(depth_in(Capsule{{0, -2, 0}, {0, 2, 0}, 0.5}, t), 0.5, kRounding) << "the axis runs through it";
  EXPECT_NEAR(depth_in(OrientedBox{{0, -0.9, 0}, {1, 1, 1}}, t), 0.1, kRounding);
  EXPECT_NEAR(depth_in(OrientedBox{{0, 0, 0}, {1, 0.5, 1}}, t), 0.5, kRounding);
}

TEST(DepthOfATriangle, ThroughWhichACornerOfABoxPokes) {
  // A cube on its corner: the opposite one, √3 above the centre, pokes through by c. Under the plane its
  // three upper faces are at the angle whose sine is 1/√3, so the deepest point, below the tip, is c/√3 from
  // each.
  const Vec3 up = Vec3(1, 1, 1).normalized();
  const Mat3 standing = Eigen::Quaterniond::FromTwoVectors(up, Vec3::UnitY()).toRotationMatrix();
  const double c = 0.07;
  const OrientedBox cube{{0.2, c - std::sqrt(3.0), 0.1}, {1, 1, 1}, standing};
  const Corners t = {Vec3(-4, 0, -3), Vec3(5, 0, -3), Vec3(0, 0, 6)};
  for (const Vec3& p : t) EXPECT_LT(depth(cube, p), 0);
  EXPECT_NEAR(depth_in(cube, t), c / std::sqrt(3.0), kRounding);
  EXPECT_LE(depth_in(OrientedBox{cube.center - Vec3(0, 1.01 * c, 0), cube.half_size, standing}, t), 0);
}

// ---- Meshes ----

/// A cube of two triangles per face, facing outwards.
TriangleMesh cube(double half) {
  TriangleMesh mesh;
  for (int k = 0; k < 8; ++k)
    mesh.positions.push_back(half * Vec3(k & 1 ? 1 : -1, k & 2 ? 1 : -1, k & 4 ? 1 : -1));
  mesh.triangles = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                    {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
  return mesh;
}

bool is_solid(const std::vector<Triangle>& triangles) {
  return !triangles.empty() && find_solid_triangles(triangles).size() == triangles.size();
}

MeshView view(const TriangleMesh& mesh) {
  return {mesh.positions, mesh.triangles,
          is_solid(mesh.triangles) ? mesh.triangles : std::span<const Triangle>()};
}

/// A cloth of particles only.
double deepest_of(const std::vector<Vec3>& particles, const Solid& solid) {
  const SurfaceView cloth[] = {{particles, {}, true}};
  const Solid solids[] = {solid};
  return find_deepest(cloth, solids)->depth;
}

TEST(SolidTriangles, AreThoseOfPartsWithoutBorder) {
  EXPECT_TRUE(is_solid(cube(1).triangles));
  EXPECT_TRUE(is_solid(make_sphere_mesh({0, 0, 0}, 1, 8).triangles));
  EXPECT_TRUE(find_solid_triangles(build_grid_mesh({}, GridDiagonals::parallel).triangles).empty());
  EXPECT_TRUE(find_solid_triangles({}).empty());
  auto torn = cube(1).triangles;
  torn.pop_back();
  EXPECT_TRUE(find_solid_triangles(torn).empty());
  auto turned = cube(1).triangles;
  std::swap(turned[0][0], turned[0][1]);
  EXPECT_TRUE(find_solid_triangles(turned).empty()) << "one face looks inwards";

  auto both = torn;  // and a closed cube beside the torn one
  for (const Triangle& t : cube(1).triangles) both.push_back({t[0] + 8, t[1] + 8, t[2] + 8});
  EXPECT_EQ(find_solid_triangles(both), std::vector<Triangle>(both.begin() + torn.size(), both.end()));
}

TEST(DepthInAMesh, IsThatInTheBoxItShows) {
  // At multiples of 1/4 rays run along edges and diagonals and through corners.
  const TriangleMesh mesh = cube(1);
  const OrientedBox box{{0, 0, 0}, {1, 1, 1}};
  Random random(2);
  for (int i = 0; i < 20000; ++i) {
    Vec3 p = random_vector(random, 1.3);
    if (i % 2 == 0) p = (4 * p).array().round() / 4;
    EXPECT_NEAR(deepest_of({p}, view(mesh)), std::max(0.0, depth(box, p)), kRounding) << p.transpose();
  }
}

TEST(DepthInAMesh, IsNearThatOfTheBallItShows) {
  TriangleMesh mesh = make_sphere_mesh({0.1, 0.2, 0.3}, 1, 32);
  const Sphere ball{{0.1, 0.2, 0.3}, 1};
  for (const bool is_inside_out : {false, true}) {
    if (is_inside_out) {
      for (Triangle& t : mesh.triangles) std::swap(t[0], t[1]);
    }
    Random random(3);
    for (int i = 0; i < 500; ++i) {
      const Vec3 p = random_vector(random, 1.2);
      // The mesh is inscribed: flat sides of 1/10 are up to 1 - cos(1/20 √2) = 0.0025 below the ball's
      // surface.
      const double found = deepest_of({p}, view(mesh)), expected = std::max(0.0, depth(ball, p));
      EXPECT_LE(found, expected + kRounding);
      EXPECT_GE(found, expected - 0.006);
    }
  }
}

TEST(DepthInAMesh, IsTheGreatestOfAllParticles) {
  const TriangleMesh mesh = make_sphere_mesh({0, 0, 0}, 1, 16);
  Random random(4);
  std::vector<Vec3> particles;
  double deepest = 0;
  for (int i = 0; i < 300; ++i) {
    particles.push_back(random_vector(random, 1));
    deepest = std::max(deepest, deepest_of({particles.back()}, view(mesh)));
  }
  EXPECT_EQ(deepest_of(particles, view(mesh)), deepest);
}

TEST(FindDeepest, NamesClothTriangleAndSolid) {
  const TriangleMesh far{{{9, 9, 9}, {9, 9, 8}, {8, 9, 9}}, {{0, 1, 2}}};
  const TriangleMesh near{{{5, 5, 5}, {5, 5, 4}, {4, 5, 5}, {0, 0, 0.8}, {0, 3, 3}, {1, 3, 3}},
                          {{0, 1, 2}, {3, 4, 5}}};
  const SurfaceView cloths[] = {{far.positions, far.triangles}, {near.positions, near.triangles}};
  const TriangleMesh open = build_grid_mesh({}, GridDiagonals::parallel);
  const Solid solids[] = {Sphere{{3, 0, 0}, 1}, view(open), Sphere{{0, 0, 0}, 1}};
  const auto deepest = find_deepest(cloths, solids);
  ASSERT_TRUE(deepest.has_value());
  EXPECT_NEAR(deepest->depth, 0.2, kRounding);
  EXPECT_EQ(deepest->cloth, 1);
  EXPECT_EQ(deepest->triangle, 1);
  EXPECT_EQ(deepest->particle, -1);
  EXPECT_EQ(deepest->solid, 2);
}

TEST(FindDeepest, KnowsNoDepthWithoutAnInside) {
  const TriangleMesh open = build_grid_mesh({}, GridDiagonals::parallel);
  const SurfaceView cloths[] = {{open.positions, open.triangles}};
  EXPECT_FALSE(find_deepest(cloths, {}).has_value());
  const Solid solids[] = {view(open)};
  EXPECT_FALSE(find_deepest(cloths, solids).has_value());
}

}  // namespace
}  // namespace weft::engine::verify
