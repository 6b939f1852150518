#include "weft/io/glb_writer.h"

#include <tiny_gltf.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <functional>
#include <limits>
#include <span>

#include "weft/error.h"
#include "weft/mesh/vertex_normals.h"

namespace weft::engine {
namespace {

constexpr double kRoughness = 0.8;  // cloth scatters light

/// What an accessor holds, in glTF's terms.
struct Layout {
  int type = TINYGLTF_TYPE_VEC3;
  int num_components = 3;
  int target = 0;           // GPU buffer, 0 for animation data
  bool has_bounds = false;  // minimum and maximum are told: required for positions and key times
};
constexpr Layout kPositions{TINYGLTF_TYPE_VEC3, 3, TINYGLTF_TARGET_ARRAY_BUFFER, true};
constexpr Layout kNormals{TINYGLTF_TYPE_VEC3, 3, TINYGLTF_TARGET_ARRAY_BUFFER, false};
constexpr Layout kFabricCoordinates{TINYGLTF_TYPE_VEC2, 2, TINYGLTF_TARGET_ARRAY_BUFFER, false};
constexpr Layout kTimes{TINYGLTF_TYPE_SCALAR, 1, 0, true};
constexpr Layout kWeights{TINYGLTF_TYPE_SCALAR, 1, 0, false};
constexpr Layout kTranslations{TINYGLTF_TYPE_VEC3, 3, 0, false};
constexpr Layout kRotations{TINYGLTF_TYPE_VEC4, 4, 0, false};

size_t num_frames(const Animation& animation) {
  size_t count = 1;
  for (const AnimatedMesh& cloth : animation.cloths) count = std::max(count, cloth.frames.size());
  for (const RigidMesh& body : animation.bodies)
    count = std::max({count, body.poses.size(), body.frames.size()});
  return count;
}

// ---- Checks ----

void require_triangles(const std::string& name, const std::vector<Triangle>& triangles, size_t num_vertices) {
  if (triangles.empty()) throw InputError("mesh '" + name + "' has no triangles");
  for (const Triangle& triangle : triangles) {
    for (const int v : triangle) {
      if (v >= 0 && static_cast<size_t>(v) < num_vertices) continue;
      throw InputError("mesh '" + name + "' uses vertex " + std::to_string(v) + " of " +
                       std::to_string(num_vertices));
    }
  }
}

void require_count(const std::string& name, const char* what, size_t count, size_t expected) {
  if (count == expected) return;
  throw InputError("mesh '" + name + "' has " + std::to_string(count) + " " + what + "; expected " +
                   std::to_string(expected));
}

void require_finite(const std::string& name, size_t frame, std::span<const float> numbers) {
  if (std::all_of(numbers.begin(), numbers.end(), [](float x) { return std::isfinite(x); })) return;
  throw InputError("mesh '" + name + "' has a coordinate that is not a finite number in frame " +
                   std::to_string(frame));
}

void require_valid(const AnimatedMesh& cloth, size_t frames) {
  require_count(cloth.name, "frames", cloth.frames.size(), frames);
  const size_t num_floats = cloth.frames[0].size();
  for (size_t k = 0; k < frames; ++k) {
    require_count(cloth.name, "coordinates in a frame", cloth.frames[k].size(), num_floats);
    require_finite(cloth.name, k, cloth.frames[k]);
  }
  require_triangles(cloth.name, cloth.triangles, num_floats / 3);
  if (cloth.fabric_coordinates.empty()) return;
  require_count(cloth.name, "fabric coordinates", cloth.fabric_coordinates.size(), num_floats / 3 * 2);
  require_finite(cloth.name, 0, cloth.fabric_coordinates);
}

void require_valid(const RigidMesh& body, size_t frames) {
  if (body.poses.size() != 1) require_count(body.name, "poses", body.poses.size(), frames);
  require_triangles(body.name, body.mesh.triangles, body.mesh.positions.size());
  if (!body.frames.empty()) require_count(body.name, "frames", body.frames.size(), frames);
  for (size_t k = 0; k < body.frames.size(); ++k) {
    require_count(body.name, "coordinates in a frame", body.frames[k].size(), 3 * body.mesh.positions.size());
    require_finite(body.name, k, body.frames[k]);
  }
  for (size_t k = 0; k < body.poses.size(); ++k) {
    const auto& [translation, rotation] = body.poses[k];
    if (!translation.allFinite() || !rotation.coeffs().allFinite()) {
      throw InputError("body '" + body.name + "' has a pose that is not finite in frame " +
                       std::to_string(k));
    }
  }
}

void require_valid(const Animation& animation) {
  if (animation.cloths.empty() && animation.bodies.empty()) throw InputError("the animation has no meshes");
  if (!(animation.frames_per_second > 0))
    throw InputError("the animation needs more than 0 frames per second");
  const size_t frames = num_frames(animation);
  for (const AnimatedMesh& cloth : animation.cloths) require_valid(cloth, frames);
  for (const RigidMesh& body : animation.bodies) require_valid(body, frames);
}

// ---- Geometry ----

std::vector<float> difference(std::span<const float> a, std::span<const float> b) {
  std::vector<float> result(a.size());
  std::transform(a.begin(), a.end(), b.begin(), result.begin(), std::minus<>());
  return result;
}

std::vector<float> flatten(const std::vector<Vec3>& positions) {
  std::vector<float> result;
  result.reserve(3 * positions.size());
  for (const Vec3& x : positions) {
    for (const double coordinate : x) result.push_back(static_cast<float>(coordinate));
  }
  return result;
}

// ---- Extras ----

using Extras = tinygltf::Value::Object;

tinygltf::Value numbers(std::span<const double> values) {
  tinygltf::Value::Array array;
  for (const double value : values) array.emplace_back(value);
  return tinygltf::Value(std::move(array));
}

tinygltf::Value numbers(const Vec3& v) { return numbers(std::span<const double>(v.data(), 3)); }

Extras shape_extras(const Sphere& s) {
  return {{"shape", tinygltf::Value(std::string("sphere"))},
          {"center", numbers(s.center)},
          {"radius", tinygltf::Value(s.radius)}};
}

Extras shape_extras(const Plane& p) {
  return {{"shape", tinygltf::Value(std::string("plane"))},
          {"point", numbers(p.point)},
          {"normal", numbers(p.normal)}};
}

Extras shape_extras(const Capsule& c) {
  return {{"shape", tinygltf::Value(std::string("capsule"))},
          {"a", numbers(c.a)},
          {"b", numbers(c.b)},
          {"radius", tinygltf::Value(c.radius)}};
}

Extras shape_extras(const OrientedBox& b) {
  const Mat3 rows = b.rotation.transpose();  // Eigen stores columns
  return {{"shape", tinygltf::Value(std::string("box"))},
          {"center", numbers(b.center)},
          {"half_size", numbers(b.half_size)},
          {"rotation", numbers(std::span<const double>(rows.data(), 9))}};
}

tinygltf::Value extras_of(const AnimatedMesh&) {
  return tinygltf::Value(
      Extras{{"weft", tinygltf::Value(Extras{{"role", tinygltf::Value(std::string("cloth"))}})}});
}

tinygltf::Value extras_of(const RigidMesh& body) {
  Extras weft = {{"shape", tinygltf::Value(std::string("mesh"))}};
  if (body.shape) weft = std::visit([](const auto& shape) { return shape_extras(shape); }, *body.shape);
  weft["role"] = tinygltf::Value(std::string("collider"));
  return tinygltf::Value(Extras{{"weft", tinygltf::Value(std::move(weft))}});
}

// ---- The glTF document ----

class GlbBuilder {
 public:
  explicit GlbBuilder(const Animation& animation)
      : animation_(animation), num_frames_(num_frames(animation)) {}

  tinygltf::Model build() {
    model_.asset.version = "2.0";
    model_.asset.generator = "Weft";
    model_.buffers.emplace_back();
    model_.buffers[0].data.reserve(estimate_size());
    add_scene();
    add_clock();
    for (const AnimatedMesh& cloth : animation_.cloths) add_cloth(cloth);
    for (const RigidMesh& body : animation_.bodies) add_body(body);
    if (is_moving()) model_.animations.push_back(std::move(motion_));
    return std::move(model_);
  }

 private:
  bool is_moving() const { return num_frames_ > 1; }

  /// The bytes of the frames, which are nearly all of the file.
  size_t estimate_size() const {
    size_t num_floats = num_frames_ * num_frames_;
    for (const AnimatedMesh& cloth : animation_.cloths) {
      num_floats += 2 * num_frames_ * cloth.frames[0].size() + 3 * cloth.triangles.size();
    }
    return num_floats * sizeof(float);
  }

  void add_scene() {
    tinygltf::Scene scene;
    if (!animation_.title.empty()) {
      scene.name = animation_.title;
    }
    model_.asset.extras = asset_extras();
    model_.scenes.push_back(std::move(scene));
    model_.defaultScene = 0;
  }

  tinygltf::Value asset_extras() const {
    Extras extras;
    if (!animation_.title.empty()) extras["title"] = tinygltf::Value(animation_.title);
    tinygltf::Value::Array pairs;
    for (const auto& [a, b] : animation_.passing)
      pairs.emplace_back(tinygltf::Value::Array{tinygltf::Value(a), tinygltf::Value(b)});
    if (!pairs.empty()) extras["passing"] = tinygltf::Value(std::move(pairs));
    return extras.empty() ? tinygltf::Value() : tinygltf::Value(std::move(extras));
  }

  /// The key times, and the weights that all cloths share: frame k shows morph target k - 1 and no other.
  void add_clock() {
    if (!is_moving()) return;
    std::vector<float> times(num_frames_);
    for (size_t k = 0; k < num_frames_; ++k) {
      times[k] = static_cast<float>(static_cast<double>(k) / animation_.frames_per_second);
    }
    times_ = add_floats(times, kTimes);
    const bool is_any_deforming =
        !animation_.cloths.empty() || std::any_of(animation_.bodies.begin(), animation_.bodies.end(),
                                                  [](const RigidMesh& body) { return !body.frames.empty(); });
    if (!is_any_deforming) return;
    const size_t num_targets = num_frames_ - 1;
    std::vector<float> weights(num_frames_ * num_targets, 0.0f);
    for (size_t k = 1; k < num_frames_; ++k) weights[k * num_targets + k - 1] = 1;
    weights_sampler_ = add_sampler(add_floats(weights, kWeights));
  }

  void add_cloth(const AnimatedMesh& cloth) {
    tinygltf::Mesh mesh;
    tinygltf::Primitive primitive = make_primitive(cloth.triangles, add_material(cloth.name, cloth.color));
    add_frames(cloth.triangles, cloth.frames, primitive);
    if (!cloth.fabric_coordinates.empty())
      primitive.attributes["TEXCOORD_0"] = add_floats(cloth.fabric_coordinates, kFabricCoordinates);
    mesh.weights.assign(num_frames_ - 1, 0.0);
    mesh.primitives.push_back(std::move(primitive));
    const int node = add_node(cloth.name, std::move(mesh));
    model_.nodes[node].extras = extras_of(cloth);
    if (is_moving()) add_channel(node, "weights", weights_sampler_);
  }

  /// The first frame as the vertices, the others as morph targets.
  void add_frames(const std::vector<Triangle>& triangles, const std::vector<std::vector<float>>& frames,
                  tinygltf::Primitive& primitive) {
    const auto& base = frames[0];
    const auto base_normals = compute_vertex_normals(triangles, base);
    primitive.attributes = add_vertices(base, base_normals);
    for (size_t k = 1; k < num_frames_; ++k) {
      const auto normals = compute_vertex_normals(triangles, frames[k]);
      primitive.targets.push_back(
          add_vertices(difference(frames[k], base), difference(normals, base_normals)));
    }
  }

  void add_body(const RigidMesh& body) {
    tinygltf::Mesh mesh;
    mesh.primitives.push_back(make_primitive(body.mesh.triangles, add_material(body.name, body.color)));
    if (body.frames.empty()) {
      const auto positions = flatten(body.mesh.positions);
      require_finite(body.name, 0, positions);
      mesh.primitives[0].attributes =
          add_vertices(positions, compute_vertex_normals(body.mesh.triangles, positions));
    } else {
      add_frames(body.mesh.triangles, body.frames, mesh.primitives[0]);
      mesh.weights.assign(num_frames_ - 1, 0.0);
    }
    const int node = add_node(body.name, std::move(mesh));
    model_.nodes[node].extras = extras_of(body);
    if (!body.frames.empty() && is_moving()) add_channel(node, "weights", weights_sampler_);
    const auto& [translation, rotation] = body.poses[0];
    const Eigen::Vector4d xyzw = rotation.normalized().coeffs();
    model_.nodes[node].translation.assign(translation.begin(), translation.end());
    model_.nodes[node].rotation.assign(xyzw.begin(), xyzw.end());
    if (body.poses.size() > 1) add_poses(node, body.poses);
  }

  void add_poses(int node, const std::vector<RigidMesh::Pose>& poses) {
    std::vector<float> translations, rotations;
    for (const auto& [translation, rotation] : poses) {
      const Eigen::Vector4d xyzw = rotation.normalized().coeffs();
      for (const double t : translation) translations.push_back(static_cast<float>(t));
      for (const double q : xyzw) rotations.push_back(static_cast<float>(q));
    }
    add_channel(node, "translation", add_sampler(add_floats(translations, kTranslations)));
    add_channel(node, "rotation", add_sampler(add_floats(rotations, kRotations)));
  }

  // Parts of the document; each add_ function returns the index of the new part.

  int add_node(const std::string& name, tinygltf::Mesh mesh) {
    mesh.name = name;
    model_.meshes.push_back(std::move(mesh));
    tinygltf::Node node;
    node.name = name;
    node.mesh = static_cast<int>(model_.meshes.size()) - 1;
    model_.nodes.push_back(std::move(node));
    const int index = static_cast<int>(model_.nodes.size()) - 1;
    model_.scenes[0].nodes.push_back(index);
    return index;
  }

  int add_material(const std::string& name, const std::array<double, 3>& color) {
    tinygltf::Material material;
    material.name = name;
    material.doubleSided = true;
    material.pbrMetallicRoughness.baseColorFactor = {color[0], color[1], color[2], 1.0};
    material.pbrMetallicRoughness.metallicFactor = 0;
    material.pbrMetallicRoughness.roughnessFactor = kRoughness;
    model_.materials.push_back(std::move(material));
    return static_cast<int>(model_.materials.size()) - 1;
  }

  tinygltf::Primitive make_primitive(const std::vector<Triangle>& triangles, int material) {
    static_assert(sizeof(Triangle) == 3 * sizeof(uint32_t));
    tinygltf::Primitive primitive;
    primitive.mode = TINYGLTF_MODE_TRIANGLES;
    primitive.material = material;
    tinygltf::Accessor accessor;
    accessor.bufferView = add_bytes(triangles.data(), triangles.size() * sizeof(Triangle),
                                    TINYGLTF_TARGET_ELEMENT_ARRAY_BUFFER);
    accessor.componentType = TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT;
    accessor.type = TINYGLTF_TYPE_SCALAR;
    accessor.count = 3 * triangles.size();
    model_.accessors.push_back(std::move(accessor));
    primitive.indices = static_cast<int>(model_.accessors.size()) - 1;
    return primitive;
  }

  std::map<std::string, int> add_vertices(std::span<const float> positions, std::span<const float> normals) {
    const int position_accessor = add_floats(positions, kPositions);
    return {{"POSITION", position_accessor}, {"NORMAL", add_floats(normals, kNormals)}};
  }

  int add_floats(std::span<const float> numbers, const Layout& layout) {
    tinygltf::Accessor accessor;
    accessor.bufferView = add_bytes(numbers.data(), numbers.size_bytes(), layout.target);
    accessor.componentType = TINYGLTF_COMPONENT_TYPE_FLOAT;
    accessor.type = layout.type;
    accessor.count = numbers.size() / layout.num_components;
    if (layout.has_bounds) set_bounds(accessor, numbers, layout.num_components);
    model_.accessors.push_back(std::move(accessor));
    return static_cast<int>(model_.accessors.size()) - 1;
  }

  static void set_bounds(tinygltf::Accessor& accessor, std::span<const float> numbers, int num_components) {
    accessor.minValues.assign(numbers.begin(), numbers.begin() + num_components);
    accessor.maxValues = accessor.minValues;
    for (size_t k = 0; k < numbers.size(); ++k) {
      double& low = accessor.minValues[k % num_components];
      double& high = accessor.maxValues[k % num_components];
      low = std::min(low, static_cast<double>(numbers[k]));
      high = std::max(high, static_cast<double>(numbers[k]));
    }
  }

  /// Every accessor has a view of its own: no strides, and four-byte numbers keep all of them aligned.
  int add_bytes(const void* data, size_t num_bytes, int target) {
    auto& bytes = model_.buffers[0].data;
    tinygltf::BufferView view;
    view.buffer = 0;
    view.byteOffset = bytes.size();
    view.byteLength = num_bytes;
    view.target = target;
    const auto* begin = static_cast<const unsigned char*>(data);
    bytes.insert(bytes.end(), begin, begin + num_bytes);
    model_.bufferViews.push_back(std::move(view));
    return static_cast<int>(model_.bufferViews.size()) - 1;
  }

  int add_sampler(int output) {
    tinygltf::AnimationSampler sampler;
    sampler.input = times_;
    sampler.output = output;
    sampler.interpolation = "LINEAR";
    motion_.samplers.push_back(std::move(sampler));
    return static_cast<int>(motion_.samplers.size()) - 1;
  }

  void add_channel(int node, const char* path, int sampler) {
    tinygltf::AnimationChannel channel;
    channel.sampler = sampler;
    channel.target_node = node;
    channel.target_path = path;
    motion_.channels.push_back(std::move(channel));
  }

  const Animation& animation_;
  const size_t num_frames_;
  tinygltf::Model model_;
  tinygltf::Animation motion_;
  int times_ = -1;            // accessor of the key times
  int weights_sampler_ = -1;  // sampler of the weights
};

// ---- The file ----

/// The file's lengths have 32 bits.
void require_size(const std::filesystem::path& file, const tinygltf::Model& model) {
  constexpr size_t kRoomForJson = size_t{1} << 28;
  constexpr size_t kLargest = std::numeric_limits<uint32_t>::max() - kRoomForJson;
  const size_t size = model.buffers[0].data.size();
  if (size > kLargest) {
    throw InputError(file.string() + " cannot be written: " + std::to_string(size) +
                     " bytes of frames are too many for glTF; write fewer frames");
  }
}

}  // namespace

void write_glb(StagedFile& file, const Animation& animation) {
  require_valid(animation);
  tinygltf::Model model = GlbBuilder(animation).build();
  require_size(file.file(), model);
  tinygltf::TinyGLTF().WriteGltfSceneToStream(&model, file.out(), false, true);
  file.finish();
}

void write_glb(const std::filesystem::path& file, const Animation& animation) {
  StagedFile staged(file);
  write_glb(staged, animation);
  staged.replace();
}

}  // namespace weft::engine
