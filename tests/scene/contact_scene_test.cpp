/// Contact in scene files: thickness, deforming colliders.

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>

#include "tests/own_folder.h"
#include "weft/error.h"
#include "weft/io/obj_reader.h"
#include "weft/scene/scene_reader.h"
#include "weft/scene/scene_world.h"

namespace weft::engine {
namespace {

std::string sheet_with(const std::string& cells, const std::string& fabric) {
  return "[scene]\nformat = 1\n[[cloth]]\nname = \"sheet\"\ngrid = { size = [1, 1], cells = " + cells +
         " }\nfabric = " + fabric + "\n";
}

TEST(Thickness, MayBeMoreThanTheShortestEdge) {
  const SceneWorld built = build_world(
      parse_scene(sheet_with("[64, 16]", "{ spring_structural = 10, thickness = 0.02 }"), "scene.toml"),
      make_serial_jobs());
  EXPECT_EQ(built.world.model(built.world.cloth(0)).material.thickness, 0.02);
  EXPECT_TRUE(built.warnings.empty());
}

TEST(Thickness, NotGivenFollowsFromTheMesh) {
  const auto thickness = [](const std::string& cells) {
    const SceneWorld built = build_world(
        parse_scene(sheet_with(cells, "{ spring_structural = 10 }"), "scene.toml"), make_serial_jobs());
    return built.world.model(built.world.cloth(0)).material.thickness;
  };
  EXPECT_EQ(thickness("[50, 10]"), 1e-3);
  EXPECT_NEAR(thickness("[1000, 1000]"), 0.57e-3, 0.01e-3) << "half of (2 + √2)/3 mm";
}

TEST(ContactRules, OfASceneReachTheWorldAndSilenceTheWarning) {
  const std::string start = sheet_with("[4, 4]", "{ spring_structural = 10 }") +
                            "[[collider]]\nname = \"ball\"\nshape = \"sphere\"\ncenter = [0.5, 0, 0.5]\n"
                            "radius = 0.3\n";
  const auto build = [&](const std::string& rule) {
    return build_world(parse_scene(start + rule, "scene.toml"), make_serial_jobs());
  };
  EXPECT_EQ(build("").warnings.size(), 1u) << "the sheet starts inside the ball";
  const SceneWorld passing = build("[[contact]]\nbetween = [\"ball\", \"sheet\"]\ncollide = false\n");
  EXPECT_TRUE(passing.warnings.empty());
  using Pairs = std::vector<std::array<std::string, 2>>;
  EXPECT_EQ(passing.world.non_colliding_pairs(), (Pairs{{"sheet", "ball"}}));
  const SceneWorld rubbing = build("[[contact]]\nbetween = [\"ball\", \"sheet\"]\nfriction = 0.1\n");
  EXPECT_TRUE(rubbing.world.non_colliding_pairs().empty());
}

class DeformingMesh : public testing::Test {
 protected:
  void write(const std::string& name, const TriangleMesh& mesh) { write_obj(folder_ / name, mesh); }

  /// A box with its top at this height; its corners are sewn in the first frame.
  static TriangleMesh box(double height) {
    TriangleMesh mesh = make_box_mesh(Vec3::Zero(), Vec3::Constant(0.5), Mat3::Identity());
    for (Vec3& p : mesh.positions) p.y() = p.y() > 0 ? height : 0.0;
    return mesh;
  }

  SceneWorld build(const std::string& keys = "") {
    const std::string text = R"([scene]
format = 1
[[cloth]]
grid = { size = [1, 1], cells = [8, 8] }
position = [-0.5, 3, -0.5]
[[collider]]
name = "body"
shape = "mesh"
frames = "body_*.obj"
frame_rate = 4
)";
    return build_world(parse_scene(text + keys, folder_ / "scene.toml"), make_serial_jobs());
  }

  const std::filesystem::path folder_ = make_own_folder();
};

TEST_F(DeformingMesh, TakesFramesInTheOrderOfTheirNames) {
  write("body_02.obj", box(2));
  write("body_00.obj", box(1));
  write("body_01.obj", box(1.5));
  write("other.obj", box(7));
  const SceneWorld built = build("scale = 0.5\nposition = [0, 1, 0]\n");
  EXPECT_TRUE(built.warnings.empty()) << testing::PrintToString(built.warnings);
  const Collider& body = built.world.colliders().at(0);
  const auto top_at = [&](double time) {
    const ColliderShape now = shape_at(body, time);
    double top = 0;
    for (int v = 0; v < 8; ++v) top = std::max(top, std::get<MeshShape>(now).vertex(v).y());
    return top;
  };
  EXPECT_EQ(std::get<MeshShape>(body.shape).mesh->num_vertices(), 8) << "sewn";
  EXPECT_NEAR(top_at(0), 1.5, 1e-12);
  EXPECT_NEAR(top_at(0.25), 1.75, 1e-12);
  EXPECT_NEAR(top_at(0.375), 1.875, 1e-12);
  EXPECT_NEAR(top_at(5), 2, 1e-12);
}

/// The shorter diagonals of quads change while a body twists.
TEST_F(DeformingMesh, OfQuadsKeepsTheTrianglesOfTheFirstFrame) {
  const auto write_quads = [&](const std::string& name, double twist) {
    std::ofstream file(folder_ / name);
    for (const double y : {0.0, 1.0}) {
      for (int k = 0; k < 4; ++k) {
        const double angle = 1.5707963267948966 * k + twist * y;
        file << "v " << std::cos(angle) << ' ' << y << ' ' << std::sin(angle) << '\n';
      }
    }
    file << "f 1 2 3 4\nf 8 7 6 5\n";
    for (int k = 1; k <= 4; ++k)
      file << "f " << k << "/1 " << k + 4 << "//2 " << k % 4 + 5 << "/1/2 " << k % 4 - 8 << '\n';
  };
  write_quads("body_00.obj", -0.4);
  write_quads("body_01.obj", 0.4);
  const SceneWorld built = build();
  const Collider& body = built.world.colliders().at(0);
  EXPECT_EQ(std::get<MeshShape>(body.shape).mesh->num_triangles(), 12);
  const ColliderShape twisted = shape_at(body, 0.25);
  EXPECT_NEAR(std::get<MeshShape>(twisted).vertex(4).z(), std::sin(0.4), 1e-5);
}

TEST_F(DeformingMesh, OfAnotherTopologyIsRefusedWithFileFrameAndCounts) {
  write("body_00.obj", box(1));
  TriangleMesh other = box(2);
  other.triangles.pop_back();
  write("body_01.obj", other);
  try {
    build();
    FAIL();
  } catch (const InputError& error) {
    EXPECT_EQ(std::string(error.what()), "collider \"body\": frame 1: " + (folder_ / "body_01.obj").string() +
                                             ": has 11 faces, the first file 12; all files of a sequence "
                                             "must have the same vertices and faces, "
                                             "in the same order");
  }
}

}  // namespace
}  // namespace weft::engine
