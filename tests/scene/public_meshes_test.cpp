/// Meshes of the public interface: what is read is written back, and lists that do not fit are refused.

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "tests/own_folder.h"
#include "tests/read_text.h"
#include "weft/error.h"
#include "weft/io.h"

namespace weft {
namespace {

class PublicMeshes : public testing::Test {
 protected:
  std::string path(const std::string& name) const { return (folder_ / name).string(); }

  // A folder of its own for each test: they may run at the same time.
  std::filesystem::path folder_ = engine::make_own_folder();
};

const std::string kShirt =
    "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 2 0 0.1\nvt 0 0\nvt 0.5 0\nvt 0.5 1\n"
    "o shirt\ng front\nf 1/1 2/2 3/3 4/1\ng back\nf 2/1 5/2 3/3\ng front\nf 1/1 2/2 3/3\n";

TEST_F(PublicMeshes, FacesAreReadAndWrittenAsTheFileHasThem) {
  std::ofstream(path("shirt.obj")) << kShirt;
  const MeshFromFile read = read_mesh(path("shirt.obj"));
  EXPECT_EQ(read.faces.sizes, (std::vector<int>{4, 3, 3}));
  EXPECT_EQ(read.faces.corners, (std::vector<int>{0, 1, 2, 3, 1, 4, 2, 0, 1, 2}));
  EXPECT_EQ(read.faces.uv[2], (std::array<double, 2>{0.5, 1}));
  EXPECT_EQ(
      read.faces.groups,
      (std::vector<MeshGroup>{{"shirt", true, {0, 1, 2}}, {"front", false, {0, 2}}, {"back", false, {1}}}));
  EXPECT_EQ(read.mesh.num_triangles(), 4);
  write_mesh(path("again.obj"), read.mesh.positions, read.faces);
  EXPECT_EQ(engine::read_text(path("again.obj")), kShirt);
  write_obj(path("again.txt"), read.mesh.positions, read.faces);
  EXPECT_EQ(engine::read_text(path("again.txt")), kShirt);
  write_mesh(path("shirt.ply"), read.mesh.positions, read.faces);
  const MeshFaces ply = read_mesh(path("shirt.ply")).faces;
  EXPECT_EQ(ply.sizes, read.faces.sizes);
  EXPECT_EQ(ply.corners, read.faces.corners);
  EXPECT_EQ(ply.uv, read.faces.uv);
  EXPECT_TRUE(ply.groups.empty());
}

TEST_F(PublicMeshes, TrianglesAreFacesToo) {
  const TriangleMesh mesh{.positions = {{0, 0, 0}, {1, 0, 0}, {0, 0.1, 1}},
                          .triangles = {{0, 1, 2}},
                          .uv = {{{{0, 0}, {0.1, 0}, {0, 1}}}}};
  for (const char* name : {"a.obj", "a.ply"}) {
    write_mesh(path(name), mesh);
    const MeshFromFile read = read_mesh(path(name));
    EXPECT_EQ(read.mesh.triangles, mesh.triangles);
    EXPECT_EQ(read.mesh.uv, mesh.uv);
    EXPECT_EQ(read.faces.corners, (std::vector<int>{0, 1, 2}));
  }
}

TEST_F(PublicMeshes, ListsThatDoNotFitAreRefused) {
  const std::vector<Vec3> vertices(4);
  const auto failure = [&](const MeshFaces& faces) -> std::string {
    try {
      write_mesh(path("x.obj"), vertices, faces);
    } catch (const InputError& error) {
      return std::string(error.what()).substr(path("x.obj").size());
    }
    return "no error";
  };
  const std::vector<int> quad = {0, 1, 2, 3};
  EXPECT_EQ(failure({.sizes = {2, 2}, .corners = quad}), ": a face has 2 corners; expected 3 or more");
  EXPECT_EQ(failure({.sizes = {3}, .corners = quad}), ": the faces have 3 corners together, but there are 4");
  EXPECT_EQ(failure({.sizes = {4}, .corners = {0, 1, 2, 4}}), ": a face has vertex 4 of 4");
  EXPECT_EQ(failure({.sizes = {4}, .corners = quad, .uv = {{0, 0}}}),
            ": texture coordinates of 1 corners; expected 4 or none");
  const auto with = [&](std::vector<MeshGroup> groups) {
    return MeshFaces{.sizes = {3, 3}, .corners = {0, 1, 2, 0, 2, 3}, .groups = std::move(groups)};
  };
  EXPECT_EQ(failure(with({{"a", false, {}}})), ": group \"a\" has no faces");
  EXPECT_EQ(failure(with({{"a", false, {1, 0}}})),
            ": group \"a\" has face 0; expected ascending numbers from 0 to 1");
  EXPECT_EQ(failure(with({{"a", false, {0, 2}}})),
            ": group \"a\" has face 2; expected ascending numbers from 0 to 1");
  EXPECT_EQ(failure(with({{"a", true, {0, 1}}, {"b", true, {1}}})),
            ": face 1 is in two objects; expected one at most");
  EXPECT_EQ(failure(with({{"a", true, {0}}, {"b", true, {1}}, {"a", false, {0, 1}}})), "no error");
  EXPECT_EQ(failure(with({{"a b", false, {0}}})),
            " cannot be written: an OBJ file has no name 'a b'; expected one word without # and \\");
}

TEST_F(PublicMeshes, TrianglesThatDoNotFitAreRefused) {
  const TriangleMesh outside{.positions = {{0, 0, 0}, {1, 0, 0}}, .triangles = {{0, 1, 2}}};
  const TriangleMesh too_few{.positions = {{0, 0, 0}, {1, 0, 0}, {0, 0, 1}},
                             .triangles = {{0, 1, 2}, {2, 1, 0}},
                             .uv = {CornerUv()}};
  for (const char* name : {"a.obj", "a.ply"}) {
    EXPECT_THROW(write_mesh(path(name), outside), InputError);
    EXPECT_THROW(write_mesh(path(name), too_few), InputError);
  }
  EXPECT_THROW(write_obj(path("a.obj"), too_few), InputError);
}

}  // namespace
}  // namespace weft
