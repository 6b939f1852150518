#include "tools/wardrobe/walk.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "tools/wardrobe/figure.h"
#include "tools/wardrobe/garments.h"
#include "weft/core/staged_file.h"
#include "weft/io/obj_reader.h"
#include "weft/mesh/clean.h"

namespace weft::engine::wardrobe {
namespace {

using Json = nlohmann::json;

constexpr double kFigureCell = 0.0155, kGarmentCell = 0.020;  // [m]
constexpr double kDuration = 5;                               // of the clip [s]
constexpr int kKeysPerSecond = 20;
constexpr double kWaist = 1.012;  // cloth above belongs to the waistband [m]
constexpr int kJointsPerVertex = 4;

/// A glTF file with one buffer.
struct GlbFile {
  Json json = {{"asset", {{"version", "2.0"}, {"generator", "Weft, tools/make_wardrobe"}}},
               {"accessors", Json::array()},
               {"bufferViews", Json::array()}};
  std::string buffer;

  /// Appends numbers as an accessor; `width` numbers are one element. Returns its index.
  template <class Number>
  int add(const std::vector<Number>& numbers, int component_type, const char* type, std::size_t width) {
    buffer.resize((buffer.size() + 3) / 4 * 4);
    const std::size_t begin = buffer.size(), length = numbers.size() * sizeof(Number);
    buffer.append(reinterpret_cast<const char*>(numbers.data()), length);
    json["bufferViews"].push_back({{"buffer", 0}, {"byteOffset", begin}, {"byteLength", length}});
    Json accessor = {{"bufferView", json["bufferViews"].size() - 1},
                     {"componentType", component_type},
                     {"count", numbers.size() / width},
                     {"type", type}};
    std::vector<Number> least(numbers.begin(), numbers.begin() + width), most = least;
    for (std::size_t k = 0; k < numbers.size(); ++k) {
      least[k % width] = std::min(least[k % width], numbers[k]);
      most[k % width] = std::max(most[k % width], numbers[k]);
    }
    accessor["min"] = least;
    accessor["max"] = most;
    json["accessors"].push_back(std::move(accessor));
    return static_cast<int>(json["accessors"].size()) - 1;
  }
  int add_floats(const std::vector<float>& numbers, const char* type, std::size_t width) {
    return add(numbers, 5126, type, width);
  }

  std::string bytes() const {
    Json whole = json;
    whole["buffers"] = {{{"byteLength", buffer.size()}}};
    std::string text = whole.dump(), numbers = buffer;
    text.resize((text.size() + 3) / 4 * 4, ' ');
    numbers.resize((numbers.size() + 3) / 4 * 4, '\0');
    const std::string chunks =
        word(text.size()) + "JSON" + text + word(numbers.size()) + std::string("BIN\0", 4) + numbers;
    return "glTF" + word(2) + word(12 + chunks.size()) + chunks;
  }

  static std::string word(std::size_t value) {
    std::string bytes;
    for (int k = 0; k < 4; ++k) bytes += static_cast<char>(value >> (8 * k) & 0xff);
    return bytes;
  }
};

std::vector<float> to_floats(const std::vector<Vec3>& points) {
  std::vector<float> numbers;
  for (const Vec3& p : points) {
    for (const double c : p) numbers.push_back(static_cast<float>(c));
  }
  return numbers;
}

/// The joints of largest weight of each vertex, and their weights divided by their sum.
void add_joints(const Figure& figure, GlbFile& file, Json& attributes) {
  std::vector<std::uint8_t> joints;
  std::vector<float> weights;
  for (const std::array<float, kNumBones>& all : figure.weights) {
    std::array<std::uint8_t, kNumBones> order;
    for (std::uint8_t b = 0; b < kNumBones; ++b) order[b] = b;
    std::ranges::stable_sort(order, [&](int a, int b) { return all[a] > all[b]; });
    float sum = 0;
    for (int k = 0; k < kJointsPerVertex; ++k) sum += all[order[k]];
    for (int k = 0; k < kJointsPerVertex; ++k) {
      joints.push_back(order[k]);
      weights.push_back(all[order[k]] / sum);
    }
  }
  attributes["JOINTS_0"] = file.add(joints, 5121, "VEC4", kJointsPerVertex);
  attributes["WEIGHTS_0"] = file.add_floats(weights, "VEC4", kJointsPerVertex);
}

/// Nodes 0 to kNumBones − 1 are the bones, kNumBones is the mesh.
void add_nodes(GlbFile& file) {
  std::vector<float> inverse_bind;
  for (int b = 0; b < kNumBones; ++b) {
    const Bone bone = static_cast<Bone>(b);
    const Vec3 joint = joint_of(bone),
               from_parent = b == kHips ? joint : Vec3(joint - joint_of(parent_of(bone)));
    Json node = {{"name", name_of(bone)}, {"translation", to_floats({from_parent})}};
    for (int child = 1; child < kNumBones; ++child) {
      if (parent_of(static_cast<Bone>(child)) == bone) node["children"].push_back(child);
    }
    file.json["nodes"].push_back(node);
    for (const float number : {1.f, 0.f, 0.f, 0.f, 0.f, 1.f, 0.f, 0.f, 0.f, 0.f, 1.f, 0.f})
      inverse_bind.push_back(number);
    for (const float c : to_floats({-joint})) inverse_bind.push_back(c);
    inverse_bind.push_back(1);
  }
  file.json["nodes"].push_back({{"name", "Figure"}, {"mesh", 0}, {"skin", 0}});
  Json joints = Json::array();
  for (int b = 0; b < kNumBones; ++b) joints.push_back(b);
  file.json["skins"] = {
      {{"joints", joints}, {"inverseBindMatrices", file.add_floats(inverse_bind, "MAT4", 16)}}};
  file.json["scenes"] = {{{"nodes", {int(kHips), int(kNumBones)}}}};
  file.json["scene"] = 0;
}

void add_walk(GlbFile& file) {
  std::vector<float> times;
  std::array<std::vector<float>, kNumBones> rotations;
  for (int k = 0; k <= kDuration * kKeysPerSecond; ++k) {
    times.push_back(static_cast<float>(k) / kKeysPerSecond);
    const Pose pose = pose_at("stroll", times.back());
    for (int b = 0; b < kNumBones; ++b) {
      const Eigen::Quaterniond turn(rotation_of(pose[b]));
      for (const double c : turn.coeffs()) rotations[b].push_back(static_cast<float>(c));
    }
  }
  Json clip = {{"name", "walk"}};
  const int input = file.add_floats(times, "SCALAR", 1);
  for (int b = 0; b < kNumBones; ++b) {
    const std::vector<float>& own = rotations[b];
    if (std::equal(own.begin() + 4, own.end(), own.begin())) continue;  // it stands still
    clip["channels"].push_back({{"sampler", clip.value("samplers", Json::array()).size()},
                                {"target", {{"node", b}, {"path", "rotation"}}}});
    clip["samplers"].push_back({{"input", input}, {"output", file.add_floats(own, "VEC4", 4)}});
  }
  file.json["animations"] = {clip};
}

std::string figure_bytes() {
  const Figure figure = make_figure(kFigureCell, Hands::mittens);
  GlbFile file;
  std::vector<std::uint32_t> indices;
  for (const Triangle& t : figure.mesh.triangles) indices.insert(indices.end(), t.begin(), t.end());
  Json attributes = {{"POSITION", file.add_floats(to_floats(figure.mesh.positions), "VEC3", 3)}};
  add_joints(figure, file, attributes);
  file.json["meshes"] = {
      {{"name", "Figure"},
       {"primitives", {{{"attributes", attributes}, {"indices", file.add(indices, 5125, "SCALAR", 1)}}}}}};
  add_nodes(file);
  add_walk(file);
  return file.bytes();
}

/// Without slivers and double vertices.
TriangleMesh clean(const TriangleMesh& garment) {
  return clean_mesh(garment, {.weld_distance = 1e-4, .short_edge = 1e-3}).mesh;
}

void write_skirt(const std::filesystem::path& file) {
  const TriangleMesh skirt = clean(make_skirt(kGarmentCell));
  MeshFaces faces;
  for (const bool is_band : {true, false}) {
    const int begin = static_cast<int>(faces.size());
    for (const Triangle& t : skirt.triangles) {
      const bool is_above = std::ranges::all_of(t, [&](int v) { return skirt.positions[v].y() > kWaist; });
      if (is_above == is_band) faces.add(t);
    }
    faces.groups.push_back(
        {.name = is_band ? "waist" : "skirt", .faces = {{begin, static_cast<int>(faces.size())}}});
  }
  write_obj(file, skirt.positions, faces);
}

std::string write_pattern(const std::filesystem::path& file) {
  const Pattern dress = make_dress_pattern(kGarmentCell);
  write_obj(file, dress.mesh.positions, make_faces(dress.mesh.triangles, dress.uv));
  std::string seams;
  for (const Seam& seam : dress.seams) {
    seams += "\n[[cloth.seam]]\n";
    for (const auto& [key, side] : {std::pair("a", &seam.a), std::pair("b", &seam.b)})
      seams +=
          std::string(key) + " = [" + std::to_string((*side)[0]) + ", " + std::to_string((*side)[1]) + "]\n";
  }
  return seams;
}

}  // namespace

std::string write_walk(const std::filesystem::path& folder) {
  const std::string figure = figure_bytes();
  write_file(folder / "figure.glb", figure);
  write_skirt(folder / "walk_skirt.obj");
  write_obj(folder / "walk_shirt.obj", clean(make_shirt_over_skirt(kGarmentCell)));
  return write_pattern(folder / "dress_pattern.obj");
}

}  // namespace weft::engine::wardrobe
