#include "weft/io/glb_reader.h"

#include <tiny_gltf.h>

#include <algorithm>
#include <cmath>
#include <cstring>

#include "weft/error.h"
#include "weft/io/input_file.h"

namespace weft::engine {
namespace {

using Pose = AnimatedBody::Pose;
using Value = tinygltf::Value;

/// Throws the mistake in the file; parse_glb adds the file name.
[[noreturn]] void fail(const std::string& what) { throw InputError(what); }

template <class T>
const T& at(const std::vector<T>& items, int index, const char* what) {
  if (index < 0 || static_cast<size_t>(index) >= items.size()) {
    fail("it refers to " + std::string(what) + " " + std::to_string(index) + " of " +
         std::to_string(items.size()));
  }
  return items[index];
}

// ---- The file ----

/// Whether the nesting of brackets in the file's text is safe for the recursion of tinygltf.
bool is_flat_enough(std::span<const unsigned char> bytes) {
  constexpr int kDeepest = 100;
  constexpr size_t kHeader = 20, kLengthAt = 12;
  if (bytes.size() < kHeader) return true;
  uint32_t length = 0;
  for (size_t k = 0; k < 4; ++k) length |= uint32_t{bytes[kLengthAt + k]} << (8 * k);
  int depth = 0;
  bool is_text = false;
  const size_t end = std::min(bytes.size(), kHeader + length);
  for (size_t k = kHeader; k < end; ++k) {
    const unsigned char c = bytes[k];
    if (is_text && c == '\\') ++k;
    if (c == '"') is_text = !is_text;
    if (is_text) continue;
    if (c == '[' || c == '{') ++depth;
    if (c == ']' || c == '}') --depth;
    if (depth > kDeepest) return false;
  }
  return true;
}

/// Prevents access to other files and pictures that the file refers to.
void stay_in_the_file(tinygltf::TinyGLTF& loader) {
  loader.SetFsCallbacks(
      {[](const std::string&, void*) { return false; }, [](const std::string& file, void*) { return file; },
       [](std::vector<unsigned char>*, std::string*, const std::string&, void*) { return false; }, nullptr,
       nullptr});
  loader.SetImageLoader([](tinygltf::Image*, int, std::string*, std::string*, int, int, const unsigned char*,
                           int, void*) { return true; },
                        nullptr);
}

/// Fills `model`, or sets `error` to the reason.
bool load(std::span<const unsigned char> bytes, tinygltf::Model& model, std::string& error) {
  tinygltf::TinyGLTF loader;
  stay_in_the_file(loader);
  std::string warning;
  try {
    return loader.LoadBinaryFromMemory(&model, &error, &warning, bytes.data(),
                                       static_cast<unsigned>(bytes.size()));
  } catch (const std::exception& exception) {  // an empty buffer, for example
    error = exception.what();
    return false;
  }
}

tinygltf::Model parse(std::span<const unsigned char> bytes) {
  tinygltf::Model model;
  std::string error;
  const bool is_good =
      bytes.size() >= 12 && bytes.size() <= UINT32_MAX && is_flat_enough(bytes) && load(bytes, model, error);
  if (is_good) return model;
  const auto reason = error.substr(0, error.find('\n'));
  fail("is not a complete .glb file" + (reason.empty() ? "" : " (" + reason + ")") +
       "; expected one that weft run wrote");
}

// ---- Accessors ----

/// Copies all numbers of an accessor with contiguous elements, as written by write_glb.
template <class Number>
std::vector<Number> read_numbers(const tinygltf::Model& model, int index, int component_type, int type) {
  const tinygltf::Accessor& accessor = at(model.accessors, index, "accessor");
  if (accessor.componentType != component_type || accessor.type != type || accessor.sparse.isSparse) {
    fail("accessor " + std::to_string(index) + " has a component type that Weft does not write");
  }
  const tinygltf::BufferView& view = at(model.bufferViews, accessor.bufferView, "buffer view");
  const auto& bytes = at(model.buffers, view.buffer, "buffer").data;
  const size_t num_components = tinygltf::GetNumComponentsInType(static_cast<uint32_t>(type));
  const size_t element = num_components * sizeof(Number);
  const bool is_packed = view.byteStride == 0 || view.byteStride == element;
  if (!is_packed || view.byteOffset > bytes.size() || view.byteLength > bytes.size() - view.byteOffset ||
      accessor.byteOffset > view.byteLength ||
      accessor.count > (view.byteLength - accessor.byteOffset) / element) {
    fail("accessor " + std::to_string(index) + " exceeds its data");
  }
  std::vector<Number> numbers(accessor.count * num_components);
  if (!numbers.empty()) {
    std::memcpy(numbers.data(), bytes.data() + view.byteOffset + accessor.byteOffset,
                numbers.size() * sizeof(Number));
  }
  return numbers;
}

std::vector<float> read_floats(const tinygltf::Model& model, int index, int type) {
  auto numbers = read_numbers<float>(model, index, TINYGLTF_COMPONENT_TYPE_FLOAT, type);
  if (std::all_of(numbers.begin(), numbers.end(), [](float x) { return std::isfinite(x); })) return numbers;
  fail("accessor " + std::to_string(index) + " has a non-finite number");
}

// ---- Meshes ----

const tinygltf::Primitive& primitive_of(const tinygltf::Model& model, const tinygltf::Node& node) {
  return at(at(model.meshes, node.mesh, "mesh").primitives, 0, "primitive");
}

std::vector<float> read_positions(const tinygltf::Model& model,
                                  const std::map<std::string, int>& attributes) {
  const auto found = attributes.find("POSITION");
  if (found == attributes.end()) fail("a mesh has no positions");
  return read_floats(model, found->second, TINYGLTF_TYPE_VEC3);
}

std::vector<Triangle> read_triangles(const tinygltf::Model& model, int index, size_t num_vertices) {
  const auto indices =
      read_numbers<uint32_t>(model, index, TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT, TINYGLTF_TYPE_SCALAR);
  std::vector<Triangle> triangles(indices.size() / 3);
  for (size_t k = 0; k < 3 * triangles.size(); ++k) {
    if (indices[k] >= num_vertices) {
      fail("a triangle uses vertex " + std::to_string(indices[k]) + " of " + std::to_string(num_vertices));
    }
    triangles[k / 3][k % 3] = static_cast<int>(indices[k]);
  }
  return triangles;
}

std::array<double, 3> read_color(const tinygltf::Model& model, const tinygltf::Primitive& primitive) {
  const auto& factor =
      at(model.materials, primitive.material, "material").pbrMetallicRoughness.baseColorFactor;
  if (factor.size() < 3) fail("material " + std::to_string(primitive.material) + " has no colour");
  return {factor[0], factor[1], factor[2]};
}

/// Adds the morph targets to `frames`, which holds the first frame.
void add_targets(const tinygltf::Model& model, const tinygltf::Node& node,
                 const tinygltf::Primitive& primitive, std::vector<std::vector<float>>& frames) {
  const std::vector<float> base = frames[0];
  for (const auto& target : primitive.targets) {
    auto frame = read_positions(model, target);
    if (frame.size() != base.size())
      fail("the frames of mesh '" + node.name + "' have unequal numbers of vertices");
    for (size_t k = 0; k < base.size(); ++k) frame[k] += base[k];
    frames.push_back(std::move(frame));
  }
}

AnimatedCloth read_cloth(const tinygltf::Model& model, const tinygltf::Node& node) {
  const tinygltf::Primitive& primitive = primitive_of(model, node);
  AnimatedCloth cloth;
  cloth.name = node.name;
  cloth.color = read_color(model, primitive);
  const Value& weft = node.extras.Get("weft");
  if (weft.Has("fabric") && weft.Get("fabric").IsString())
    cloth.fabric = weft.Get("fabric").Get<std::string>();
  const auto base = read_positions(model, primitive.attributes);
  cloth.triangles = read_triangles(model, primitive.indices, base.size() / 3);
  cloth.frames.push_back(base);
  const auto fabric = primitive.attributes.find("TEXCOORD_0");
  if (fabric != primitive.attributes.end()) {
    cloth.fabric_coordinates = read_floats(model, fabric->second, TINYGLTF_TYPE_VEC2);
    if (cloth.fabric_coordinates.size() != base.size() / 3 * 2)
      fail("cloth '" + node.name + "' has more or fewer texture coordinates than vertices");
  }
  add_targets(model, node, primitive, cloth.frames);
  return cloth;
}

// ---- Bodies ----

std::vector<double> read_array(const Value& weft, const char* key, size_t count) {
  const Value& value = weft.Get(key);
  std::vector<double> numbers;
  for (size_t k = 0; k < value.ArrayLen(); ++k)
    numbers.push_back(value.Get(static_cast<int>(k)).GetNumberAsDouble());
  const bool is_good = numbers.size() == count &&
                       std::all_of(numbers.begin(), numbers.end(), [](double x) { return std::isfinite(x); });
  if (!is_good)
    fail("a collider's \"" + std::string(key) + "\" must be " + std::to_string(count) + " numbers");
  return numbers;
}

Vec3 read_vec(const Value& weft, const char* key) {
  return Eigen::Map<const Vec3>(read_array(weft, key, 3).data());
}

double read_length(const Value& weft, const char* key) {
  const double length = weft.Get(key).GetNumberAsDouble();
  if (!(length > 0 && std::isfinite(length)))
    fail("a collider's \"" + std::string(key) + "\" must be positive");
  return length;
}

OrientedBox read_box(const Value& weft) {
  const auto rows = read_array(weft, "rotation", 9);
  return {read_vec(weft, "center"), read_vec(weft, "half_size"),
          Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(rows.data())};
}

std::optional<SolidShape> read_shape(const Value& weft) {
  const Value& name = weft.Get("shape");
  const std::string shape = name.IsString() ? name.Get<std::string>() : "";
  if (shape == "sphere") return Sphere{read_vec(weft, "center"), read_length(weft, "radius")};
  if (shape == "plane") return Plane{read_vec(weft, "point"), read_vec(weft, "normal")};
  if (shape == "capsule")
    return Capsule{read_vec(weft, "a"), read_vec(weft, "b"), read_length(weft, "radius")};
  if (shape == "box") return read_box(weft);
  if (shape == "mesh") return std::nullopt;
  fail("a collider's shape is \"" + shape + "\"; expected sphere, plane, capsule, box or mesh");
}

Pose resting_pose(const tinygltf::Node& node) {
  Pose pose;
  if (node.translation.size() == 3) pose.translation = Eigen::Map<const Vec3>(node.translation.data());
  if (node.rotation.size() == 4)
    pose.rotation.coeffs() = Eigen::Map<const Eigen::Vector4d>(node.rotation.data());
  return pose;
}

class Reader {
 public:
  explicit Reader(const tinygltf::Model& model) : model_(model) {}

  Animation read() {
    Animation animation;
    if (model_.asset.extras.Has("title"))
      animation.title = model_.asset.extras.Get("title").Get<std::string>();
    animation.passing = read_passing();
    animation.frames_per_second = read_frames_per_second();
    for (size_t n = 0; n < model_.nodes.size(); ++n) add_node(static_cast<int>(n), animation);
    if (animation.cloths.empty() && animation.bodies.empty()) {
      fail(
          "has no cloth: no node has Weft's mark, \"extras\": {\"weft\": {\"role\": \"cloth\"}}; "
          "expected a "
          "file that weft run wrote");
    }
    require_equal_frames(animation);
    return animation;
  }

 private:
  std::vector<std::array<std::string, 2>> read_passing() const {
    std::vector<std::array<std::string, 2>> pairs;
    if (!model_.asset.extras.Has("passing")) return pairs;
    const Value& list = model_.asset.extras.Get("passing");
    for (std::size_t p = 0; list.IsArray() && p < list.ArrayLen(); ++p) {
      const Value& pair = list.Get(static_cast<int>(p));
      const bool is_pair =
          pair.IsArray() && pair.ArrayLen() == 2 && pair.Get(0).IsString() && pair.Get(1).IsString();
      if (!is_pair) fail("has a pair under \"passing\" that is not two names");
      pairs.push_back({pair.Get(0).Get<std::string>(), pair.Get(1).Get<std::string>()});
    }
    return pairs;
  }

  void add_node(int index, Animation& animation) const {
    const tinygltf::Node& node = model_.nodes[index];
    if (!node.extras.Has("weft") || !node.extras.Get("weft").IsObject()) return;
    const Value& weft = node.extras.Get("weft");
    const std::string role = weft.Get("role").IsString() ? weft.Get("role").Get<std::string>() : "";
    if (role == "cloth") animation.cloths.push_back(read_cloth(model_, node));
    if (role == "collider") animation.bodies.push_back(read_body(index));
  }

  AnimatedBody read_body(int index) const {
    const tinygltf::Node& node = model_.nodes[index];
    const tinygltf::Primitive& primitive = primitive_of(model_, node);
    AnimatedBody body;
    body.name = node.name;
    const auto positions = read_positions(model_, primitive.attributes);
    for (size_t k = 0; k + 2 < positions.size(); k += 3) {
      body.mesh.positions.emplace_back(positions[k], positions[k + 1], positions[k + 2]);
    }
    body.mesh.triangles = read_triangles(model_, primitive.indices, body.mesh.positions.size());
    if (!primitive.targets.empty()) {
      body.frames = {positions};
      add_targets(model_, node, primitive, body.frames);
    }
    body.shape = read_shape(node.extras.Get("weft"));
    body.poses = read_poses(index);
    return body;
  }

  std::vector<Pose> read_poses(int node) const {
    const auto translations = read_channel(node, "translation", TINYGLTF_TYPE_VEC3);
    const auto rotations = read_channel(node, "rotation", TINYGLTF_TYPE_VEC4);
    std::vector<Pose> poses(std::max<size_t>(1, std::max(translations.size() / 3, rotations.size() / 4)),
                            resting_pose(model_.nodes[node]));
    for (size_t k = 0; k < translations.size() / 3; ++k) {
      poses[k].translation = Eigen::Map<const Eigen::Vector3f>(&translations[3 * k]).cast<double>();
    }
    for (size_t k = 0; k < rotations.size() / 4; ++k) {
      poses[k].rotation.coeffs() = Eigen::Map<const Eigen::Vector4f>(&rotations[4 * k]).cast<double>();
    }
    for (Pose& pose : poses) pose.rotation.normalize();
    return poses;
  }

  /// The values of the animation channel of a node; empty if it is at rest.
  std::vector<float> read_channel(int node, const char* path, int type) const {
    if (model_.animations.empty()) return {};
    const tinygltf::Animation& motion = model_.animations[0];
    for (const tinygltf::AnimationChannel& channel : motion.channels) {
      if (channel.target_node != node || channel.target_path != path) continue;
      return read_floats(model_, at(motion.samplers, channel.sampler, "sampler").output, type);
    }
    return {};
  }

  double read_frames_per_second() const {
    if (model_.animations.empty() || model_.animations[0].samplers.empty())
      return Animation{}.frames_per_second;
    const auto times = read_floats(model_, model_.animations[0].samplers[0].input, TINYGLTF_TYPE_SCALAR);
    if (times.size() < 2 || !(times.back() > 0)) fail("the animation has no key times");
    return static_cast<double>(times.size() - 1) / static_cast<double>(times.back());
  }

  static void require_equal_frames(const Animation& animation) {
    size_t count = 1;
    for (const auto& cloth : animation.cloths) count = std::max(count, cloth.frames.size());
    for (const auto& body : animation.bodies)
      count = std::max({count, body.poses.size(), body.frames.size()});
    for (const auto& cloth : animation.cloths) {
      if (cloth.frames.size() != count) fail("cloth '" + cloth.name + "' is missing frames");
    }
    for (const auto& body : animation.bodies) {
      if (body.poses.size() != 1 && body.poses.size() != count)
        fail("body '" + body.name + "' is missing poses");
      if (!body.frames.empty() && body.frames.size() != count)
        fail("body '" + body.name + "' is missing frames");
    }
  }

  const tinygltf::Model& model_;
};

}  // namespace

Animation parse_glb(std::span<const unsigned char> bytes, const std::string& name) {
  try {
    const tinygltf::Model model = parse(bytes);
    return Reader(model).read();
  } catch (const InputError& error) {
    throw InputError(name + ": " + error.what());
  }
}

Animation read_glb(const std::filesystem::path& file) {
  const std::string bytes = read_bytes(file, "a .glb file");
  return parse_glb({reinterpret_cast<const unsigned char*>(bytes.data()), bytes.size()}, file.string());
}

}  // namespace weft::engine
