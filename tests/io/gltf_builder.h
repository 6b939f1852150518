#pragma once
/// Assembles small glTF files in memory.

#include <cmath>
#include <cstdint>
#include <cstring>
#include <nlohmann/json.hpp>
#include <string>
#include <type_traits>
#include <vector>

#include "weft/error.h"
#include "weft/io/gltf_body.h"

namespace weft::engine::test {

/// JSON text to be filled in, and one buffer.
struct GltfBuilder {
  using Json = nlohmann::json;

  Json json = {{"asset", {{"version", "2.0"}}}, {"accessors", Json::array()}, {"bufferViews", Json::array()}};
  std::string buffer;

  /// Appends an object to a list at the top, and returns its index.
  int add(const char* list, const Json& object) {
    json[list].push_back(object);
    return static_cast<int>(json[list].size()) - 1;
  }

  /// Appends numbers as a buffer view, aligned to 4 bytes, and returns its index.
  template <class Number>
  int add_view(const std::vector<Number>& numbers) {
    buffer.resize((buffer.size() + 3) / 4 * 4);
    const std::size_t begin = buffer.size(), length = numbers.size() * sizeof(Number);
    buffer.append(reinterpret_cast<const char*>(numbers.data()), length);
    return add("bufferViews", {{"buffer", 0}, {"byteOffset", begin}, {"byteLength", length}});
  }

  template <class Number>
  static int component_type() {
    if constexpr (std::is_same_v<Number, std::int8_t>) return 5120;
    if constexpr (std::is_same_v<Number, std::uint8_t>) return 5121;
    if constexpr (std::is_same_v<Number, std::int16_t>) return 5122;
    if constexpr (std::is_same_v<Number, std::uint16_t>) return 5123;
    if constexpr (std::is_same_v<Number, std::uint32_t>) return 5125;
    return 5126;
  }

  /// Appends numbers as an accessor of a type such as "VEC3", and returns its index.
  template <class Number>
  int add_accessor(const std::string& type, const std::vector<Number>& numbers, bool is_normalized = false) {
    const std::size_t width = type == "SCALAR" ? 1 : type == "MAT4" ? 16 : std::stoul(type.substr(3));
    Json accessor = {{"bufferView", add_view(numbers)},
                     {"componentType", component_type<Number>()},
                     {"count", numbers.size() / width},
                     {"type", type}};
    if (is_normalized) accessor["normalized"] = true;
    return add("accessors", accessor);
  }

  int add_floats(const std::string& type, const std::vector<float>& numbers) {
    return add_accessor(type, numbers);
  }

  /// Appends a channel, and its sampler, to an animation.
  void add_channel(int animation, int node, const char* path, int input, int output,
                   const char* interpolation = "LINEAR") {
    Json& target = json["animations"][animation];
    target["channels"].push_back({{"sampler", target.contains("samplers") ? target["samplers"].size() : 0},
                                  {"target", {{"node", node}, {"path", path}}}});
    target["samplers"].push_back({{"input", input}, {"output", output}, {"interpolation", interpolation}});
  }

  /// A .glb file.
  std::string glb() const {
    Json whole = json;
    whole["buffers"] = {{{"byteLength", buffer.size()}}};
    return glb_of(whole.dump(), buffer);
  }

  /// A .gltf file whose buffer is at `uri`.
  std::string gltf(const std::string& uri) const {
    Json whole = json;
    whole["buffers"] = {{{"byteLength", buffer.size()}, {"uri", uri}}};
    return whole.dump(2);
  }

  /// A .gltf file with the buffer in a data URI.
  std::string gltf() const { return gltf("data:application/octet-stream;base64," + base64(buffer)); }

  static std::string word(std::size_t value) {
    std::string bytes;
    for (int k = 0; k < 4; ++k) bytes += static_cast<char>(value >> (8 * k) & 0xff);
    return bytes;
  }

  static std::string glb_of(std::string text, std::string numbers) {
    text.resize((text.size() + 3) / 4 * 4, ' ');
    numbers.resize((numbers.size() + 3) / 4 * 4, '\0');
    std::string chunks = word(text.size()) + "JSON" + text;
    if (!numbers.empty()) chunks += word(numbers.size()) + std::string("BIN\0", 4) + numbers;
    return "glTF" + word(2) + word(12 + chunks.size()) + chunks;
  }

  static std::string base64(const std::string& bytes) {
    const std::string digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::string text;
    for (std::size_t k = 0; k < bytes.size(); k += 3) {
      unsigned bits = 0;
      for (std::size_t b = 0; b < 3; ++b)
        bits = bits << 8 | (k + b < bytes.size() ? static_cast<unsigned char>(bytes[k + b]) : 0u);
      for (std::size_t d = 0; d < 4; ++d)
        text += k + d > bytes.size() ? '=' : digits[bits >> (18 - 6 * d) & 63];
    }
    return text;
  }
};

using Floats = std::vector<float>;

inline const Floats kTriangle = {0, 0, 0, 1, 0, 0, 0, 1, 0};
inline const Floats kIdentity = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};

inline Floats translation_matrix(float x, float y, float z) {
  return {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, x, y, z, 1};
}

inline Floats operator+(Floats a, const Floats& b) {
  a.insert(a.end(), b.begin(), b.end());
  return a;
}

/// A file with one mesh of one triangle at node 0.
inline GltfBuilder make_triangle() {
  GltfBuilder file;
  file.add("meshes",
           {{"primitives", {{{"attributes", {{"POSITION", file.add_floats("VEC3", kTriangle)}}}}}}});
  file.add("nodes", {{"mesh", 0}});
  return file;
}

inline GltfBuilder::Json& primitive(GltfBuilder& file, int mesh = 0, int index = 0) {
  return file.json["meshes"][mesh]["primitives"][index];
}

/// An arm along y from (0, 0, 0) to (0, 2, 0). Its joints, nodes 1 and 2, are at its root and at its middle.
/// The second one turns about z by 90 degrees from 0 to 1 s. Node 3 is the mesh, and node 0 the root of all.
inline GltfBuilder make_arm() {
  GltfBuilder file;
  const int position = file.add_floats("VEC3", {0.25f, 0, 0, 0.25f, 1, 0.5f, 0.25f, 2, 0});
  const int joints = file.add_accessor<std::uint8_t>("VEC4", {0, 0, 0, 0, 0, 1, 0, 0, 1, 0, 0, 0});
  const int weights = file.add_floats("VEC4", {1, 0, 0, 0, 0.5f, 0.5f, 0, 0, 1, 0, 0, 0});
  const int indices = file.add_accessor<std::uint16_t>("SCALAR", {0, 1, 2});
  const int bind = file.add_floats("MAT4", kIdentity + translation_matrix(0, -1, 0));
  const int times = file.add_floats("SCALAR", {0, 1});
  const auto half = static_cast<float>(std::sqrt(0.5));
  const int turn = file.add_floats("VEC4", {0, 0, 0, 1, 0, 0, half, half});
  file.add("meshes",
           {{"primitives",
             {{{"attributes", {{"POSITION", position}, {"JOINTS_0", joints}, {"WEIGHTS_0", weights}}},
               {"indices", indices}}}}});
  file.json["nodes"] = {{{"name", "arm"}, {"children", {1, 3}}},
                        {{"name", "shoulder"}, {"children", {2}}},
                        {{"name", "elbow"}, {"translation", {0, 1, 0}}},
                        {{"name", "sleeve"}, {"mesh", 0}, {"skin", 0}}};
  file.add("skins", {{"joints", {1, 2}}, {"inverseBindMatrices", bind}});
  file.add("scenes", {{"nodes", {0}}});
  file.json["scene"] = 0;
  file.add("animations", {{"name", "bend"}});
  file.add_channel(0, 2, "rotation", times, turn);
  return file;
}

inline GltfBody parse(const std::string& bytes, const GltfOptions& options = {}) {
  return parse_gltf_body({reinterpret_cast<const unsigned char*>(bytes.data()), bytes.size()}, "made.glb",
                         options);
}

/// The error message for a file; empty if it is read.
inline std::string complaint(const std::string& bytes, const GltfOptions& options = {}) {
  try {
    parse(bytes, options);
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

}  // namespace weft::engine::test
