/// Public functions of meshes, and point caches.

#include "weft/io.h"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <limits>

#include "tests/own_folder.h"
#include "tests/read_text.h"
#include "weft/error.h"

namespace weft {
namespace {

namespace fs = std::filesystem;

class Io : public testing::Test {
 protected:
  std::string path(const std::string& name) const { return (folder_ / name).string(); }

  const fs::path folder_ = engine::make_own_folder();
};

double area_y(const Triangle& t, const std::vector<Vec3>& x) {
  const Vec3 &a = x[t[0]], &b = x[t[1]], &c = x[t[2]];
  return ((b.z - a.z) * (c.x - a.x) - (b.x - a.x) * (c.z - a.z)) / 2;
}

TEST_F(Io, PolygonsAreCutAtTheirEars) {
  // A square, and an arrow whose third corner is a dent. Triangles around the first corner would leave it.
  const std::vector<Vec3> corners = {{0, 0, 0}, {0, 0, 1},  {1, 0, 1},   {1, 0, 0},
                                     {0, 0, 0}, {-1, 0, 1}, {0, 0, 0.5}, {1, 0, 1}};
  const std::vector<Triangle> cut = triangulate(corners, {4, 4});
  ASSERT_EQ(cut.size(), 4u);
  for (std::size_t t = 0; t < 4; ++t) {
    for (const int corner : cut[t]) EXPECT_EQ(corner / 4, static_cast<int>(t) / 2);
    EXPECT_EQ(std::abs(area_y(cut[t], corners)), t < 2 ? 0.5 : 0.25);
  }
  EXPECT_EQ(area_y(cut[0], corners), area_y(cut[1], corners));
  EXPECT_EQ(area_y(cut[2], corners), area_y(cut[3], corners));
  EXPECT_THROW(triangulate(corners, {4, 2, 2}), InputError);
  EXPECT_THROW(triangulate(corners, {4}), InputError);
  EXPECT_THROW(triangulate(corners, {4, 5}), InputError);
}

TEST_F(Io, VertexNormalsAreWeightedByArea) {
  const std::vector<float> positions = {0, 0, 0, 2, 0, 0, 0, 0, -4, 0, 3, 0, 9, 9, 9};
  // Areas of 4 along +y and of 3 along +z meet at the edge between vertices 0 and 1.
  const std::vector<float> normals = vertex_normals({{0, 1, 2}, {0, 1, 3}}, positions);
  EXPECT_EQ(normals, (std::vector<float>{0, 0.8f, 0.6f, 0, 0.8f, 0.6f, 0, 1, 0, 0, 0, 1, 0, 1, 0}));
  EXPECT_THROW(vertex_normals({{0, 1, 5}}, positions), InputError);
  EXPECT_THROW(vertex_normals({{0, 1, -1}}, positions), InputError);
}

TEST_F(Io, PointCachesAreReadAsWritten) {
  const std::vector<std::vector<float>> frames = {{0, 1, 2, -0.0f, 4, 5}, {1e-30f, 1, 2, 3, 1e30f, 5}};
  for (const char* name : {"a.pc2", "a.mdd"}) {
    PointCacheWriter writer(path(name), 2, {0.5f, 0.75f});
    for (const std::vector<float>& frame : frames) writer.add_frame(frame);
    writer.finish();
    const PointCacheFile file(path(name));
    EXPECT_EQ(file.num_points(), 2);
    ASSERT_EQ(file.num_frames(), 2);
    for (int k = 0; k < 2; ++k) EXPECT_EQ(file.frame(k), frames[k]);
    EXPECT_TRUE(std::signbit(file.frame(0)[3]));
    EXPECT_THROW(file.frame(2), InputError);
    EXPECT_THROW(file.frame(-1), InputError);
  }
  EXPECT_EQ(PointCacheFile(path("a.mdd")).times(), (std::vector<float>{0.5f, 0.75f}));
  EXPECT_TRUE(PointCacheFile(path("a.pc2")).times().empty());
}

TEST_F(Io, IncompletePointCacheLeavesTheEarlierFile) {
  for (const char* name : {"a.pc2", "a.mdd"}) {
    std::ofstream(path(name)) << "earlier";
    PointCacheWriter writer(path(name), 1, {0, 1});
    writer.add_frame(std::vector<float>{0, 0, 0});
    EXPECT_THROW(writer.add_frame(std::vector<float>{0, 0}), InputError);
    EXPECT_THROW(writer.add_frame(std::vector<float>{0, std::numeric_limits<float>::infinity(), 0}),
                 InputError);
    EXPECT_THROW(writer.finish(), InputError);
    EXPECT_EQ(engine::read_text(path(name)), "earlier");
  }
  EXPECT_THROW(PointCacheWriter(path("a.txt"), 1, {}), InputError);
  EXPECT_THROW(PointCacheWriter(path("a.pc2"), 0, {}), InputError);
  EXPECT_FALSE(fs::exists(path("a.txt")));
}

}  // namespace
}  // namespace weft
