#include "weft/io/gltf_body.h"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>

#include "tests/io/gltf_builder.h"
#include "tests/own_folder.h"
#include "weft/core/random.h"
#include "weft/io/glb_writer.h"

namespace weft::engine {
namespace {

using namespace test;
using Json = nlohmann::json;
using Positions = std::vector<Vec3>;

constexpr double kFloatRounding = 2.5e-7;  // a quaternion in floats: 6e-8 by component, and twice by products

Positions at(const GltfBody& body, double time) {
  Positions positions;
  body.vertices.evaluate(time, positions);
  return positions;
}

void expect_near(const Positions& actual, const Positions& expected, double tolerance) {
  ASSERT_EQ(actual.size(), expected.size());
  for (std::size_t v = 0; v < actual.size(); ++v) {
    EXPECT_LE((actual[v] - expected[v]).cwiseAbs().maxCoeff(), tolerance)
        << "vertex " << v << ": " << actual[v].transpose() << ", expected " << expected[v].transpose();
  }
}

// ---- Files ----

TEST(GltfBody, ReadsASkinnedArm) {
  const GltfBody body = parse(make_arm().glb());
  EXPECT_EQ(body.triangles, (std::vector<Triangle>{{0, 1, 2}}));
  EXPECT_TRUE(body.uv.empty());
  EXPECT_TRUE(body.warnings.empty());
  EXPECT_EQ(body.clip, "bend");
  EXPECT_EQ(body.vertices.start(), 0);
  EXPECT_EQ(body.vertices.end(), 1);
  EXPECT_EQ(at(body, 0), (Positions{{0.25, 0, 0}, {0.25, 1, 0.5}, {0.25, 2, 0}}));
  // The fore-arm maps (x, 1 + y) to (−y, 1 + x).
  expect_near(at(body, 1), {{0.25, 0, 0}, {0.125, 1.125, 0.5}, {-1, 1.25, 0}}, kFloatRounding);
  EXPECT_EQ(at(body, 7), at(body, 1));
  const double angle = 0.3 * std::acos(0.0), c = std::cos(angle), s = std::sin(angle);
  expect_near(at(body, 0.3),
              {{0.25, 0, 0}, {0.125 + 0.125 * c, 1 + 0.125 * s, 0.5}, {0.25 * c - s, 1 + 0.25 * s + c, 0}},
              kFloatRounding);
}

TEST(GltfBody, IsTheSameFromEveryKindOfFile) {
  const std::filesystem::path folder = make_own_folder();
  std::filesystem::create_directories(folder / "my data");
  const GltfBuilder arm = make_arm();
  const auto write = [&](const char* name, const std::string& bytes) {
    std::ofstream(folder / name, std::ios::binary) << bytes;
    return folder / name;
  };
  write("my data/arm#1.bin", arm.buffer + "and more than byteLength");
  const Positions expected = at(parse(arm.glb()), 0.4);
  for (const auto& file :
       {write("arm.glb", arm.glb()), write("embedded.gltf", arm.gltf()),
        write("outside.gltf", arm.gltf("my%20data/arm%231.bin")),
        write("other_type.gltf", arm.gltf("data:;base64," + GltfBuilder::base64(arm.buffer)))}) {
    EXPECT_EQ(at(read_gltf_body(file), 0.4), expected) << file;
    EXPECT_EQ(list_gltf(file).nodes, (std::vector<std::string>{"sleeve"})) << file;
  }
  EXPECT_EQ(at(parse("\xEF\xBB\xBF" + arm.gltf()), 0.4), expected) << "a byte order mark";
}

TEST(GltfBody, ReadsTheAnimationsThatWeftWrites) {
  const std::filesystem::path folder = make_own_folder();
  AnimatedCloth cloth{.name = "sheet", .triangles = {{0, 1, 2}}};
  AnimatedBody ball{.name = "ball", .mesh = make_sphere_mesh({0, 0, 0}, 0.3, 6)};
  for (int k = 0; k < 5; ++k) {
    const auto x = static_cast<float>(0.25 * k);
    cloth.frames.push_back({x, 0, 0, 1, x * x, 0, 0, 1, -x});
    ball.poses.push_back(
        {Vec3(0.1 * k, 0, 1), Eigen::Quaterniond(Eigen::AngleAxisd(0.2 * k, Vec3::UnitZ()))});
  }
  write_glb(folder / "animation.glb", {.frames_per_second = 8, .cloths = {cloth}, .bodies = {ball}});
  const GltfBody sheet = read_gltf_body(folder / "animation.glb", {.node = "sheet"});
  const GltfBody moving = read_gltf_body(folder / "animation.glb", {.node = "ball"});
  EXPECT_EQ(moving.triangles, ball.mesh.triangles);
  for (int k = 0; k < 5; ++k) {
    Positions expected;
    for (int v = 0; v < 3; ++v)
      expected.push_back(Eigen::Map<const Eigen::Vector3f>(&cloth.frames[k][3 * v]).cast<double>());
    EXPECT_EQ(at(sheet, k / 8.0), expected) << k;
    expected.clear();
    for (const Vec3& x : ball.mesh.positions)
      expected.push_back(ball.poses[k].rotation * x + ball.poses[k].translation);
    expect_near(at(moving, k / 8.0), expected, kFloatRounding);
  }
}

TEST(GltfBody, ListsNodesWithMeshesAndClips) {
  GltfBuilder arm = make_arm();
  arm.add("nodes", {{"mesh", 0}});
  arm.add("animations", Json::object());
  arm.add_channel(1, 1, "translation", arm.add_floats("SCALAR", {0.5f, 2, 4}),
                  arm.add_floats("VEC3", Floats(9)));
  arm.add_channel(1, 1, "scale", arm.add_floats("SCALAR", {0.25f}), arm.add_floats("VEC3", Floats(3)));
  const GltfContents contents = parse(arm.glb()).contents;
  EXPECT_EQ(contents.nodes, (std::vector<std::string>{"sleeve", "node 4"}));
  ASSERT_EQ(contents.clips.size(), 2u);
  EXPECT_EQ(contents.clips[0].name, "bend");
  EXPECT_EQ(contents.clips[0].seconds(), 1);
  EXPECT_EQ(contents.clips[1].name, "animation 1");
  EXPECT_EQ(contents.clips[1].start, 0.25);
  EXPECT_EQ(contents.clips[1].seconds(), 3.75);
}

TEST(GltfBody, TakesTheNamedNodeAndClip) {
  GltfBuilder file = make_triangle();
  file.json["nodes"] = {{{"name", "left"}, {"mesh", 0}, {"translation", {-5, 0, 0}}},
                        {{"name", "right"}, {"translation", {5, 0, 0}}, {"children", {2}}},
                        {{"name", "hand"}, {"mesh", 0}, {"translation", {1, 0, 0}}},
                        {{"name", "empty"}}};
  file.json["scenes"] = {{{"nodes", {0}}}, {{"nodes", {1}}}};
  file.json["scene"] = 1;
  file.json["animations"] = {{{"name", "rise"}}, {{"name", "fall"}}};
  const int times = file.add_floats("SCALAR", {0, 2});
  file.add_channel(0, 2, "translation", times, file.add_floats("VEC3", {0, 0, 0, 0, 4, 0}));
  file.add_channel(1, 2, "translation", times, file.add_floats("VEC3", {0, 0, 0, 0, -4, 0}));
  const auto first = [&](const GltfOptions& options, double time) {
    const GltfBody body = parse(file.glb(), options);
    EXPECT_EQ(body.vertices.num_vertices(), 3);
    return at(body, time)[0];
  };
  EXPECT_EQ(first({}, 1), Vec3(5, 2, 0)) << "the default scene, and the first clip";
  EXPECT_EQ(first({.clip = "fall"}, 1), Vec3(5, -2, 0));
  EXPECT_EQ(first({.node = "left"}, 1), Vec3(-5, 0, 0)) << "in another scene";
  EXPECT_EQ(first({.node = "right"}, 1), Vec3(5, 2, 0)) << "with its descendants";
  EXPECT_EQ(first({.node = "hand"}, 1), Vec3(5, 2, 0)) << "with its ancestors' transforms";

  EXPECT_EQ(complaint(file.glb(), {.clip = "fail"}),
            "made.glb: no clip is named \"fail\"; available: \"rise\", \"fall\"; did you mean \"fall\"?");
  EXPECT_EQ(complaint(file.glb(), {.clip = "walk around"}),
            "made.glb: no clip is named \"walk around\"; available: \"rise\", \"fall\"");
  EXPECT_EQ(complaint(file.glb(), {.node = "rigth"}),
            "made.glb: no node is named \"rigth\"; available: \"left\", \"hand\"; did you mean \"right\"?");
  EXPECT_EQ(
      complaint(file.glb(), {.node = "empty"}),
      "made.glb: node \"empty\" and those below it have no triangles; nodes with meshes: \"left\", \"hand\"");
  file.json["nodes"][3]["name"] = "left";
  EXPECT_EQ(complaint(file.glb(), {.node = "left"}), "made.glb: 2 nodes are named \"left\", expected one");
  file.json.erase("animations");
  EXPECT_EQ(complaint(file.glb(), {.clip = "rise"}), "made.glb: no clip is named \"rise\"; there are none");
}

TEST(GltfBody, WithoutScenesHasAllMeshes) {
  GltfBuilder file = make_triangle();
  file.add("nodes", {{"mesh", 0}, {"translation", {0, 0, 1}}});
  const GltfBody body = parse(file.glb());
  EXPECT_EQ(at(body, 0), (Positions{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, 0, 1}, {0, 1, 1}}));
  EXPECT_EQ(body.triangles, (std::vector<Triangle>{{0, 1, 2}, {3, 4, 5}}));
  EXPECT_EQ(body.clip, "");
}

// ---- Meshes ----

TEST(GltfBody, ReadsTrianglesStripsAndFans) {
  GltfBuilder file;
  const int position = file.add_floats("VEC3", {0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0, 0, 2, 0});
  const auto triangles = [&](Json fields) {
    fields["attributes"] = {{"POSITION", position}};
    file.json["meshes"] = {{{"primitives", {fields}}}};
    file.json["nodes"] = {{{"mesh", 0}}};
    return parse(file.glb()).triangles;
  };
  using Triangles = std::vector<Triangle>;
  const int bytes = file.add_accessor<std::uint8_t>("SCALAR", {4, 3, 2, 0, 1, 2});
  const int shorts = file.add_accessor<std::uint16_t>("SCALAR", {4, 3, 2, 0, 1, 2});
  const int words = file.add_accessor<std::uint32_t>("SCALAR", {4, 3, 2, 0, 1, 2});
  for (const int indices : {bytes, shorts, words}) {
    EXPECT_EQ(triangles({{"indices", indices}}), (Triangles{{4, 3, 2}, {0, 1, 2}}));
  }
  EXPECT_EQ(triangles({{"mode", 5}}), (Triangles{{0, 1, 2}, {1, 3, 2}, {2, 3, 4}}));
  EXPECT_EQ(triangles({{"mode", 6}}), (Triangles{{1, 2, 0}, {2, 3, 0}, {3, 4, 0}}));
  // A strip with a repeated vertex: two triangles have equal corners.
  const int repeated = file.add_accessor<std::uint8_t>("SCALAR", {0, 1, 2, 2, 3, 4});
  EXPECT_EQ(triangles({{"mode", 5}, {"indices", repeated}}), (Triangles{{0, 1, 2}, {2, 4, 3}}));
}

TEST(GltfBody, PrimitivesOfAMeshAreOneAfterAnother) {
  GltfBuilder file = make_triangle();
  const int other = file.add_floats("VEC3", {0, 0, 5, 1, 0, 5, 0, 1, 5, 1, 1, 5});
  const int uv = file.add_accessor<std::uint8_t>("VEC2", {0, 0, 255, 0, 0, 255, 51, 255}, true);
  Json& primitives = file.json["meshes"][0]["primitives"];
  primitives.push_back({{"attributes", {{"POSITION", other}, {"TEXCOORD_0", uv}}}, {"mode", 5}});
  const GltfBody body = parse(file.glb());
  EXPECT_EQ(at(body, 0),
            (Positions{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 5}, {1, 0, 5}, {0, 1, 5}, {1, 1, 5}}));
  EXPECT_EQ(body.triangles, (std::vector<Triangle>{{0, 1, 2}, {3, 4, 5}, {4, 6, 5}}));
  ASSERT_EQ(body.uv.size(), 7u);
  for (int v = 0; v < 3; ++v) EXPECT_TRUE(body.uv[v].array().isNaN().all());
  EXPECT_EQ(body.uv[4], Eigen::Vector2d(1, 0));
  EXPECT_EQ(body.uv[6], Eigen::Vector2d(0.2, 1));
}

TEST(GltfBody, PointsAndLinesAreIgnoredWithAWarning) {
  GltfBuilder file = make_triangle();
  for (const int mode : {0, 1, 3}) {
    file.json["meshes"][0]["primitives"].push_back(primitive(file));
    file.json["meshes"][0]["primitives"].back()["mode"] = mode;
  }
  const GltfBody body = parse(file.glb());
  EXPECT_EQ(body.vertices.num_vertices(), 3);
  EXPECT_EQ(body.warnings,
            (std::vector<std::string>{
                "made.glb: mesh 0, primitive 1: points and lines are ignored; 3 in the file"}));
  file.json["meshes"][0]["primitives"].erase(0);
  EXPECT_EQ(complaint(file.glb()), "made.glb: the default scene has no triangles");
}

TEST(GltfBody, ReadsInterleavedAttributesAtOffsets) {
  GltfBuilder file = make_triangle();
  // By vertex: a normal, the position, texture coordinates; after four bytes that belong to nothing.
  const int view = file.add_view(Floats{9, 7, 7, 7, 0, 0, 0,     0.5f, 0.25f,  //
                                        7, 7, 7, 1, 0, 0, 0.75f, 0,            //
                                        7, 7, 7, 0, 1, 0, 1,     1});
  file.json["bufferViews"][view]["byteStride"] = 32;
  const auto add = [&](int offset, const char* type) {
    return file.add("accessors", {{"bufferView", view},
                                  {"byteOffset", offset},
                                  {"componentType", 5126},
                                  {"count", 3},
                                  {"type", type}});
  };
  primitive(file)["attributes"] = {{"POSITION", add(16, "VEC3")}, {"TEXCOORD_0", add(28, "VEC2")}};
  const GltfBody body = parse(file.glb());
  EXPECT_EQ(at(body, 0), (Positions{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}));
  EXPECT_EQ(body.uv, (std::vector<Eigen::Vector2d>{{0.5, 0.25}, {0.75, 0}, {1, 1}}));
}

TEST(GltfBody, NodesPlaceUnskinnedMeshes) {
  GltfBuilder file = make_triangle();
  // World = T(1, 2, 3) · R(90° about z) · S(2, 3, 4) · T(1, 0, 0) · S(1, −1, 1).
  const double half = std::sqrt(0.5);
  file.json["nodes"] = {
      {{"children", {1}}, {"translation", {1, 2, 3}}, {"rotation", {0, 0, half, half}}, {"scale", {2, 3, 4}}},
      {{"mesh", 0}, {"translation", {1, 0, 0}}, {"scale", {1, -1, 1}}}};
  const Positions expected = {{1, 4, 3}, {1, 6, 3}, {4, 4, 3}};
  GltfBody body = parse(file.glb());
  expect_near(at(body, 0), expected, 1e-15);
  EXPECT_EQ(body.triangles, (std::vector<Triangle>{{0, 2, 1}})) << "mirrored: the other way round";
  // The same as matrices, column by column.
  file.json["nodes"][0] = {{"children", {1}}, {"matrix", {0, 2, 0, 0, -3, 0, 0, 0, 0, 0, 4, 0, 1, 2, 3, 1}}};
  file.json["nodes"][1] = {{"mesh", 0}, {"matrix", {1, 0, 0, 0, 0, -1, 0, 0, 0, 0, 1, 0, 1, 0, 0, 1}}};
  body = parse(file.glb());
  EXPECT_EQ(at(body, 0), expected);
  EXPECT_EQ(body.triangles, (std::vector<Triangle>{{0, 2, 1}}));
}

TEST(GltfBody, ReadsQuantisedCoordinates) {
  GltfBuilder file = make_triangle();
  primitive(file)["attributes"]["POSITION"] =
      file.add_accessor<std::int16_t>("VEC3", {0, 0, 0, 32767, 0, 0, 0, -32768, 0}, true);
  EXPECT_EQ(
      complaint(file.glb()),
      "made.glb: mesh 0, primitive 0: POSITION: accessor 1: component type SHORT normalized, expected FLOAT");
  file.json["extensionsUsed"] = file.json["extensionsRequired"] = {"KHR_mesh_quantization"};
  EXPECT_EQ(at(parse(file.glb()), 0), (Positions{{0, 0, 0}, {1, 0, 0}, {0, -1, 0}}));
  primitive(file)["attributes"]["POSITION"] =
      file.add_accessor<std::uint8_t>("VEC3", {0, 0, 0, 200, 0, 0, 0, 3, 0});
  EXPECT_EQ(at(parse(file.glb()), 0), (Positions{{0, 0, 0}, {200, 0, 0}, {0, 3, 0}}));
}

// ---- Skins ----

TEST(GltfBody, IgnoresTheTransformOfTheSkinnedNode) {
  GltfBuilder arm = make_arm();
  const Positions expected = at(parse(arm.glb()), 0.6);
  Json& sleeve = arm.json["nodes"][3];
  sleeve["translation"] = {7, 8, 9};
  sleeve["scale"] = {-2, 3, 4};
  EXPECT_EQ(at(parse(arm.glb()), 0.6), expected);
  arm.add_channel(0, 3, "translation", arm.add_floats("SCALAR", {0, 1}),
                  arm.add_floats("VEC3", {0, 0, 0, 5, 5, 5}));
  EXPECT_EQ(at(parse(arm.glb()), 0.6), expected);
  EXPECT_EQ(parse(arm.glb()).triangles, (std::vector<Triangle>{{0, 1, 2}}));
  arm.json["nodes"][0]["translation"] = {0, 0, 2};  // above the joints
  EXPECT_EQ(at(parse(arm.glb()), 0.6)[0], expected[0] + Vec3(0, 0, 2));
}

TEST(GltfBody, ReadsJointsAndWeightsOfAllTypes) {
  GltfBuilder arm = make_arm();
  Json& attributes = primitive(arm)["attributes"];
  const int shorts = arm.add_accessor<std::uint16_t>("VEC4", {0, 0, 0, 0, 0, 1, 0, 0, 1, 0, 0, 0});
  // 51/255 = 13107/65535 = 0.2, and 0.8. The third vertex's sum is 2/255, and stands for 1.
  const int bytes = arm.add_accessor<std::uint8_t>("VEC4", {255, 0, 0, 0, 204, 51, 0, 0, 2, 0, 0, 0}, true);
  const int words =
      arm.add_accessor<std::uint16_t>("VEC4", {65535, 0, 0, 0, 52428, 13107, 0, 0, 2, 0, 0, 0}, true);
  const int floats = arm.add_floats("VEC4", {3, 0, 0, 0, 4, 1, 0, 0, 0.25f, 0, 0, 0});
  for (const int weights : {bytes, words, floats}) {
    attributes["JOINTS_0"] = shorts;
    attributes["WEIGHTS_0"] = weights;
    const Positions bent = {{0.25, 0, 0}, {0.2, 1.05, 0.5}, {-1, 1.25, 0}};
    expect_near(at(parse(arm.glb()), 1), bent, kFloatRounding);
  }
}

TEST(GltfBody, VerticesHaveUpToEightJoints) {
  GltfBuilder file = make_triangle();
  Json& skin = file.json["skins"][0];
  std::vector<std::uint8_t> joints[2];
  Floats weights[2];
  file.add("animations", Json::object());
  const int times = file.add_floats("SCALAR", {0, 1});
  for (int j = 0; j < 8; ++j) {
    // Joint j moves by (j, j², 0), with the weight (j + 1) / 36.
    const int node = file.add("nodes", Json::object());
    skin["joints"].push_back(node);
    const auto x = static_cast<float>(j);
    file.add_channel(0, node, "translation", times, file.add_floats("VEC3", {0, 0, 0, x, x * x, 0}));
    joints[j / 4].push_back(static_cast<std::uint8_t>(j));
    weights[j / 4].push_back((x + 1) / 36);
  }
  for (int s = 0; s < 2; ++s) {
    Floats all = weights[s] + weights[s] + weights[s];
    std::vector<std::uint8_t> of_all;
    for (int v = 0; v < 3; ++v) of_all.insert(of_all.end(), joints[s].begin(), joints[s].end());
    primitive(file)["attributes"]["JOINTS_" + std::to_string(s)] = file.add_accessor("VEC4", of_all);
    primitive(file)["attributes"]["WEIGHTS_" + std::to_string(s)] = file.add_floats("VEC4", all);
  }
  file.json["nodes"][0]["skin"] = 0;
  // Σ j (j + 1) = 168, Σ j² (j + 1) = 924; weights in floats: 3e-8 of up to 26.
  const Vec3 moved(168 / 36.0, 924 / 36.0, 0);
  GltfBody body = parse(file.glb());
  expect_near(at(body, 1), {moved, moved + Vec3(1, 0, 0), moved + Vec3(0, 1, 0)}, 1e-6);
  EXPECT_TRUE(body.warnings.empty());
  primitive(file)["attributes"]["JOINTS_2"] = primitive(file)["attributes"]["JOINTS_0"];
  EXPECT_EQ(parse(file.glb()).warnings,
            (std::vector<std::string>{
                "made.glb: mesh 0, primitive 0: joints after the eighth of a vertex are ignored"}));
}

TEST(GltfBody, SkinsMayShareJoints) {
  GltfBuilder arm = make_arm();
  // A glove in coordinates a metre to the right, on the same joints in the other order.
  const int position = arm.add_floats("VEC3", {1.25f, 2, 0, 1.25f, 0, 0, 1.25f, 1, 0.5f});
  const int joints = arm.add_accessor<std::uint8_t>("VEC4", {0, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0});
  const int weights = arm.add_floats("VEC4", {1, 0, 0, 0, 1, 0, 0, 0, 0.5f, 0.5f, 0, 0});
  const int bind = arm.add_floats("MAT4", translation_matrix(-1, -1, 0) + translation_matrix(-1, 0, 0));
  arm.add("meshes",
          {{"primitives",
            {{{"attributes", {{"POSITION", position}, {"JOINTS_0", joints}, {"WEIGHTS_0", weights}}}}}}});
  arm.add("skins", {{"joints", {2, 1}}, {"inverseBindMatrices", bind}});
  arm.json["nodes"][0]["children"].push_back(arm.add("nodes", {{"mesh", 1}, {"skin", 1}}));
  const Positions bent = at(parse(arm.glb()), 1);
  ASSERT_EQ(bent.size(), 6u);
  EXPECT_EQ(bent[3], bent[2]);
  EXPECT_EQ(bent[4], bent[0]);
  EXPECT_EQ(bent[5], bent[1]);
}

TEST(GltfBody, WithoutInverseBindMatricesTheyAreIdentities) {
  GltfBuilder arm = make_arm();
  arm.json["skins"][0].erase("inverseBindMatrices");
  EXPECT_EQ(at(parse(arm.glb()), 0)[2], Vec3(0.25, 3, 0)) << "the elbow's height added once more";
}

TEST(GltfBody, VertexWithoutWeightsFollowsItsFirstJoint) {
  GltfBuilder arm = make_arm();
  primitive(arm)["attributes"]["WEIGHTS_0"] = arm.add_floats("VEC4", {1, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0});
  const GltfBody body = parse(arm.glb());
  expect_near(at(body, 1), {{0.25, 0, 0}, {0.25, 1, 0.5}, {-1, 1.25, 0}}, kFloatRounding);
  EXPECT_EQ(body.warnings,
            (std::vector<std::string>{"made.glb: mesh 0, primitive 0: vertices without joint weights follow "
                                      "their first joint; 2 in the file"}));
}

// ---- Morph targets ----

TEST(GltfBody, MorphTargetsHaveWeightsOfTheMeshTheNodeOrTheClip) {
  GltfBuilder file = make_triangle();
  const int up = file.add_floats("VEC3", {0, 0, 0, 0, 4, 0, 0, 0, 0});
  const int out = file.add_floats("VEC3", {0, 0, 0, 0, 0, 1, 0, 0, 2});
  primitive(file)["targets"] = {{{"POSITION", up}}, {{"POSITION", out}}, {{"NORMAL", out}}};
  const auto second = [&](double time) { return at(parse(file.glb()), time)[1]; };
  EXPECT_EQ(second(0), Vec3(1, 0, 0)) << "0 by default";
  file.json["meshes"][0]["weights"] = {0.5, 2, 1};
  EXPECT_EQ(second(0), Vec3(1, 2, 2));
  file.json["nodes"][0]["weights"] = {-0.25, 0, 1};
  EXPECT_EQ(second(0), Vec3(1, -1, 0));
  // By key: the weights of the three targets.
  file.add("animations", Json::object());
  const int times = file.add_floats("SCALAR", {1, 3});
  file.add_channel(0, 0, "weights", times, file.add_floats("SCALAR", {1, 0, 9, 0, 3, 9}));
  EXPECT_EQ(second(0), Vec3(1, 4, 0));
  EXPECT_EQ(second(2), Vec3(1, 2, 1.5));
  EXPECT_EQ(second(3), Vec3(1, 0, 3));
  EXPECT_EQ(at(parse(file.glb()), 3)[2], Vec3(0, 1, 6));
  file.json["animations"][0]["samplers"][0]["output"] =
      file.add_accessor<std::uint8_t>("SCALAR", {255, 0, 0, 51, 255, 0}, true);
  expect_near({second(3)}, {{1, 0.8, 1}}, 1e-15);
}

TEST(GltfBody, ReadsSparseAccessors) {
  GltfBuilder file = make_triangle();
  // A target without a buffer view is zeros, of which elements 1 and 2 are replaced.
  const int indices = file.add_view(std::vector<std::uint8_t>{1, 2});
  const int values = file.add_view(Floats{0, 4, 0, 0, 0, 2});
  Json target = {{"componentType", 5126}, {"count", 3}, {"type", "VEC3"}};
  target["sparse"] = {{"count", 2},
                      {"indices", {{"bufferView", indices}, {"componentType", 5121}}},
                      {"values", {{"bufferView", values}}}};
  Json empty = target;
  empty.erase("sparse");
  primitive(file)["targets"] = {{{"POSITION", file.add("accessors", target)}},
                                {{"POSITION", file.add("accessors", empty)}}};
  file.json["meshes"][0]["weights"] = {1, 1};
  EXPECT_EQ(at(parse(file.glb()), 0), (Positions{{0, 0, 0}, {1, 4, 0}, {0, 1, 2}}));
  // Positions with a buffer view, of which one is replaced.
  file.json["accessors"][0]["sparse"] = target["sparse"];
  file.json["accessors"][0]["sparse"]["count"] = 1;
  EXPECT_EQ(at(parse(file.glb()), 0), (Positions{{0, 0, 0}, {0, 8, 0}, {0, 1, 2}}));
}

// ---- Animation ----

TEST(GltfBody, InterpolatesByTheFormulasOfTheSpecification) {
  Random random(11);
  const std::vector<float> times = {0.5f, 0.75f, 2, 3.5f};
  const auto numbers = [&](std::size_t count) {
    Floats list(count);
    for (float& x : list) x = static_cast<float>(random.uniform(-2, 2));
    return list;
  };
  for (const char* interpolation : {"STEP", "LINEAR", "CUBICSPLINE"}) {
    const bool is_cubic = std::string(interpolation) == "CUBICSPLINE";
    const std::size_t rows = is_cubic ? 3 : 1;
    const Floats translations = numbers(4 * rows * 3), scales = numbers(4 * rows * 3),
                 weights = numbers(4 * rows * 2);
    GltfBuilder file = make_triangle();
    primitive(file)["targets"] = {{{"POSITION", file.add_floats("VEC3", {1, 0, 0, 0, 0, 0, 0, 0, 0})}},
                                  {{"POSITION", file.add_floats("VEC3", {0, 1, 1, 0, 0, 0, 0, 0, 0})}}};
    file.add("animations", Json::object());
    const int input = file.add_floats("SCALAR", times);
    file.add_channel(0, 0, "translation", input, file.add_floats("VEC3", translations), interpolation);
    file.add_channel(0, 0, "scale", input, file.add_floats("VEC3", scales), interpolation);
    file.add_channel(0, 0, "weights", input, file.add_floats("SCALAR", weights), interpolation);
    const GltfBody body = parse(file.glb());

    /// Appendix C of the specification, for component c of a value of n components.
    const auto value = [&](const Floats& output, std::size_t n, std::size_t c, double tc) -> double {
      const auto v = [&](std::size_t k) { return double(output[(is_cubic ? 3 * k + 1 : k) * n + c]); };
      if (tc <= times.front()) return v(0);
      if (tc >= times.back()) return v(3);
      std::size_t k = 0;
      while (times[k + 1] <= tc) ++k;
      const double td = double(times[k + 1]) - double(times[k]), t = (tc - double(times[k])) / td;
      if (std::string(interpolation) == "STEP") return v(k);
      if (!is_cubic) return (1 - t) * v(k) + t * v(k + 1);
      const double b = output[(3 * k + 2) * n + c], a = output[(3 * k + 3) * n + c];
      return (2 * t * t * t - 3 * t * t + 1) * v(k) + td * (t * t * t - 2 * t * t + t) * b +
             (-2 * t * t * t + 3 * t * t) * v(k + 1) + td * (t * t * t - t * t) * a;
    };
    for (int sample = 0; sample <= 160; ++sample) {
      const double time = sample / 40.0;
      const Vec3 morphed(value(weights, 2, 0, time), value(weights, 2, 1, time), value(weights, 2, 1, time));
      Vec3 expected;
      for (int c = 0; c < 3; ++c)
        expected[c] = value(translations, 3, c, time) + value(scales, 3, c, time) * morphed[c];
      // Sums of terms up to 10, rounded in another order.
      EXPECT_LT((at(body, time)[0] - expected).cwiseAbs().maxCoeff(), 2e-14)
          << interpolation << " at " << time;
    }
  }
}

TEST(GltfBody, RotatesAlongTheShortestArcAndNormalisesSplines) {
  GltfBuilder file = make_triangle();
  file.add("animations", Json::object());
  // From 0 to 60 degrees about z, with the opposite quaternion; then to 300 degrees, which is 120 the other way.
  const auto cosine = static_cast<float>(std::cos(std::acos(-1) / 6));
  const Floats turns = {0, 0, 0, 1, 0, 0, -0.5f, -cosine, 0, 0, -0.5f, cosine};
  file.add_channel(0, 0, "rotation", file.add_floats("SCALAR", {0, 1, 2}), file.add_floats("VEC4", turns));
  for (int sample = 0; sample <= 200; ++sample) {
    const double time = sample / 100.0, degree = std::acos(-1) / 180;
    const double angle = time < 1 ? 60 * time * degree : (60 - 120 * (time - 1)) * degree;
    EXPECT_LT((at(parse(file.glb()), time)[1] - Vec3(std::cos(angle), std::sin(angle), 0)).norm(),
              kFloatRounding)
        << time;
  }
  // By key: in-tangent, value, out-tangent. With flat tangents it is half of both halfway, normalised.
  file.json["animations"][0] = Json::object();
  const Floats spline = Floats(4) + Floats{0, 0, 0, 1} + Floats(8) + Floats{1, 0, 0, 0} + Floats(4);
  file.add_channel(0, 0, "rotation", file.add_floats("SCALAR", {0, 1}), file.add_floats("VEC4", spline),
                   "CUBICSPLINE");
  expect_near(at(parse(file.glb()), 0.5), {{0, 0, 0}, {1, 0, 0}, {0, 0, 1}}, 1e-15);
  // Rotations as fractions of 32767 and of 127.
  for (const int output : {file.add_accessor<std::int16_t>("VEC4", {0, 0, 0, 32767, 0, 0, -32767, 0}, true),
                           file.add_accessor<std::int8_t>("VEC4", {0, 0, 0, 127, 0, 0, -127, 0}, true)}) {
    file.json["animations"][0] = Json::object();
    file.add_channel(0, 0, "rotation", file.add_floats("SCALAR", {0, 1}), output);
    expect_near(at(parse(file.glb()), 1), {{0, 0, 0}, {-1, 0, 0}, {0, -1, 0}}, 1e-15);
  }
}

TEST(GltfBody, IgnoresChannelsOfExtensions) {
  GltfBuilder arm = make_arm();
  const Positions expected = at(parse(arm.glb()), 0.5);
  arm.add_channel(0, 2, "pointer", 5, 6);
  arm.add_channel(0, 2, "rotation", 5, 6);
  arm.json["animations"][0]["channels"][2]["target"].erase("node");
  const GltfBody body = parse(arm.glb());
  EXPECT_EQ(at(body, 0.5), expected);
  EXPECT_EQ(body.warnings,
            (std::vector<std::string>{"made.glb: animation 0, channel 1: channels other than "
                                      "translation, rotation, scale and weights are ignored"}));
}

}  // namespace
}  // namespace weft::engine
