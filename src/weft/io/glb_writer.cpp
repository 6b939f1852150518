#include "weft/io/glb_writer.h"

#include <tiny_gltf.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <functional>
#include <limits>
#include <nlohmann/json.hpp>
#include <span>
#include <sstream>

#include "weft/core/spool_file.h"
#include "weft/error.h"
#include "weft/mesh/vertex_normals.h"

namespace weft::engine {
namespace {

constexpr size_t kJsonPerTarget = 1024;  // more than the accessors and views of a morph target take [bytes]
constexpr size_t kJsonPerMesh = 8192;    // more than the rest of a mesh takes [bytes]
constexpr double kRoughness = 0.8;       // cloth scatters light

/// Format of an accessor, in glTF's terms.
struct Layout {
  int type = TINYGLTF_TYPE_VEC3;
  int num_components = 3;
  int target = 0;           // GPU buffer, 0 for animation data
  bool has_bounds = false;  // with minimum and maximum: required for positions and key times
};
constexpr Layout kPositions{TINYGLTF_TYPE_VEC3, 3, TINYGLTF_TARGET_ARRAY_BUFFER, true};
constexpr Layout kNormals{TINYGLTF_TYPE_VEC3, 3, TINYGLTF_TARGET_ARRAY_BUFFER, false};
constexpr Layout kTexture{TINYGLTF_TYPE_VEC2, 2, TINYGLTF_TARGET_ARRAY_BUFFER, false};
constexpr Layout kParticles{TINYGLTF_TYPE_SCALAR, 1, TINYGLTF_TARGET_ARRAY_BUFFER, false};
constexpr Layout kTimes{TINYGLTF_TYPE_SCALAR, 1, 0, true};
constexpr Layout kWeights{TINYGLTF_TYPE_SCALAR, 1, 0, false};
constexpr Layout kTranslations{TINYGLTF_TYPE_VEC3, 3, 0, false};
constexpr Layout kRotations{TINYGLTF_TYPE_VEC4, 4, 0, false};

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

void require_shown(const AnimatedCloth& cloth, size_t num_particles) {
  const ShownVertices& shown = *cloth.shown;
  require_triangles(cloth.name, shown.triangles, shown.particles.size());
  require_count(cloth.name, "coordinates at rest", shown.rest.size(), 3 * shown.particles.size());
  if (!shown.texture.empty())
    require_count(cloth.name, "texture coordinates", shown.texture.size(), 2 * shown.particles.size());
  for (const int particle : shown.particles) {
    if (particle >= -1 && particle < static_cast<int>(num_particles)) continue;
    throw InputError("mesh '" + cloth.name + "' shows particle " + std::to_string(particle) + " of " +
                     std::to_string(num_particles));
  }
}

void require_finite(const std::string& name, size_t frame, std::span<const float> numbers) {
  if (std::all_of(numbers.begin(), numbers.end(), [](float x) { return std::isfinite(x); })) return;
  throw InputError("mesh '" + name + "' has a non-finite coordinate in frame " + std::to_string(frame));
}

void require_valid(const AnimatedBody::Pose& pose, const std::string& name, size_t frame) {
  if (pose.translation.allFinite() && pose.rotation.coeffs().allFinite()) return;
  throw InputError("body '" + name + "' has a non-finite pose in frame " + std::to_string(frame));
}

/// Checks that every mesh has all frames, and every body all or one pose.
void require_equal_counts(const Animation& animation) {
  const size_t frames = count_frames(animation);
  for (const AnimatedCloth& cloth : animation.cloths)
    require_count(cloth.name, "frames", cloth.frames.size(), frames);
  for (const AnimatedBody& body : animation.bodies) {
    if (body.poses.size() != 1) require_count(body.name, "poses", body.poses.size(), frames);
    if (!body.frames.empty()) require_count(body.name, "frames", body.frames.size(), frames);
  }
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

/// Numbers of particles, `width` each, as those of the shown vertices; those without a particle have `otherwise`,
/// of which there are `width` for each vertex or for all.
std::vector<float> spread(const std::vector<float>& of_particles, const AnimatedCloth& cloth, size_t width,
                          const std::vector<float>& otherwise) {
  if (!cloth.shown) return of_particles;
  std::vector<float> result;
  result.reserve(width * cloth.shown->particles.size());
  for (size_t v = 0; v < cloth.shown->particles.size(); ++v) {
    const int particle = cloth.shown->particles[v];
    const float* from = particle >= 0 ? &of_particles[width * static_cast<size_t>(particle)]
                                      : &otherwise[width * v % otherwise.size()];
    result.insert(result.end(), from, from + width);
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

bool has_texture(const AnimatedCloth& cloth) { return cloth.shown && !cloth.shown->texture.empty(); }

tinygltf::Value extras_of(const AnimatedCloth& cloth) {
  Extras weft = {{"role", tinygltf::Value(std::string("cloth"))}};
  if (!cloth.fabric_coordinates.empty())
    weft["fabric"] = tinygltf::Value(std::string(has_texture(cloth) ? "TEXCOORD_1" : "TEXCOORD_0"));
  if (!cloth.fabric.empty()) weft["fabric_name"] = tinygltf::Value(cloth.fabric);
  return tinygltf::Value(Extras{{"weft", tinygltf::Value(std::move(weft))}});
}

tinygltf::Value extras_of(const AnimatedBody& body) {
  Extras weft = {{"shape", tinygltf::Value(std::string("mesh"))}};
  if (body.shape) weft = std::visit([](const auto& shape) { return shape_extras(shape); }, *body.shape);
  weft["role"] = tinygltf::Value(std::string("collider"));
  return tinygltf::Value(Extras{{"weft", tinygltf::Value(std::move(weft))}});
}

}  // namespace

/// Builds the document; the bytes of its buffer are spooled to disk.
class GlbWriter::Builder {
 public:
  Builder(StagedFile& file, const Animation& meshes)
      : file_(file), meshes_(without_frames(meshes)), bytes_(file.file()) {
    if (meshes_.cloths.empty() && meshes_.bodies.empty()) throw InputError("the animation has no meshes");
    if (!(meshes_.frames_per_second > 0))
      throw InputError("the animation requires more than 0 frames per second");
    model_.asset.version = "2.0";
    model_.asset.generator = "Weft";
    model_.asset.extras = asset_extras();
    model_.buffers.emplace_back();
    model_.scenes.emplace_back().name = meshes_.title;
    model_.defaultScene = 0;
    poses_.resize(meshes_.bodies.size());
  }

  void add_frame(const AnimationFrame& frame) {
    for (size_t c = 0; c < meshes_.cloths.size(); ++c) {
      if (num_frames_ == 0) add_cloth(meshes_.cloths[c], frame.cloths[c]);
      add_positions(meshes_.cloths[c], frame.cloths[c], meshes_in_file_[c]);
    }
    for (size_t b = 0; b < meshes_.bodies.size(); ++b) {
      const AnimatedBody& body = meshes_.bodies[b];
      const std::vector<float>& moved = frame.body_vertices[b];
      MeshInFile& own = num_frames_ == 0 ? add_body(body, !moved.empty()) : meshes_in_file_[num_cloths() + b];
      require_valid(frame.poses[b], body.name, num_frames_);
      poses_[b].push_back(frame.poses[b]);
      if (own.is_moving)
        add_positions(body, moved, own);
      else if (num_frames_ == 0)
        add_positions(body, flatten(body.mesh.positions), own);
    }
    if (++num_frames_ == 1) size_of_first_ = bytes_.size();
    if (num_frames_ > max_frames())
      throw InputError(file_.file().string() + " cannot be written: " + std::to_string(num_frames_) +
                       " frames are more than the 4 GiB that glTF allows; write fewer frames");
  }

  /// By an upper bound of the size: vertices, poses, key times and weights, and their JSON text.
  size_t max_frames() const {
    size_t morphed = 0, per_frame = sizeof(float);
    for (const MeshInFile& own : meshes_in_file_) {
      if (own.is_moving) ++morphed, per_frame += 2 * own.base.size() * sizeof(float) + kJsonPerTarget;
    }
    per_frame += poses_.size() * 7 * sizeof(float);
    const size_t fixed = size_of_first_ + kJsonPerMesh * meshes_in_file_.size();
    const auto fits = [&](size_t frames) {
      const size_t weights = morphed > 0 ? frames * frames * sizeof(float) : 0;
      const size_t weights_in_json = morphed * frames * 4;  // "0.0,"
      return fixed + frames * per_frame + weights + weights_in_json <= std::numeric_limits<uint32_t>::max();
    };
    size_t most = 0;
    for (size_t step = size_t{1} << 31; step > 0; step /= 2) {
      if (fits(most + step)) most += step;
    }
    return most;
  }

  void finish() {
    if (num_frames_ == 0) throw InputError("the animation has no frames");
    add_motion();
    write_document();
    file_.finish();
  }

 private:
  /// A mesh of the document, and the base for differences of further frames.
  struct MeshInFile {
    int mesh = -1, node = -1;
    bool is_moving = false;      // a frame is a morph target
    size_t num_coordinates = 0;  // of the particles or vertices in each frame
    std::vector<float> base, normals;
  };

  size_t num_cloths() const { return meshes_.cloths.size(); }

  tinygltf::Value asset_extras() const {
    Extras extras;
    if (!meshes_.title.empty()) extras["title"] = tinygltf::Value(meshes_.title);
    tinygltf::Value::Array pairs;
    for (const auto& [a, b] : meshes_.passing)
      pairs.emplace_back(tinygltf::Value::Array{tinygltf::Value(a), tinygltf::Value(b)});
    if (!pairs.empty()) extras["passing"] = tinygltf::Value(std::move(pairs));
    return extras.empty() ? tinygltf::Value() : tinygltf::Value(std::move(extras));
  }

  void add_cloth(const AnimatedCloth& cloth, const std::vector<float>& positions) {
    const size_t num_particles = positions.size() / 3;
    require_triangles(cloth.name, cloth.triangles, num_particles);
    if (cloth.shown) require_shown(cloth, num_particles);
    MeshInFile& own = add_mesh(cloth.name, cloth.shown ? cloth.shown->triangles : cloth.triangles,
                               cloth.color, extras_of(cloth));
    own.is_moving = true;
    std::vector<std::vector<float>> textures;
    if (has_texture(cloth)) {
      textures.push_back(cloth.shown->texture);
      for (size_t k = 1; k < textures[0].size(); k += 2) textures[0][k] = 1 - textures[0][k];  // glTF: v down
    }
    if (!cloth.fabric_coordinates.empty()) {
      require_count(cloth.name, "fabric coordinates", cloth.fabric_coordinates.size(), num_particles * 2);
      textures.push_back(spread(cloth.fabric_coordinates, cloth, 2, {0, 0}));
    }
    for (size_t k = 0; k < textures.size(); ++k) {
      require_finite(cloth.name, 0, textures[k]);
      primitive(own).attributes["TEXCOORD_" + std::to_string(k)] = add_floats(textures[k], kTexture);
    }
    if (!cloth.shown) return;
    const std::vector<float> particles(cloth.shown->particles.begin(), cloth.shown->particles.end());
    primitive(own).attributes["_PARTICLE"] = add_floats(particles, kParticles);
  }

  MeshInFile& add_body(const AnimatedBody& body, bool is_deforming) {
    require_triangles(body.name, body.mesh.triangles, body.mesh.positions.size());
    MeshInFile& own = add_mesh(body.name, body.mesh.triangles, body.color, extras_of(body));
    own.is_moving = is_deforming;
    return own;
  }

  /// Checks that every frame has as many coordinates as the first.
  void require_same(const std::string& name, MeshInFile& own, size_t num_coordinates) const {
    if (num_frames_ == 0) own.num_coordinates = num_coordinates;
    require_count(name, "coordinates in a frame", num_coordinates, own.num_coordinates);
  }

  void add_positions(const AnimatedCloth& cloth, const std::vector<float>& positions, MeshInFile& own) {
    require_same(cloth.name, own, positions.size());
    const std::vector<float> normals = compute_vertex_normals(cloth.triangles, positions);
    add_vertices(cloth.name, spread(positions, cloth, 3, cloth.shown ? cloth.shown->rest : positions),
                 spread(normals, cloth, 3, {0, 1, 0}), own);
  }

  void add_positions(const AnimatedBody& body, const std::vector<float>& positions, MeshInFile& own) {
    require_same(body.name, own, positions.size());
    add_vertices(body.name, positions, compute_vertex_normals(body.mesh.triangles, positions), own);
  }

  /// The first frame as the vertices, the others as morph targets.
  void add_vertices(const std::string& name, std::vector<float> positions, std::vector<float> normals,
                    MeshInFile& own) {
    require_finite(name, num_frames_, positions);
    if (num_frames_ == 0) {
      primitive(own).attributes.merge(write_vertices(positions, normals));
      own.base = std::move(positions);
      own.normals = std::move(normals);
      return;
    }
    primitive(own).targets.push_back(
        write_vertices(difference(positions, own.base), difference(normals, own.normals)));
  }

  // ---- The end ----

  bool is_animated() const { return num_frames_ > 1; }

  void add_motion() {
    if (is_animated()) {
      std::vector<float> times(num_frames_);
      for (size_t k = 0; k < num_frames_; ++k)
        times[k] = static_cast<float>(static_cast<double>(k) / meshes_.frames_per_second);
      times_ = add_floats(times, kTimes);
    }
    add_weights();
    for (size_t b = 0; b < meshes_.bodies.size(); ++b)
      add_poses(meshes_in_file_[num_cloths() + b], poses_[b]);
    if (is_animated()) model_.animations.push_back(std::move(motion_));
  }

  /// Weights of morph targets, shared by all meshes: frame k shows only target k − 1.
  void add_weights() {
    const size_t num_targets = num_frames_ - 1;
    const bool has_targets = std::any_of(meshes_in_file_.begin(), meshes_in_file_.end(),
                                         [](const auto& m) { return m.is_moving; });
    if (!has_targets || !is_animated()) return;
    std::vector<float> row(num_targets);
    const size_t begin = bytes_.size();
    for (size_t k = 0; k < num_frames_; ++k) {
      if (k > 0) row[k - 1] = 1;
      bytes_.append(row.data(), num_targets * sizeof(float));
      if (k > 0) row[k - 1] = 0;
    }
    const int sampler = add_sampler(add_accessor(begin, num_frames_ * num_targets, kWeights));
    for (const MeshInFile& own : meshes_in_file_) {
      if (!own.is_moving) continue;
      model_.meshes[own.mesh].weights.assign(num_targets, 0.0);
      add_channel(own.node, "weights", sampler);
    }
  }

  /// The pose of a body at rest is in its node only.
  void add_poses(const MeshInFile& own, const std::vector<AnimatedBody::Pose>& poses) {
    const auto& [translation, rotation] = poses[0];
    const Eigen::Vector4d first = rotation.normalized().coeffs();
    model_.nodes[own.node].translation.assign(translation.begin(), translation.end());
    model_.nodes[own.node].rotation.assign(first.begin(), first.end());
    if (std::all_of(poses.begin(), poses.end(), [&](const auto& pose) { return pose == poses[0]; })) return;
    std::vector<float> translations, rotations;
    for (const auto& [moved, turned] : poses) {
      const Eigen::Vector4d xyzw = turned.normalized().coeffs();
      for (const double t : moved) translations.push_back(static_cast<float>(t));
      for (const double q : xyzw) rotations.push_back(static_cast<float>(q));
    }
    add_channel(own.node, "translation", add_sampler(add_floats(translations, kTranslations)));
    add_channel(own.node, "rotation", add_sampler(add_floats(rotations, kRotations)));
  }

  /// A header, the JSON chunk and the binary chunk: glTF 2.0, section 4.4.
  void write_document() {
    std::ostringstream alone;  // tinygltf's own file, whose buffer is empty
    tinygltf::TinyGLTF().WriteGltfSceneToStream(&model_, alone, false, true);
    const std::string file = std::move(alone).str();
    std::uint32_t length = 0;
    constexpr std::size_t kLengthAt = 12, kJsonAt = 20;
    std::memcpy(&length, file.data() + kLengthAt, sizeof length);
    nlohmann::json document = nlohmann::json::parse(file.begin() + kJsonAt, file.begin() + kJsonAt + length);
    document["buffers"][0]["byteLength"] = bytes_.size();
    std::string json = document.dump();
    json.resize((json.size() + 3) / 4 * 4, ' ');
    constexpr std::uint32_t kMagic = 0x46546C67, kVersion = 2, kJson = 0x4E4F534A, kBinary = 0x004E4942;
    const auto json_size = static_cast<std::uint32_t>(json.size()),
               binary_size = static_cast<std::uint32_t>(bytes_.size());
    const std::array<std::uint32_t, 5> header = {kMagic, kVersion, 28 + json_size + binary_size, json_size,
                                                 kJson};
    const std::array<std::uint32_t, 2> chunk = {binary_size, kBinary};
    file_.out().write(reinterpret_cast<const char*>(header.data()), sizeof header);
    file_.out() << json;
    file_.out().write(reinterpret_cast<const char*>(chunk.data()), sizeof chunk);
    bytes_.copy_to(file_.out());
  }

  // ---- Parts of the document; an add_ function returns the index of the new part ----

  MeshInFile& add_mesh(const std::string& name, const std::vector<Triangle>& triangles,
                       const std::array<double, 3>& color, tinygltf::Value extras) {
    static_assert(sizeof(Triangle) == 3 * sizeof(uint32_t));
    tinygltf::Accessor indices;
    indices.bufferView = add_bytes(triangles.data(), triangles.size() * sizeof(Triangle),
                                   TINYGLTF_TARGET_ELEMENT_ARRAY_BUFFER);
    indices.componentType = TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT;
    indices.type = TINYGLTF_TYPE_SCALAR;
    indices.count = 3 * triangles.size();
    model_.accessors.push_back(std::move(indices));
    tinygltf::Primitive primitive;
    primitive.mode = TINYGLTF_MODE_TRIANGLES;
    primitive.material = add_material(name, color);
    primitive.indices = static_cast<int>(model_.accessors.size()) - 1;
    tinygltf::Mesh mesh;
    mesh.name = name;
    mesh.primitives.push_back(std::move(primitive));
    model_.meshes.push_back(std::move(mesh));
    tinygltf::Node node;
    node.name = name;
    node.mesh = static_cast<int>(model_.meshes.size()) - 1;
    node.extras = std::move(extras);
    model_.nodes.push_back(std::move(node));
    const int index = static_cast<int>(model_.nodes.size()) - 1;
    model_.scenes[0].nodes.push_back(index);
    return meshes_in_file_.emplace_back(MeshInFile{
        .mesh = static_cast<int>(model_.meshes.size()) - 1, .node = index, .base = {}, .normals = {}});
  }

  tinygltf::Primitive& primitive(const MeshInFile& own) { return model_.meshes[own.mesh].primitives[0]; }

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

  std::map<std::string, int> write_vertices(std::span<const float> positions,
                                            std::span<const float> normals) {
    const int position_accessor = add_floats(positions, kPositions);
    return {{"POSITION", position_accessor}, {"NORMAL", add_floats(normals, kNormals)}};
  }

  int add_floats(std::span<const float> numbers, const Layout& layout) {
    const size_t begin = bytes_.size();
    bytes_.append(numbers.data(), numbers.size_bytes());
    const int index = add_accessor(begin, numbers.size(), layout);
    if (layout.has_bounds) set_bounds(model_.accessors[index], numbers, layout.num_components);
    return index;
  }

  /// An accessor for floats that are already written, from byte `begin` on.
  int add_accessor(size_t begin, size_t num_floats, const Layout& layout) {
    tinygltf::Accessor accessor;
    accessor.bufferView = add_view(begin, num_floats * sizeof(float), layout.target);
    accessor.componentType = TINYGLTF_COMPONENT_TYPE_FLOAT;
    accessor.type = layout.type;
    accessor.count = num_floats / layout.num_components;
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

  int add_bytes(const void* data, size_t num_bytes, int target) {
    const size_t begin = bytes_.size();
    bytes_.append(data, num_bytes);
    return add_view(begin, num_bytes, target);
  }

  /// Every accessor has its own view: no strides, and four-byte numbers keep all of them aligned.
  int add_view(size_t begin, size_t num_bytes, int target) {
    tinygltf::BufferView view;
    view.buffer = 0;
    view.byteOffset = begin;
    view.byteLength = num_bytes;
    view.target = target;
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

  StagedFile& file_;
  Animation meshes_;
  SpoolFile bytes_;  // of the document's buffer
  tinygltf::Model model_;
  tinygltf::Animation motion_;
  std::vector<MeshInFile> meshes_in_file_;              // (cloths, then bodies)
  std::vector<std::vector<AnimatedBody::Pose>> poses_;  // (bodies) of (num_frames)
  size_t num_frames_ = 0, size_of_first_ = 0;           // [bytes]
  int times_ = -1;                                      // accessor of the key times
};

GlbWriter::GlbWriter(StagedFile& file, const Animation& meshes)
    : builder_(std::make_unique<Builder>(file, meshes)) {}
GlbWriter::~GlbWriter() = default;
void GlbWriter::add_frame(const AnimationFrame& frame) { builder_->add_frame(frame); }
size_t GlbWriter::max_frames() const { return builder_->max_frames(); }
void GlbWriter::finish() { builder_->finish(); }

void write_glb(const std::filesystem::path& file, const Animation& animation) {
  require_equal_counts(animation);
  StagedFile staged(file);
  GlbWriter writer(staged, animation);
  for (size_t k = 0; k < count_frames(animation); ++k) writer.add_frame(get_frame(animation, k));
  writer.finish();
  staged.replace();
}

}  // namespace weft::engine
