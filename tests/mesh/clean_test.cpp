#include "weft/mesh/clean.h"

#include <gtest/gtest.h>

#include <limits>

#include "weft/error.h"

namespace weft::engine {
namespace {

const TriangleMesh kSquare{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}}, {{0, 1, 2}, {2, 1, 3}}};

bool has_warning(const CleanMesh& clean, const std::string& words) {
  for (const std::string& warning : clean.warnings) {
    if (warning.find(words) != std::string::npos) return true;
  }
  return false;
}

TEST(CleanMesh, LeavesAGoodMeshAsItIs) {
  const CleanMesh clean = clean_mesh(kSquare);
  EXPECT_EQ(clean.mesh.positions, kSquare.positions);
  EXPECT_EQ(clean.mesh.triangles, kSquare.triangles);
  EXPECT_TRUE(clean.warnings.empty());
}

TEST(CleanMesh, RefusesWhatIsNotANumber) {
  TriangleMesh mesh = kSquare;
  mesh.positions[2].y() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(clean_mesh(mesh), InputError);
  mesh.positions[2].y() = std::numeric_limits<double>::infinity();
  EXPECT_THROW(clean_mesh(mesh), InputError);
}

TEST(CleanMesh, RefusesIndicesOutOfRangeAndEmptyMeshes) {
  TriangleMesh mesh = kSquare;
  mesh.triangles[1][2] = 4;
  EXPECT_THROW(clean_mesh(mesh), InputError);
  mesh.triangles[1][2] = -1;
  EXPECT_THROW(clean_mesh(mesh), InputError);
  EXPECT_THROW(clean_mesh({}), InputError);
  EXPECT_THROW(clean_mesh({kSquare.positions, {}}), InputError);
}

TEST(CleanMesh, DropsTrianglesWithoutAreaByName) {
  TriangleMesh mesh = kSquare;
  mesh.positions.push_back({2, 0, 0});
  mesh.triangles.push_back({0, 0, 1});  // a repeated corner
  mesh.triangles.push_back({0, 1, 4});  // three collinear
  const CleanMesh clean = clean_mesh(mesh);
  EXPECT_EQ(clean.mesh.num_triangles(), 2);
  EXPECT_TRUE(has_warning(clean, "2 degenerate triangles"));
  EXPECT_TRUE(has_warning(clean, "1 unused vertices"));
  EXPECT_THROW(clean_mesh({kSquare.positions, {{0, 0, 1}}}), InputError);
}

TEST(CleanMesh, DropsRepeatedTrianglesAndIsolatedVertices) {
  TriangleMesh mesh = kSquare;
  mesh.positions.insert(mesh.positions.begin(), Vec3(5, 5, 5));
  for (Triangle& tri : mesh.triangles) {
    for (int& v : tri) ++v;
  }
  mesh.triangles.push_back({2, 3, 1});  // the first again, rotated
  const CleanMesh clean = clean_mesh(mesh);
  EXPECT_EQ(clean.mesh.positions, kSquare.positions);
  EXPECT_EQ(clean.mesh.triangles, kSquare.triangles);
  EXPECT_EQ(clean.vertex_of_source, (std::vector<int>{-1, 0, 1, 2, 3}));
  EXPECT_TRUE(has_warning(clean, "duplicate triangles"));
  EXPECT_TRUE(has_warning(clean, "unused vertices"));
}

TEST(CleanMesh, TellsOfSeamsAndSewsThemOnRequest) {
  // Two adjacent squares with a duplicate edge at x = 1, one of its vertices slightly off.
  TriangleMesh mesh = kSquare;
  for (const Vec3& p : kSquare.positions) mesh.positions.push_back(p + Vec3(1, 0, 0));
  for (const auto& [a, b, c] : kSquare.triangles) mesh.triangles.push_back({a + 4, b + 4, c + 4});
  mesh.positions[6].z() = 1e-7;
  EXPECT_TRUE(has_warning(clean_mesh(mesh), "1 vertices coincide with another one"));

  const CleanMesh sewn = clean_mesh(mesh, {.weld_distance = 1e-6});
  EXPECT_EQ(sewn.mesh.num_vertices(), 6);
  EXPECT_EQ(sewn.mesh.num_triangles(), 4);
  EXPECT_EQ(sewn.vertex_of_source[4], 1);
  EXPECT_EQ(sewn.vertex_of_source[6], 3);
  EXPECT_EQ(sewn.mesh.positions[3], kSquare.positions[3]) << "the lowest index keeps its place";
  EXPECT_TRUE(sewn.warnings.empty());
}

TEST(CleanMesh, TellsOfWeldedVerticesAndOfLayersThatWeldJoined) {
  TriangleMesh mesh = kSquare;
  for (const Vec3& p : kSquare.positions) mesh.positions.push_back(p + Vec3(0, 0.001, 0));  // a lining
  for (const auto& [a, b, c] : kSquare.triangles) mesh.triangles.push_back({a + 4, b + 4, c + 4});
  const CleanMesh joined = clean_mesh(mesh, {.weld_distance = 0.004});
  EXPECT_EQ(joined.notes, std::vector<std::string>{"welded 4 vertices to others"});
  EXPECT_TRUE(has_warning(
      joined, "2 duplicate triangles were removed: weld joined layers that are nearer than 4 mm"));
  EXPECT_TRUE(clean_mesh(mesh, {.weld_distance = 1e-6}).notes.empty());
  TriangleMesh twice = kSquare;
  twice.triangles.push_back(kSquare.triangles[0]);
  for (const std::string& warning : clean_mesh(twice, {.weld_distance = 1e-6}).warnings)
    EXPECT_EQ(warning, "1 duplicate triangles were removed");
}

TEST(CleanMesh, NamesNonManifoldEdges) {
  TriangleMesh mesh = kSquare;
  mesh.positions.push_back({0.5, 0.5, 1});
  mesh.triangles.push_back({1, 2, 4});
  EXPECT_TRUE(has_warning(clean_mesh(mesh), "1 edges belong to more than two triangles"));
}

TEST(CleanMesh, EndsWhereABorderIsMuchShorterThanASeamMayBe) {
  // The border of the second triangle was followed round by round, for as long as a seam may be.
  const TriangleMesh mesh{.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1e-10, 0, 0}, {0, 1e-10, 0}},
                          .triangles = {{0, 1, 2}, {0, 3, 4}}};
  EXPECT_EQ(clean_mesh(mesh).mesh.num_triangles(), 2);
}

}  // namespace
}  // namespace weft::engine
