/// Whatever motion it is given, the last line leaves nothing crossed, by the independent checker.

#include "weft/contact/last_line.h"

#include <gtest/gtest.h>

#include "tests/support.h"
#include "weft/mesh/grid.h"
#include "weft/verify/crossings.h"

namespace weft::engine {
namespace {

/// Patches of cloth, each at its place, and what LastLine has to know of them.
struct Patches {
  std::vector<TriangleMesh> meshes;
  Surface surface;
  std::vector<int> first_vertex;
  std::vector<Vec3> origins, rest;
  std::vector<double> inverse_mass;
  std::vector<MovingShape> shapes;
  std::vector<char> is_solid;
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

  LastLineReport hold(const std::vector<Vec3>& end) {
    const auto jobs = make_serial_jobs();
    first_vertex.push_back(surface.num_vertices);
    surface.build_fans();
    rest = motion.start;
    motion.end = end;
    is_solid.assign(end.size(), 0);
    weft::engine::Patches groups;
    groups.add_mesh(surface, rest, 0, static_cast<int>(surface.triangles.size()));
    Proximity proximity;
    proximity.reset(surface, groups, rest, surface.num_vertices, static_cast<int>(surface.triangles.size()),
                    {0.003, 0.001, 0.006});
    LastLine line;
    const LastLineReport report =
        line.hold({&inverse_mass, &shapes, &first_vertex, &origins, &is_solid}, proximity, motion, *jobs);
    first_vertex.pop_back();
    return report;
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

/// Patches above each other, slightly turned, that do not cross.
Patches make_stack(Random& random, int layers) {
  Patches patches;
  for (int k = 0; k < layers; ++k) {
    const Vec3 middle =
        Vec3(0, 0.004 * k, 0) + Vec3(random.uniform(-0.02, 0.02), 0, random.uniform(-0.02, 0.02));
    patches.add(4, middle, rotation_from_angles_deg({0, random.uniform(0, 90), 0}));
  }
  return patches;
}

TEST(LastLine, LeavesNothingCrossedAndKeepsMomentum) {
  int crossed = 0, zones = 0;
  for (int seed = 0; seed < 150; ++seed) {
    Random random(seed);
    Patches patches = make_stack(random, 3);
    std::vector<Vec3> end = patches.motion.start;
    // Each patch flies through the others, and all of it is shaken by up to its own size.
    const double shake = std::pow(10.0, random.uniform(-3, -1));
    for (std::size_t m = 0; m < patches.meshes.size(); ++m) {
      const Vec3 way = test::random_vector(random, 0.05);
      for (std::size_t i = 0; i < patches.meshes[m].positions.size(); ++i)
        end[patches.first_vertex[m] + i] += way + test::random_vector(random, shake);
    }
    ASSERT_EQ(patches.num_crossings(patches.motion.start), 0u) << seed;
    crossed += patches.num_crossings(end) > 0;
    const Vec3 before = patches.momentum(end);
    const LastLineReport report = patches.hold(end);
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

TEST(LastLine, LeavesAMotionThatMeetsNothingAsItIs) {
  Random random(1);
  Patches patches = make_stack(random, 3);
  std::vector<Vec3> end = patches.motion.start;
  for (Vec3& p : end) p = (p + Vec3(0.3, -2, 0.1)).cast<float>().cast<double>();
  const LastLineReport report = patches.hold(end);
  EXPECT_EQ(report.hits, 0);
  EXPECT_EQ(patches.motion.end, end) << "free fall, however fast";
}

TEST(LastLine, PrescribedMotionsThatLeaveNoRoomAreListed) {
  // The upper patch is pinned and moves through the lower one, which is pinned too.
  Random random(2);
  Patches patches = make_stack(random, 2);
  std::fill(patches.inverse_mass.begin(), patches.inverse_mass.end(), 0.0);
  std::vector<Vec3> end = patches.motion.start;
  for (int v = patches.first_vertex[1]; v < static_cast<int>(end.size()); ++v) end[v].y() -= 0.01;
  const LastLineReport report = patches.hold(end);
  EXPECT_FALSE(report.infeasible.empty());
  EXPECT_EQ(patches.motion.end, end) << "what is prescribed stays so";
}

TEST(LastLine, ASheetIsTakenAlongByWhatMovesThroughItsPlace) {
  // The lower patch is pinned and comes up by a metre: the upper one, which is free, must be above it.
  Random random(3);
  Patches patches = make_stack(random, 2);
  for (int v = 0; v < patches.first_vertex[1]; ++v) patches.inverse_mass[v] = 0;
  std::vector<Vec3> end = patches.motion.start;
  for (int v = 0; v < patches.first_vertex[1]; ++v) end[v].y() += 1;
  const LastLineReport report = patches.hold(end);
  EXPECT_TRUE(report.infeasible.empty());
  EXPECT_EQ(patches.num_crossings(patches.motion.end), 0u);
  for (int v = patches.first_vertex[1]; v < static_cast<int>(end.size()); ++v)
    EXPECT_GT(patches.motion.end[v].y(), 0.5) << "not left behind on the other side; corners overhang";
}

}  // namespace
}  // namespace weft::engine
