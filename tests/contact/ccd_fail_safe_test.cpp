/// CCD fail-safe: no intersections after any motion, by the independent checker.

#include "weft/contact/ccd_fail_safe.h"

#include <gtest/gtest.h>

#include "tests/support.h"
#include "weft/mesh/grid.h"
#include "weft/mesh/sample_meshes.h"
#include "weft/verify/crossings.h"
#include "weft/verify/passages.h"

namespace weft::engine {
namespace {

/// Patches of cloth with positions, then closed meshes, and the input of CcdFailSafe.
struct Patches {
  std::vector<TriangleMesh> meshes;
  Surface surface;
  std::vector<int> first_vertex;
  std::vector<Vec3> origins, rest;
  std::vector<double> inverse_mass;
  std::vector<MovingShape> shapes;
  std::vector<ColliderMesh> bodies;
  SurfaceMotion motion;

  void add(int cells, const Vec3& middle, const Mat3& turn) {
    TriangleMesh mesh = build_grid_mesh(test::square(cells, 0.1), GridDiagonals::alternating);
    for (Vec3& p : mesh.positions) p = middle + turn * (p - Vec3(0.05, 0, 0.05));
    first_vertex.push_back(surface.num_vertices);
    origins.push_back(Vec3::Zero());
    surface.add(mesh.triangles, mesh.num_vertices());
    for (const Vec3& p : mesh.positions) {
      motion.start.push_back(p.cast<float>().cast<double>());
      motion.half_thickness.push_back(5e-4);
      inverse_mass.push_back(1 / (0.5 + 0.1 * static_cast<double>(meshes.size())));
    }
    meshes.push_back(std::move(mesh));
  }

  void add_closed(TriangleMesh mesh) {
    const int first_triangle = static_cast<int>(surface.triangles.size());
    first_vertex.push_back(surface.num_vertices);
    surface.add(mesh.triangles, mesh.num_vertices());
    bodies.push_back({.first_vertex = first_vertex.back(),
                      .end_vertex = surface.num_vertices,
                      .first_triangle = first_triangle,
                      .end_triangle = static_cast<int>(surface.triangles.size()),
                      .solid = {surface.triangles.begin() + first_triangle, surface.triangles.end()},
                      .is_solid = std::vector<char>(mesh.positions.size(), 1)});
    motion.start.insert(motion.start.end(), mesh.positions.begin(), mesh.positions.end());
    motion.half_thickness.resize(motion.start.size(), 0);
    inverse_mass.resize(motion.start.size(), 0);
    meshes.push_back(std::move(mesh));
  }

  CcdFailSafeReport resolve(const std::vector<Vec3>& end) {
    const auto jobs = make_serial_jobs();
    const int num_triangles = static_cast<int>(surface.triangles.size());
    const int num_cloth_vertices = bodies.empty() ? surface.num_vertices : bodies[0].first_vertex;
    const int num_cloth_triangles = bodies.empty() ? num_triangles : bodies[0].first_triangle;
    std::vector<int> first_of_cloth(first_vertex.begin(), first_vertex.begin() + origins.size());
    first_of_cloth.push_back(num_cloth_vertices);
    surface.build_one_rings();
    rest.assign(motion.start.begin(), motion.start.begin() + num_cloth_vertices);
    motion.end = end;
    weft::engine::Patches groups;
    groups.add_mesh(surface, rest, 0, num_cloth_triangles, *make_serial_jobs());
    groups.add_body(surface, num_cloth_triangles, num_triangles);
    Proximity proximity;
    proximity.reset(surface, groups, rest, num_cloth_vertices, num_cloth_triangles, {0.003, 0.001, 0.006});
    CcdFailSafe fail_safe;
    return fail_safe.resolve({&inverse_mass, &shapes, &first_of_cloth, &origins, &bodies}, proximity, motion,
                             *jobs);
  }

  /// Number of feature pairs that pass through each other on the way to `end`.
  std::size_t num_passages(const std::vector<Vec3>& end) const {
    const auto frame_at = [&](const std::vector<Vec3>& x) {
      verify::Frame frame;
      for (std::size_t m = 0; m < meshes.size(); ++m) {
        const std::span<const Vec3> positions =
            std::span(x).subspan(first_vertex[m], meshes[m].positions.size());
        if (m < origins.size())
          frame.cloths.push_back({"patch", positions, meshes[m].triangles});
        else
          frame.colliders.push_back(
              {"solid", verify::MeshView{positions, meshes[m].triangles, meshes[m].triangles}});
      }
      return frame;
    };
    return verify::PassageWatch(frame_at(motion.start)).advance(frame_at(end)).size();
  }

  std::size_t num_crossings(const std::vector<Vec3>& x) const {
    std::vector<verify::SurfaceView> views;
    for (std::size_t m = 0; m < meshes.size(); ++m) {
      views.push_back(
          {std::span(x).subspan(first_vertex[m], meshes[m].positions.size()), meshes[m].triangles, true});
    }
    return verify::find_crossings(views).size();
  }

  Vec3 momentum(const std::vector<Vec3>& end) const {
    Vec3 sum = Vec3::Zero();
    for (std::size_t v = 0; v < end.size(); ++v) {
      if (inverse_mass[v] > 0) sum += (end[v] - motion.start[v]) / inverse_mass[v];
    }
    return sum;
  }
};

/// Stacked patches, slightly rotated, without intersections.
Patches make_stack(Random& random, int layers) {
  Patches patches;
  for (int k = 0; k < layers; ++k) {
    const Vec3 middle =
        Vec3(0, 0.004 * k, 0) + Vec3(random.uniform(-0.02, 0.02), 0, random.uniform(-0.02, 0.02));
    patches.add(4, middle, rotation_from_angles_deg({0, random.uniform(0, 90), 0}));
  }
  return patches;
}

TEST(CcdFailSafe, LeavesNothingCrossedAndKeepsMomentum) {
  int crossed = 0, zones = 0;
  for (int seed = 0; seed < 150; ++seed) {
    Random random(seed);
    Patches patches = make_stack(random, 3);
    std::vector<Vec3> end = patches.motion.start;
    // Each patch flies through the others, and is perturbed by up to its own size.
    const double shake = std::pow(10.0, random.uniform(-3, -1));
    for (std::size_t m = 0; m < patches.meshes.size(); ++m) {
      const Vec3 way = test::random_vector(random, 0.05);
      for (std::size_t i = 0; i < patches.meshes[m].positions.size(); ++i)
        end[patches.first_vertex[m] + i] += way + test::random_vector(random, shake);
    }
    ASSERT_EQ(patches.num_crossings(patches.motion.start), 0u) << seed;
    crossed += patches.num_crossings(end) > 0;
    const Vec3 before = patches.momentum(end);
    const CcdFailSafeReport report = patches.resolve(end);
    EXPECT_TRUE(report.infeasible.empty()) << seed;
    EXPECT_EQ(patches.num_crossings(patches.motion.end), 0u) << seed;
    EXPECT_LT((patches.momentum(patches.motion.end) - before).norm(),
              1e-5 * static_cast<double>(patches.motion.end.size()))
        << seed;
    zones += report.zones;
  }
  EXPECT_GT(crossed, 80) << "most of these motions go through something";
  EXPECT_GT(zones, 10) << "and some leave no other way than moving rigidly";
}

TEST(CcdFailSafe, LeavesAMotionThatMeetsNothingAsItIs) {
  Random random(1);
  Patches patches = make_stack(random, 3);
  std::vector<Vec3> end = patches.motion.start;
  for (Vec3& p : end) p = (p + Vec3(0.3, -2, 0.1)).cast<float>().cast<double>();
  const CcdFailSafeReport report = patches.resolve(end);
  EXPECT_EQ(report.hits, 0);
  EXPECT_EQ(patches.motion.end, end) << "free fall, however fast";
}

TEST(CcdFailSafe, PrescribedMotionsThatLeaveNoRoomAreListed) {
  // The upper patch is pinned and moves through the lower one, which is pinned too.
  Random random(2);
  Patches patches = make_stack(random, 2);
  std::fill(patches.inverse_mass.begin(), patches.inverse_mass.end(), 0.0);
  std::vector<Vec3> end = patches.motion.start;
  for (int v = patches.first_vertex[1]; v < static_cast<int>(end.size()); ++v) end[v].y() -= 0.01;
  const CcdFailSafeReport report = patches.resolve(end);
  EXPECT_FALSE(report.infeasible.empty());
  EXPECT_EQ(patches.motion.end, end) << "what is prescribed stays so";
}

TEST(CcdFailSafe, ASheetIsTakenAlongByWhatMovesThroughItsPlace) {
  // The lower patch is pinned and rises by a metre: the upper one, which is free, must end above it.
  Random random(3);
  Patches patches = make_stack(random, 2);
  for (int v = 0; v < patches.first_vertex[1]; ++v) patches.inverse_mass[v] = 0;
  std::vector<Vec3> end = patches.motion.start;
  for (int v = 0; v < patches.first_vertex[1]; ++v) end[v].y() += 1;
  const CcdFailSafeReport report = patches.resolve(end);
  EXPECT_TRUE(report.infeasible.empty());
  EXPECT_EQ(patches.num_crossings(patches.motion.end), 0u);
  for (int v = patches.first_vertex[1]; v < static_cast<int>(end.size()); ++v)
    EXPECT_GT(patches.motion.end[v].y(), 0.5) << "not left behind on the other side; corners overhang";
}

TEST(CcdFailSafe, NothingPassesThroughAClosedMeshThatTurnsFast) {
  // A patch lies on a facet of a rotating ball: ridges reach the patch, and faces behind whose planes it lies
  // at the start, although it is outside.
  int passed = 0;
  for (int seed = 0; seed < 60; ++seed) {
    Random random(seed);
    TriangleMesh ball = make_sphere_mesh(Vec3::Zero(), 0.15, 8);
    const Triangle facet = ball.triangles[random.next() % ball.triangles.size()];
    const Vec3 a = ball.positions[facet[0]], b = ball.positions[facet[1]], c = ball.positions[facet[2]];
    const Vec3 out = (b - a).cross(c - a).normalized();
    Mat3 in_plane;
    in_plane << (b - a).normalized(), out, (b - a).normalized().cross(out);
    Patches patches;
    patches.add(8, (a + b + c) / 3 + 5e-4 * out, in_plane);
    patches.add_closed(ball);
    ASSERT_EQ(patches.num_crossings(patches.motion.start), 0u) << seed;
    std::vector<Vec3> end = patches.motion.start;
    const Mat3 turn = rotation_from_angles_deg(test::random_vector(random, 20));
    for (int v = patches.first_vertex[1]; v < static_cast<int>(end.size()); ++v) end[v] = turn * end[v];
    passed += patches.num_passages(end) > 0;
    const CcdFailSafeReport report = patches.resolve(end);
    EXPECT_TRUE(report.infeasible.empty()) << seed;
    EXPECT_EQ(patches.num_passages(patches.motion.end), 0u) << seed;
    EXPECT_EQ(patches.num_crossings(patches.motion.end), 0u) << seed;
  }
  EXPECT_GT(passed, 50) << "nearly all of these turns go through the patch";
}

TEST(CcdFailSafe, WhatIsInsideAClosedMeshMayLeaveIt) {
  Patches patches;
  patches.add(4, Vec3(0.01, 0.02, 0.015), Mat3::Identity());
  patches.add_closed(make_sphere_mesh(Vec3::Zero(), 0.15, 8));
  std::vector<Vec3> end = patches.motion.start;
  for (int v = 0; v < patches.first_vertex[1]; ++v) end[v].y() += 0.5;
  EXPECT_EQ(patches.resolve(end).hits, 0);
  EXPECT_EQ(patches.motion.end, end);
}

}  // namespace
}  // namespace weft::engine
