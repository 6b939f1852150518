#include "weft/io/glb_reader.h"

#include <tiny_gltf.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <fstream>
#include <functional>
#include <nlohmann/json.hpp>
#include <string_view>
#include <utility>

#include "weft/error.h"
#include "weft/io/input_file.h"

namespace weft::engine {
namespace {

using Pose = AnimatedBody::Pose;
using Value = tinygltf::Value;

/// Throws the mistake in the file; the Reader's caller adds the file name.
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

/// A file's bytes, read where they are needed.
struct Bytes {
  std::uint64_t size = 0;
  std::function<void(std::uint64_t offset, void* to, std::size_t count)> read;  // within `size`
};

Bytes open_bytes(const std::filesystem::path& file) {
  auto in = std::make_shared<std::ifstream>(open_input(file, "a .glb file"));
  in->seekg(0, std::ios::end);
  const std::streamoff size = in->tellg();
  if (size < 0) fail(file.string() + ": cannot be read");
  return {static_cast<std::uint64_t>(size), [in](std::uint64_t offset, void* to, std::size_t count) {
            in->clear();
            in->seekg(static_cast<std::streamoff>(offset));
            if (!in->read(static_cast<char*>(to), static_cast<std::streamsize>(count)))
              fail("cannot be read");
          }};
}

Bytes view_bytes(std::span<const unsigned char> bytes) {
  return {bytes.size(), [bytes](std::uint64_t offset, void* to, std::size_t count) {
            std::memcpy(to, bytes.data() + offset, count);
          }};
}

[[noreturn]] void fail_incomplete(const std::string& reason = {}) {
  fail("is not a complete .glb file" + (reason.empty() ? "" : " (" + reason + ")") +
       "; expected one that weft run wrote");
}

/// The text of a .glb file, and the place of its buffer.
struct Chunks {
  std::string json;
  std::uint64_t buffer_at = 0, buffer_size = 0;  // [bytes]
};

/// A header, the JSON chunk and the binary chunk: glTF 2.0, section 4.4.
Chunks read_chunks(const Bytes& bytes) {
  constexpr std::uint32_t kMagic = 0x46546C67, kVersion = 2, kJson = 0x4E4F534A, kBinary = 0x004E4942;
  const auto read_words = [&]<std::size_t n>(std::uint64_t offset, std::array<std::uint32_t, n>& words) {
    if (offset + sizeof words > bytes.size) fail_incomplete();
    bytes.read(offset, words.data(), sizeof words);
  };
  std::array<std::uint32_t, 5> header;
  read_words(0, header);
  const std::uint64_t json_at = sizeof header, json_size = header[3];
  if (header[0] != kMagic || header[1] != kVersion || header[4] != kJson || header[2] > bytes.size ||
      json_at + json_size > header[2])
    fail_incomplete();
  Chunks chunks;
  chunks.json.resize(json_size);
  bytes.read(json_at, chunks.json.data(), json_size);
  std::array<std::uint32_t, 2> chunk;
  if (json_at + json_size + sizeof chunk > header[2]) return chunks;
  read_words(json_at + json_size, chunk);
  chunks.buffer_at = json_at + json_size + sizeof chunk;
  chunks.buffer_size = chunk[0];
  if (chunk[1] != kBinary || chunks.buffer_at + chunks.buffer_size > bytes.size) fail_incomplete();
  return chunks;
}

/// Whether the nesting of brackets in the file's text is safe for the recursion of tinygltf.
bool is_flat_enough(std::string_view json) {
  constexpr int kDeepest = 100;
  int depth = 0;
  bool is_text = false;
  for (std::size_t k = 0; k < json.size(); ++k) {
    const char c = json[k];
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

/// The document without its buffer, which stays in the file.
tinygltf::Model parse(const Chunks& chunks) {
  if (!is_flat_enough(chunks.json)) fail_incomplete();
  nlohmann::json document = nlohmann::json::parse(chunks.json, nullptr, false);
  if (!document.is_object()) fail_incomplete();
  if (const auto buffers = document.find("buffers"); buffers != document.end()) {
    const bool is_own = buffers->is_array() && (buffers->empty() || (*buffers)[0].is_object());
    if (!is_own) fail_incomplete();
    for (const nlohmann::json& buffer : *buffers) {
      const auto length = buffer.find("byteLength");
      if (buffers->size() > 1 || buffer.contains("uri") || length == buffer.end() ||
          !length->is_number_unsigned() || length->get<std::uint64_t>() == 0 ||
          length->get<std::uint64_t>() > chunks.buffer_size)
        fail_incomplete();
    }
    document.erase(buffers);
  }
  const std::string text = document.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
  tinygltf::TinyGLTF loader;
  stay_in_the_file(loader);
  tinygltf::Model model;
  std::string error, warning;
  if (!loader.LoadASCIIFromString(&model, &error, &warning, text.data(), static_cast<unsigned>(text.size()),
                                  ""))
    fail_incomplete(error.substr(0, error.find('\n')));
  return model;
}

// ---- Nodes ----

const tinygltf::Primitive& primitive_of(const tinygltf::Model& model, const tinygltf::Node& node) {
  return at(at(model.meshes, node.mesh, "mesh").primitives, 0, "primitive");
}

std::array<double, 3> read_color(const tinygltf::Model& model, const tinygltf::Primitive& primitive) {
  const auto& factor =
      at(model.materials, primitive.material, "material").pbrMetallicRoughness.baseColorFactor;
  if (factor.size() < 3) fail("material " + std::to_string(primitive.material) + " has no colour");
  return {factor[0], factor[1], factor[2]};
}

/// A vertex of each particle, by the particles of the vertices.
std::vector<int> find_vertices(const std::vector<float>& particles, const std::string& cloth) {
  std::vector<int> vertices;
  const auto most = static_cast<float>(particles.size());
  for (std::size_t v = 0; v < particles.size(); ++v) {
    if (particles[v] == -1) continue;
    const bool is_in_range = particles[v] >= 0 && particles[v] < most;
    const auto particle = static_cast<std::size_t>(is_in_range ? particles[v] : 0);
    if (!is_in_range || static_cast<float>(particle) != particles[v])
      fail("cloth '" + cloth + "' has a wrong particle at vertex " + std::to_string(v));
    if (particle >= vertices.size()) vertices.resize(particle + 1, -1);
    if (vertices[particle] < 0) vertices[particle] = static_cast<int>(v);
  }
  const auto missing = std::find(vertices.begin(), vertices.end(), -1);
  if (missing != vertices.end())
    fail("cloth '" + cloth + "' has no vertex of particle " + std::to_string(missing - vertices.begin()));
  return vertices;
}

/// Of `width` numbers for each vertex, those of the particles' vertices; without any: all.
std::vector<float> pick(std::vector<float> numbers, std::size_t width,
                        const std::optional<std::vector<int>>& vertices) {
  if (!vertices) return numbers;
  std::vector<float> picked;
  picked.reserve(width * vertices->size());
  for (const int v : *vertices) {
    const auto first = numbers.begin() + static_cast<std::ptrdiff_t>(width) * v;
    picked.insert(picked.end(), first, first + static_cast<std::ptrdiff_t>(width));
  }
  return picked;
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

}  // namespace

class GlbFrames::Reader {
 public:
  explicit Reader(Bytes bytes)
      : bytes_(std::move(bytes)), chunks_(read_chunks(bytes_)), model_(parse(chunks_)) {
    if (model_.asset.extras.Has("title")) meshes_.title = model_.asset.extras.Get("title").Get<std::string>();
    meshes_.passing = read_passing();
    meshes_.frames_per_second = read_frames_per_second();
    for (std::size_t n = 0; n < model_.nodes.size(); ++n) add_node(static_cast<int>(n));
    if (cloths_.empty() && bodies_.empty()) {
      fail(
          "has no cloth: no node has Weft's mark, \"extras\": {\"weft\": {\"role\": \"cloth\"}}; "
          "expected a "
          "file that weft run wrote");
    }
    count_frames();
  }

  const Animation& meshes() const { return meshes_; }
  int num_frames() const { return static_cast<int>(num_frames_); }

  AnimationFrame read(int frame) const {
    const auto k = static_cast<std::size_t>(frame);
    AnimationFrame result;
    for (const Morphed& cloth : cloths_)
      result.cloths.push_back(pick(read_morphed(cloth, k), 3, cloth.vertices));
    for (const MovingBody& body : bodies_) {
      result.poses.push_back(body.poses[body.poses.size() > 1 ? k : 0]);
      const bool is_deforming = body.mesh.num_frames() > 1;
      result.body_vertices.push_back(is_deforming ? read_morphed(body.mesh, k) : std::vector<float>());
    }
    return result;
  }

 private:
  /// A mesh with morph targets.
  struct Morphed {
    const tinygltf::Primitive* primitive = nullptr;
    std::string name;
    std::vector<float> base;                   // (num_vertices x 3), the first frame
    std::optional<std::vector<int>> vertices;  // (num_particles) of the particles; empty: all in their order

    std::size_t num_frames() const { return 1 + primitive->targets.size(); }
  };

  struct MovingBody {
    Morphed mesh;
    std::vector<Pose> poses;
  };

  // ---- Accessors ----

  /// All numbers of an accessor with contiguous elements, as written by write_glb.
  template <class Number>
  std::vector<Number> read_numbers(int index, int component_type, int type) const {
    const tinygltf::Accessor& accessor = at(model_.accessors, index, "accessor");
    if (accessor.componentType != component_type || accessor.type != type || accessor.sparse.isSparse) {
      fail("accessor " + std::to_string(index) + " has a component type that Weft does not write");
    }
    const tinygltf::BufferView& view = at(model_.bufferViews, accessor.bufferView, "buffer view");
    const std::size_t num_components = tinygltf::GetNumComponentsInType(static_cast<uint32_t>(type));
    const std::size_t element = num_components * sizeof(Number);
    const bool is_packed = view.byteStride == 0 || view.byteStride == element;
    if (!is_packed || view.buffer != 0 || view.byteOffset > chunks_.buffer_size ||
        view.byteLength > chunks_.buffer_size - view.byteOffset || accessor.byteOffset > view.byteLength ||
        accessor.count > (view.byteLength - accessor.byteOffset) / element) {
      fail("accessor " + std::to_string(index) + " exceeds its data");
    }
    std::vector<Number> numbers(accessor.count * num_components);
    if (!numbers.empty())
      bytes_.read(chunks_.buffer_at + view.byteOffset + accessor.byteOffset, numbers.data(),
                  numbers.size() * sizeof(Number));
    return numbers;
  }

  std::vector<float> read_floats(int index, int type) const {
    auto numbers = read_numbers<float>(index, TINYGLTF_COMPONENT_TYPE_FLOAT, type);
    if (std::all_of(numbers.begin(), numbers.end(), [](float x) { return std::isfinite(x); })) return numbers;
    fail("accessor " + std::to_string(index) + " has a non-finite number");
  }

  std::vector<float> read_positions(const std::map<std::string, int>& attributes) const {
    const auto found = attributes.find("POSITION");
    if (found == attributes.end()) fail("a mesh has no positions");
    return read_floats(found->second, TINYGLTF_TYPE_VEC3);
  }

  std::vector<Triangle> read_triangles(int index, std::size_t num_vertices) const {
    const auto indices =
        read_numbers<uint32_t>(index, TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT, TINYGLTF_TYPE_SCALAR);
    std::vector<Triangle> triangles(indices.size() / 3);
    for (std::size_t k = 0; k < 3 * triangles.size(); ++k) {
      if (indices[k] >= num_vertices) {
        fail("a triangle uses vertex " + std::to_string(indices[k]) + " of " + std::to_string(num_vertices));
      }
      triangles[k / 3][k % 3] = static_cast<int>(indices[k]);
    }
    return triangles;
  }

  // ---- Meshes ----

  Morphed read_mesh(const tinygltf::Node& node) const {
    const tinygltf::Primitive& primitive = primitive_of(model_, node);
    return {.primitive = &primitive,
            .name = node.name,
            .base = read_positions(primitive.attributes),
            .vertices = std::nullopt};
  }

  /// The vertices of a frame.
  std::vector<float> read_morphed(const Morphed& mesh, std::size_t frame) const {
    if (frame == 0) return mesh.base;
    std::vector<float> moved = read_positions(mesh.primitive->targets[frame - 1]);
    if (moved.size() != mesh.base.size())
      fail("the frames of mesh '" + mesh.name + "' have unequal numbers of vertices");
    for (std::size_t k = 0; k < moved.size(); ++k) moved[k] += mesh.base[k];
    return moved;
  }

  void add_node(int index) {
    const tinygltf::Node& node = model_.nodes[index];
    if (!node.extras.Has("weft") || !node.extras.Get("weft").IsObject()) return;
    const Value& weft = node.extras.Get("weft");
    const auto text = [&](const char* key) {
      return weft.Get(key).IsString() ? weft.Get(key).Get<std::string>() : "";
    };
    if (text("role") == "cloth") {
      add_cloth(node, text("fabric"));
      meshes_.cloths.back().fabric = text("fabric_name");
    }
    if (text("role") == "collider") add_body(index);
  }

  /// `fabric`: the attribute of its fabric coordinates, "" for none.
  void add_cloth(const tinygltf::Node& node, const std::string& fabric) {
    Morphed own = read_mesh(node);
    const auto& attributes = own.primitive->attributes;
    const std::size_t num_vertices = own.base.size() / 3;
    AnimatedCloth cloth{.name = node.name,
                        .triangles = read_triangles(own.primitive->indices, num_vertices),
                        .color = read_color(model_, *own.primitive),
                        .frames = {}};
    if (const auto found = attributes.find("_PARTICLE"); found != attributes.end()) {
      const std::vector<float> particles = read_floats(found->second, TINYGLTF_TYPE_SCALAR);
      if (particles.size() != num_vertices)
        fail("cloth '" + node.name + "' has more or fewer particles than vertices");
      own.vertices = find_vertices(particles, node.name);
      for (Triangle& triangle : cloth.triangles) {
        for (int& corner : triangle) {
          if (particles[corner] < 0)
            fail("cloth '" + node.name + "' has a triangle at vertex " + std::to_string(corner) +
                 ", which has no particle");
          corner = static_cast<int>(particles[corner]);
        }
      }
    }
    if (const auto found = attributes.find(fabric); found != attributes.end()) {
      std::vector<float> coordinates = read_floats(found->second, TINYGLTF_TYPE_VEC2);
      if (coordinates.size() != 2 * num_vertices)
        fail("cloth '" + node.name + "' has more or fewer fabric coordinates than vertices");
      cloth.fabric_coordinates = pick(std::move(coordinates), 2, own.vertices);
    }
    cloths_.push_back(std::move(own));
    meshes_.cloths.push_back(std::move(cloth));
  }

  void add_body(int index) {
    const tinygltf::Node& node = model_.nodes[index];
    MovingBody own{.mesh = read_mesh(node), .poses = read_poses(index)};
    AnimatedBody body;
    body.name = node.name;
    const std::vector<float>& positions = own.mesh.base;
    for (std::size_t k = 0; k + 2 < positions.size(); k += 3)
      body.mesh.positions.emplace_back(positions[k], positions[k + 1], positions[k + 2]);
    body.mesh.triangles = read_triangles(own.mesh.primitive->indices, body.mesh.positions.size());
    body.shape = read_shape(node.extras.Get("weft"));
    bodies_.push_back(std::move(own));
    meshes_.bodies.push_back(std::move(body));
  }

  // ---- Motion ----

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
      return read_floats(at(motion.samplers, channel.sampler, "sampler").output, type);
    }
    return {};
  }

  double read_frames_per_second() const {
    if (model_.animations.empty() || model_.animations[0].samplers.empty())
      return Animation{}.frames_per_second;
    const auto times = read_floats(model_.animations[0].samplers[0].input, TINYGLTF_TYPE_SCALAR);
    if (times.size() < 2 || !(times.back() > 0)) fail("the animation has no key times");
    return static_cast<double>(times.size() - 1) / static_cast<double>(times.back());
  }

  void count_frames() {
    for (const Morphed& cloth : cloths_) num_frames_ = std::max(num_frames_, cloth.num_frames());
    for (const MovingBody& body : bodies_)
      num_frames_ = std::max({num_frames_, body.poses.size(), body.mesh.num_frames()});
    for (const Morphed& cloth : cloths_) {
      if (cloth.num_frames() != num_frames_) fail("cloth '" + cloth.name + "' is missing frames");
    }
    for (const MovingBody& body : bodies_) {
      if (body.poses.size() != 1 && body.poses.size() != num_frames_)
        fail("body '" + body.mesh.name + "' is missing poses");
      if (body.mesh.num_frames() != 1 && body.mesh.num_frames() != num_frames_)
        fail("body '" + body.mesh.name + "' is missing frames");
    }
  }

  Bytes bytes_;
  Chunks chunks_;
  tinygltf::Model model_;
  Animation meshes_;
  std::vector<Morphed> cloths_;
  std::vector<MovingBody> bodies_;
  std::size_t num_frames_ = 1;
};

namespace {

/// The result of `read`; errors begin with the file's name.
template <class Read>
auto with_name(const std::string& name, const Read& read) {
  try {
    return read();
  } catch (const InputError& error) {
    throw InputError(name + ": " + error.what());
  }
}

}  // namespace

GlbFrames::GlbFrames(const std::filesystem::path& file) : name_(file.string()) {
  const Bytes bytes = open_bytes(file);
  reader_ = with_name(name_, [&] { return std::make_unique<Reader>(bytes); });
}

GlbFrames::GlbFrames(std::span<const unsigned char> bytes, std::string name) : name_(std::move(name)) {
  reader_ = with_name(name_, [&] { return std::make_unique<Reader>(view_bytes(bytes)); });
}

GlbFrames::~GlbFrames() = default;
const Animation& GlbFrames::meshes() const { return reader_->meshes(); }
int GlbFrames::num_frames() { return reader_->num_frames(); }

AnimationFrame GlbFrames::read(int frame) {
  return with_name(name_, [&] { return reader_->read(frame); });
}

Animation read_glb(const std::filesystem::path& file) {
  GlbFrames frames(file);
  return read_all(frames);
}

Animation parse_glb(std::span<const unsigned char> bytes, const std::string& name) {
  GlbFrames frames(bytes, name);
  return read_all(frames);
}

}  // namespace weft::engine
