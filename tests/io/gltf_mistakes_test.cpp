/// Mistakes in glTF files: each has one message, which begins with the place.

#include <gtest/gtest.h>

#include <cstring>
#include <filesystem>
#include <fstream>
#include <limits>

#include "tests/io/gltf_builder.h"
#include "tests/own_folder.h"

namespace weft::engine {
namespace {

using namespace test;
using Json = nlohmann::json;

/// A member of make_arm() with another value; null: without a value.
struct Change {
  std::string member;  // JSON pointer
  Json value;
  std::string message;  // its beginning, after the file name
};

void expect_message(const GltfBuilder& file, const std::string& start) {
  const std::string message = complaint(file.glb());
  EXPECT_TRUE(message.starts_with("made.glb: " + start)) << message << "\nexpected\nmade.glb: " << start;
}

void expect_messages(const std::vector<Change>& changes) {
  for (const auto& [member, value, message] : changes) {
    GltfBuilder arm = make_arm();
    arm.json[Json::json_pointer(member)] = value;
    expect_message(arm, message);
  }
}

// Accessors of make_arm(): 0 positions, 1 joints, 2 weights, 3 indices, 4 matrices, 5 times, 6 rotations.
// Each has the buffer view of the same number.

const std::string kPrimitive = "mesh 0, primitive 0: ", kPosition = kPrimitive + "POSITION: accessor 0: ",
                  kAttributes = "/meshes/0/primitives/0/attributes",
                  kChannel = "animation 0, channel 0: ", kOutput = "animation 0, channel 0, sampler 0: ";

TEST(GltfMistakes, OfAccessors) {
  ASSERT_EQ(complaint(make_arm().glb()), "");
  expect_messages({
      {"/accessors/0/type", "VEC2", kPosition + "type is \"VEC2\", expected \"VEC3\""},
      {"/accessors/0/componentType", 5123, kPosition + "component type UNSIGNED_SHORT, expected FLOAT"},
      {"/accessors/0/componentType", 5130, kPosition + "component type 5130, expected FLOAT"},
      {"/accessors/0/componentType", Json(), kPosition + "componentType: expected a whole number, 0 or more"},
      {"/accessors/2/componentType", 5121,
       kPrimitive + "WEIGHTS_0: accessor 2: component type UNSIGNED_BYTE, expected FLOAT, UNSIGNED_BYTE "
                    "normalized or UNSIGNED_SHORT normalized"},
      {"/accessors/1/normalized", true,
       kPrimitive +
           "JOINTS_0: accessor 1: component type UNSIGNED_BYTE normalized, expected UNSIGNED_BYTE or "
           "UNSIGNED_SHORT"},
      {"/accessors/1/normalized", 1, kPrimitive + "JOINTS_0: accessor 1: normalized: expected true or false"},
      {"/accessors/0/count", 4,
       kPosition + "4 elements of 12 bytes at byteOffset 0 exceed the 36 bytes of bufferView 0"},
      {"/accessors/0/count", 1537228672809129304,
       kPosition + "1537228672809129304 elements"},  // 2^64 + 32 bytes
      {"/accessors/0/count", -3, kPrimitive + "POSITION: count: expected a whole number, 0 or more"},
      {"/accessors/0/count", 2.5, kPrimitive + "POSITION: count: expected a whole number, 0 or more"},
      {"/accessors/0/count", 0, kPosition + "count is 0, expected 1 or more"},
      {"/accessors/0/byteOffset", 4,
       kPosition + "3 elements of 12 bytes at byteOffset 4 exceed the 36 bytes"},
      {"/accessors/0/byteOffset", 18446744073709551612u,
       kPosition + "3 elements of 12 bytes at byteOffset 18446744073709551612 exceed"},
      {"/accessors/0/bufferView", Json(), kPosition + "bufferView is missing"},
      {"/accessors/0/bufferView", 7, kPosition + "bufferView: 7 does not exist; there are 7, from 0"},
      {"/bufferViews/0/byteStride", 8, kPosition + "bufferView 0: byteStride is 8, expected 12 to 252"},
      {"/bufferViews/0/byteStride", 16, kPosition + "3 elements of 12 bytes at byteOffset 0 exceed"},
      {"/bufferViews/0/byteStride", 256, kPosition + "bufferView 0: byteStride is 256, expected 12 to 252"},
      {"/bufferViews/0/byteLength", 1000000,
       kPosition + "bufferView 0: byteOffset 0 and byteLength 1000000 exceed the "},
      {"/bufferViews/0/byteOffset", 18446744073709551615u,
       kPosition + "bufferView 0: byteOffset 18446744073709551615 and byteLength 36 exceed the "},
      {"/bufferViews/0/buffer", 1, kPosition + "bufferView 0: buffer: 1 does not exist; there are 1, from 0"},
      {"/bufferViews/0/buffer", Json(), kPosition + "bufferView 0: buffer is missing"},
  });
}

TEST(GltfMistakes, OfSparseAccessors) {
  GltfBuilder arm = make_arm();
  const int indices = arm.add_view(std::vector<std::uint8_t>{1, 1, 3});
  const auto expect = [&](int count, const Json& where, int values_at, const std::string& message) {
    arm.json["accessors"][0]["sparse"] = {
        {"count", count}, {"indices", where}, {"values", {{"bufferView", 0}, {"byteOffset", values_at}}}};
    expect_message(arm, kPosition + "sparse: " + message);
  };
  const Json good = {{"bufferView", indices}, {"componentType", 5121}};
  expect(4, good, 0, "count is 4, expected 1 to 3");
  expect(0, good, 0, "count is 0, expected 1 to 3");
  expect(2, good, 0, "indices: index 1 is 1, expected increasing ones below 3");
  expect(1, good, 28, "values: 1 elements of 12 bytes at byteOffset 28 exceed the 36 bytes of bufferView 0");
  Json bad = good;
  bad["byteOffset"] = 2;
  expect(1, bad, 0, "indices: index 0 is 3, expected increasing ones below 3");
  expect(2, bad, 0, "indices: 2 elements of 1 bytes at byteOffset 2 exceed the 3 bytes of bufferView 7");
  bad["componentType"] = 5126;
  expect(1, bad, 0, "indices: component type FLOAT, expected UNSIGNED_BYTE, UNSIGNED_SHORT or UNSIGNED_INT");
  expect_messages({{"/accessors/0/sparse", 3, kPosition + "sparse: expected an object {…}"}});
}

TEST(GltfMistakes, OfNumbers) {
  constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  struct Number {
    std::size_t accessor, index;
    float value;
    std::string message;
  };
  const std::vector<Number> numbers = {
      {0, 4, kNan, kPosition + "element 1 has a number that is not finite"},
      {2, 0, kInfinity, kPrimitive + "WEIGHTS_0: accessor 2: element 0 has a number that is not finite"},
      {2, 5, -0.5f, kPrimitive + "WEIGHTS_0: vertex 1 has a negative weight, expected 0 or more"},
      {4, 17, -kInfinity,
       "skin 0: inverseBindMatrices: accessor 4: element 1 has a number that is not finite"},
      {4, 19, 0.5f, "skin 0: inverseBindMatrices: element 1: the last row of the matrix is not 0 0 0 1"},
      {5, 1, kNan, "animation 0, sampler 0: input: accessor 5: element 1 has a number that is not finite"},
      {5, 1, 0, "animation 0, sampler 0: input: key 1 is not later than the previous one"},
      {5, 0, 2, "animation 0, sampler 0: input: key 1 is not later than the previous one"},
      {6, 7, kInfinity, kOutput + "output: accessor 6: element 1 has a number that is not finite"},
      {6, 3, 0, kChannel + "the rotation of key 0 is 0, expected a unit quaternion"},
  };
  for (const auto& [accessor, index, value, message] : numbers) {
    GltfBuilder arm = make_arm();
    const std::size_t begin = arm.json["bufferViews"][accessor]["byteOffset"];
    std::memcpy(&arm.buffer[begin + 4 * index], &value, 4);
    expect_message(arm, message);
  }
}

TEST(GltfMistakes, OfMeshes) {
  expect_messages({
      {"/meshes", {3}, "meshes: expected a list of objects"},
      {"/meshes/0/primitives", 3, "mesh 0: primitives: expected a list of objects"},
      {"/meshes/0/weights", {1}, "mesh 0: weights: expected 0 numbers"},
      {"/meshes/0/primitives/0/mode", 7, kPrimitive + "mode is 7, expected 0 to 6"},
      {kAttributes, Json(), kPrimitive + "attributes: expected an object {…}"},
      {kAttributes + "/POSITION", Json(), kPrimitive + "POSITION: is missing"},
      {kAttributes + "/POSITION", 70, kPrimitive + "POSITION: 70 does not exist; there are 7, from 0"},
      {kAttributes + "/POSITION", "0", kPrimitive + "POSITION: expected a whole number, 0 or more"},
      {kAttributes + "/TEXCOORD_0", 0,
       kPrimitive + "TEXCOORD_0: accessor 0: type is \"VEC3\", expected \"VEC2\""},
      {kAttributes + "/JOINTS_0", Json(), kPrimitive + "JOINTS_0: is missing"},
      {kAttributes + "/WEIGHTS_0", Json(), kPrimitive + "WEIGHTS_0: is missing"},
      {kAttributes + "/JOINTS_1", 1, kPrimitive + "WEIGHTS_1: is missing"},
      {"/accessors/2/count", 2,
       kPrimitive + "WEIGHTS_0: has 2 elements, expected one for each of the 3 vertices"},
      {"/meshes/0/primitives/0/indices", 0,
       kPrimitive + "indices: accessor 0: type is \"VEC3\", expected \"SCALAR\""},
      {"/meshes/0/primitives/0/indices", 5,
       kPrimitive + "indices: accessor 5: component type FLOAT, expected UNSIGNED_BYTE, UNSIGNED_SHORT or "
                    "UNSIGNED_INT"},
      {"/accessors/3/count", 2, kPrimitive + "indices: there are 2, expected a multiple of 3"},
      {"/meshes/0/primitives/0/targets",
       {{{"POSITION", 2}}},
       kPrimitive.substr(0, kPrimitive.size() - 2) + ", target 0: POSITION: accessor 2: type is \"VEC4\""},
  });
  GltfBuilder arm = make_arm();
  arm.buffer[arm.json["bufferViews"][1]["byteOffset"].get<std::size_t>() + 7] = 2;
  expect_message(arm, kPrimitive + "JOINTS_0: vertex 1 has joint 2, but the skin has 2");
  arm = make_arm();
  arm.buffer[arm.json["bufferViews"][3]["byteOffset"].get<std::size_t>() + 2] = 3;
  expect_message(arm, kPrimitive + "indices: number 1 is 3, but there are 3 vertices");
  arm = make_arm();
  arm.json["accessors"][3]["count"] = 2;
  primitive(arm)["mode"] = 5;
  expect_message(arm, kPrimitive + "indices: there are 2, expected 3 or more");
  arm = make_arm();
  primitive(arm)["targets"] = {{{"POSITION", arm.add_floats("VEC3", Floats(6))}}};
  expect_message(arm,
                 "mesh 0, primitive 0, target 0: POSITION: has 2 elements, expected one for each of the 3");
  arm.json["meshes"][0]["primitives"].push_back(make_arm().json["meshes"][0]["primitives"][0]);
  primitive(arm)["targets"] = {{{"POSITION", 0}}};
  expect_message(arm, "mesh 0, primitive 1: has 0 morph targets, but the mesh's first primitive has 1");
}

TEST(GltfMistakes, OfNodesAndSkins) {
  expect_messages({
      {"/nodes/3/mesh", 1, "node 3: mesh: 1 does not exist; there are 1, from 0"},
      {"/nodes/3/skin", 1, "node 3: skin: 1 does not exist; there are 1, from 0"},
      {"/nodes/3/weights", {1}, "node 3: weights: expected 0 numbers"},
      {"/nodes/2/name", 2, "node 2: name: expected a text in quotes"},
      {"/nodes/2/children", {1}, "node 1: is a child of node 0 and of node 2"},
      {"/nodes/0/children", {1, 1}, "node 1: is a child of node 0 and of node 0"},
      {"/nodes/2/children", {0}, "node 0: is its own ancestor"},
      {"/nodes/4", {{"children", {4}}}, "node 4: is its own ancestor"},
      {"/nodes/2/children", {4}, "node 2: children: 4 does not exist; there are 4, from 0"},
      {"/nodes/2/children", 3, "node 2: children: expected a list of whole numbers"},
      {"/nodes/2/translation", {1, 2}, "node 2: translation: expected 3 numbers"},
      {"/nodes/2/scale", {1, 2, "3"}, "node 2: scale: expected 3 numbers"},
      {"/nodes/2/rotation", {0, 0, 0, 0}, "node 2: rotation: expected a quaternion other than 0"},
      {"/nodes/1/matrix", std::vector<int>(16, 1),
       "node 1: matrix: the last row of the matrix is not 0 0 0 1"},
      {"/nodes/2/matrix", kIdentity, "node 2: has a matrix and a translation"},
      {"/nodes/2", {{"matrix", kIdentity}}, kChannel + "animates node 2, which has a matrix"},
      {"/skins/0/joints", Json::array(), "skin 0: joints: expected one node or more"},
      {"/skins/0/joints", {1, 9}, "skin 0: joints: 9 does not exist; there are 4, from 0"},
      {"/skins/0/joints",
       {1, 2, 3},
       "skin 0: inverseBindMatrices: has 2 matrices, but the skin has 3 joints"},
      {"/skins/0/inverseBindMatrices", 0,
       "skin 0: inverseBindMatrices: accessor 0: type is \"VEC3\", expected \"MAT4\""},
      {"/scene", 1, "scene: 1 does not exist; there are 1, from 0"},
      {"/scenes/0/nodes", {4}, "scene 0: nodes: 4 does not exist; there are 4, from 0"},
  });
}

TEST(GltfMistakes, OfAnimations) {
  expect_messages({
      {"/animations/0/samplers/0/input", Json(), "animation 0, sampler 0: input is missing"},
      {"/animations/0/samplers/0/output", Json(), kOutput + "output is missing"},
      {"/animations/0/samplers/0/output", 0,
       kOutput + "output: accessor 0: type is \"VEC3\", expected \"VEC4\""},
      {"/animations/0/samplers/0/interpolation", "SMOOTH",
       kOutput + "interpolation is \"SMOOTH\", expected LINEAR, STEP or CUBICSPLINE"},
      {"/animations/0/samplers/0/interpolation", "CUBICSPLINE",
       kOutput + "output: has 8 numbers, expected 24 for 2 keys"},
      {"/animations/0/channels/0/sampler", 1, kChannel + "sampler: 1 does not exist; there are 1, from 0"},
      {"/animations/0/channels/0/sampler", Json(), kChannel + "sampler is missing"},
      {"/animations/0/channels/0/target", Json(), kChannel + "target: expected an object {…}"},
      {"/animations/0/channels/0/target/node", 4, kChannel + "node: 4 does not exist; there are 4, from 0"},
      {"/animations/0/channels/0/target",
       {{"node", 3}, {"path", "weights"}},
       kChannel + "animates morph targets of node 3, which has none"},
      {"/animations/0/channels/0/target",
       {{"node", 1}, {"path", "weights"}},
       kChannel + "animates morph targets of node 1, which has none"},
  });
  GltfBuilder arm = make_arm();
  arm.add_channel(0, 2, "rotation", 5, 6);
  expect_message(arm, "animation 0, channel 1: animates the rotation of node 2 once more");
}

TEST(GltfMistakes, OfVersionsAndExtensions) {
  expect_messages({
      {"/asset/version", "1.0", "asset: version is \"1.0\", expected \"2.0\""},
      {"/asset", Json(), "asset: expected an object {…}"},
      {"/extensionsRequired",
       {"KHR_draco_mesh_compression"},
       "extensionsRequired: \"KHR_draco_mesh_compression\" is not supported; expected a file without "
       "compression"},
      {"/extensionsRequired",
       {"KHR_materials_unlit", "EXT_meshopt_compression"},
       "extensionsRequired: \"EXT_meshopt_compression\" is not supported; expected a file without "
       "compression"},
      {"/extensionsRequired",
       {"EXT_mesh_gpu_instancing"},
       "extensionsRequired: \"EXT_mesh_gpu_instancing\" is not supported; expected a file without it"},
  });
}

TEST(GltfMistakes, OfTheContainerHaveTheirByte) {
  const std::string whole = make_arm().glb();
  const auto message = [&](std::size_t at, const std::string& word) {
    std::string bytes = whole;
    bytes.replace(at, word.size(), word);
    return complaint(bytes);
  };
  const std::size_t size = whole.size(), binary = whole.find(std::string("BIN\0", 4)) - 4;
  EXPECT_EQ(complaint(whole.substr(0, 7)),
            "made.glb: byte 7: the file ends, expected a .glb header of 12 bytes");
  EXPECT_EQ(message(4, GltfBuilder::word(1)), "made.glb: byte 4: version 1, expected 2");
  EXPECT_EQ(complaint(whole.substr(0, size - 1)), "made.glb: byte 8: length is " + std::to_string(size) +
                                                      ", but the file has " + std::to_string(size - 1) +
                                                      " bytes");
  EXPECT_EQ(message(8, GltfBuilder::word(11)),
            "made.glb: byte 8: length is 11, but the file has " + std::to_string(size) + " bytes");
  EXPECT_EQ(message(8, GltfBuilder::word(15)),
            "made.glb: byte 12: the file ends, expected a chunk header of 8 bytes");
  EXPECT_EQ(message(12, GltfBuilder::word(0xffffffff)),
            "made.glb: byte 12: a chunk of 4294967295 bytes, but " + std::to_string(size - 20) + " follow");
  EXPECT_EQ(message(16, "BIN "), "made.glb: byte 16: expected the JSON chunk");
  EXPECT_EQ(message(20, "?"), "made.glb: byte 20: this is not JSON; expected a glTF 2.0 file");
  EXPECT_EQ(
      message(binary + 4, "more"),
      "made.glb: animation 0, sampler 0: input: accessor 5: bufferView 5: byteOffset 232 and byteLength 8 "
      "exceed the 0 bytes of buffer 0")
      << "chunks of other kinds are ignored";
  for (std::size_t part = 0; part < size; part += 97) EXPECT_NE(complaint(whole.substr(0, part)), "") << part;
}

TEST(GltfMistakes, OfTheTextHaveTheirLine) {
  EXPECT_EQ(complaint(""), "made.glb:1: this is not JSON; expected a glTF 2.0 file");
  EXPECT_EQ(complaint("solid ball"), "made.glb:1: this is not JSON; expected a glTF 2.0 file");
  EXPECT_EQ(complaint("{\n\n\"asset\" 2}"), "made.glb:3: this is not JSON; expected a glTF 2.0 file");
  EXPECT_EQ(complaint("[]"), "made.glb: its JSON text is not an object; expected a glTF 2.0 file");
  EXPECT_EQ(complaint("{\"asset\": {\"version\": 2.0e999}}"),
            "made.glb: a number in its JSON text is too large");
  // Brackets in brackets: no recursion.
  const std::string nested = std::string(1'000'000, '[') + std::string(1'000'000, ']');
  EXPECT_EQ(complaint("{\"asset\":{\"version\":\"2.0\"},\"extras\":" + nested + "}"),
            "made.glb: the default scene has no triangles");
  EXPECT_EQ(complaint("{\"asset\":{\"version\":\"2.0\"},\"extensionsRequired\":[" + nested + "]}"),
            "made.glb: extensionsRequired: \"\" is not supported; expected a file without it");
}

TEST(GltfMistakes, OfBuffersOutsideTheFile) {
  const GltfBuilder arm = make_arm();
  const std::filesystem::path folder = make_own_folder() / "inner";
  std::filesystem::create_directories(folder);
  std::ofstream(folder.parent_path() / "secret.bin", std::ios::binary) << arm.buffer;
  std::ofstream(folder / "short.bin", std::ios::binary) << arm.buffer.substr(1);
  const std::string file = (folder / "broken.gltf").string(), place = file + ": buffer 0: ";
  const auto message = [&](const std::string& uri) -> std::string {
    std::ofstream(file, std::ios::binary) << arm.gltf(uri);
    try {
      read_gltf_body(file);
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  };
  const std::string length = "byteLength is " + std::to_string(arm.buffer.size()) + ", but it has ";
  EXPECT_EQ(message("short.bin"), place + length + std::to_string(arm.buffer.size() - 1) + " bytes");
  EXPECT_EQ(message("data:;base64,AAAA"), place + length + "3 bytes");
  EXPECT_EQ(message("none.bin"),
            place + (folder / "none.bin").string() + ": cannot be read: No such file or directory");
  EXPECT_EQ(message("."), place + (folder / "").string() + ": cannot be read: it is a folder");
  const std::string expected = ", expected a file in the folder of the .gltf file or below";
  for (const std::string uri : {"../secret.bin", "a/%2e%2e/../secret.bin", "/etc/passwd", "file:secret.bin",
                                "%00", "%4", "..\\secret.bin"}) {
    EXPECT_EQ(message(uri), place + "uri is \"" + uri + "\"" + expected);
  }
  EXPECT_EQ(complaint(arm.gltf("short.bin")), "made.glb: buffer 0: uri is \"short.bin\"" + expected);
  for (const char* uri : {"data:text/plain,abc", "data:;base64,ab*d", "data:"}) {
    EXPECT_EQ(message(uri), place + "its data URI is not base64") << uri;
  }
  EXPECT_EQ(message(""), file +
                             ": animation 0, sampler 0: input: accessor 5: bufferView 5: byteOffset 232 and "
                             "byteLength 8 exceed the 0 bytes of buffer 0");
  EXPECT_THROW(read_gltf_body(folder / "none.glb"), InputError);
  EXPECT_THROW(read_gltf_body(folder), InputError);
}

TEST(GltfMistakes, ShortFileCannotFillTheMemory) {
  // A short text that refers 5000 times to the same 50 000 vertices.
  GltfBuilder file;
  const Json again = {{"attributes", {{"POSITION", file.add_floats("VEC3", Floats(150'000))}}}, {"mode", 5}};
  file.add("meshes", {{"primitives", Json(5000, again)}});
  file.add("nodes", {{"mesh", 0}});
  EXPECT_TRUE(complaint(file.glb())
                  .ends_with("POSITION: the file repeats its data: it stands for more numbers than the limit "
                             "for its size, 16777216"));
  // Accessors without data, of any size.
  GltfBuilder empty = make_triangle();
  const int zeros = empty.add("accessors", {{"componentType", 5126}, {"count", 1e15}, {"type", "VEC3"}});
  primitive(empty)["targets"] = {{{"POSITION", zeros}}};
  expect_message(empty,
                 "mesh 0, primitive 0, target 0: POSITION: has 1000000000000000 elements, expected one");
  primitive(empty)["attributes"]["POSITION"] = zeros;
  expect_message(empty, "mesh 0, primitive 0: POSITION: accessor 1: bufferView is missing");
  empty.json["accessors"][zeros]["sparse"] = {{"count", 1}};
  expect_message(empty, "mesh 0, primitive 0: POSITION: the file repeats its data");
}

}  // namespace
}  // namespace weft::engine
