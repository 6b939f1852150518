#include "weft/io/gltf_body.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <map>
#include <numeric>
#include <optional>
#include <utility>

#include "weft/core/nearest_name.h"
#include "weft/io/gltf_file.h"

namespace weft::engine {
namespace {

using Json = GltfFile::Json;
using Components = std::vector<GltfComponent>;
using enum GltfType;

// ---- Formats of accessors ----

const Components kFloats = {{float32}};
const Components kFractions = {{float32}, {uint8, true}, {uint16, true}};
const Components kSignedFractions = {{float32}, {int8, true}, {uint8, true}, {int16, true}, {uint16, true}};
const Components kJoints = {{uint8}, {uint16}};
const Components kIndices = {{uint8}, {uint16}, {uint32}};
const Components kQuantized = {{float32},    {int8},        {uint8},       {int16},       {uint16},
                               {int8, true}, {uint8, true}, {int16, true}, {uint16, true}};

std::string place_of(const char* kind, std::size_t index) { return kind + (" " + std::to_string(index)); }

// ---- Names ----

/// The objects' names, "node 3" for one without.
std::vector<std::string> read_names(const GltfFile& file, const char* list, const char* kind) {
  std::vector<std::string> names;
  for (const Json& object : file.list(list)) {
    const std::string place = place_of(kind, names.size());
    const std::string name = file.find_text(object, "name", place);
    names.push_back(name.empty() ? place : name);
  }
  return names;
}

constexpr std::size_t kMaxNames = 30;  // in a message

/// The index of a name. `available`: the names to list in the message.
int find_named(const GltfFile& file, const char* kind, const std::vector<std::string>& names,
               const std::string& name, const std::vector<std::string>& available) {
  const auto count = std::ranges::count(names, name);
  const auto quoted = '"' + name + '"';
  if (count == 1) return static_cast<int>(std::ranges::find(names, name) - names.begin());
  if (count > 1)
    file.fail("", std::to_string(count) + " " + kind + "s are named " + quoted + ", expected one");
  const std::string nearest = find_nearest(name, names);
  file.fail(
      "", std::string("no ") + kind + " is named " + quoted +
              (available.empty() ? "; there are none" : "; available: " + list_names(available, kMaxNames)) +
              (nearest.empty() ? "" : "; did you mean \"" + nearest + "\"?"));
}

// ---- Clips ----

std::vector<double> read_times(GltfFile& file, const Json& sampler, const std::string& place) {
  const int input = file.find_index(sampler, "input", file.count("accessors"), place);
  if (input < 0) file.fail(place, "input is missing");
  std::vector<double> times = file.read_numbers(input, {"SCALAR", kFloats}, place + ": input");
  const auto late = std::ranges::adjacent_find(times, std::greater_equal<>());
  if (late != times.end())
    file.fail(place, "input: key " + std::to_string(late - times.begin() + 1) +
                         " is not later than the previous one");
  return times;
}

GltfContents read_contents(GltfFile& file) {
  GltfContents contents;
  const std::vector<std::string> names = read_names(file, "nodes", "node");
  for (std::size_t n = 0; n < names.size(); ++n) {
    const int mesh =
        file.find_index(file.list("nodes")[n], "mesh", file.count("meshes"), place_of("node", n));
    if (mesh >= 0) contents.nodes.push_back(names[n]);
  }
  for (const std::string& name : read_names(file, "animations", "animation")) {
    const std::string place = place_of("animation", contents.clips.size());
    GltfClip clip{.name = name};
    const Json& samplers = file.find_list(file.list("animations")[contents.clips.size()], "samplers", place);
    for (std::size_t s = 0; s < samplers.size(); ++s) {
      const std::vector<double> times = read_times(file, samplers[s], place + ", " + place_of("sampler", s));
      clip.start = s == 0 ? times.front() : std::min(clip.start, times.front());
      clip.end = s == 0 ? times.back() : std::max(clip.end, times.back());
    }
    contents.clips.push_back(clip);
  }
  return contents;
}

// ---- Nodes ----

/// Column by column, with the last row 0 0 0 1.
Affine to_affine(const GltfFile& file, const double* numbers, const std::string& place) {
  constexpr double kRounding = 1e-4;  // of products of single-precision matrices
  const Eigen::Map<const Eigen::Matrix4d> matrix(numbers);
  if (!matrix.row(3).isApprox(Eigen::RowVector4d(0, 0, 0, 1), kRounding))
    file.fail(place, "the last row of the matrix is not 0 0 0 1");
  return Affine(matrix.topRows<3>());
}

Vec3 find_vec(const GltfFile& file, const Json& node, const char* key, const Vec3& otherwise,
              const std::string& place) {
  const std::vector<double> numbers = file.find_numbers(node, key, 3, place);
  return numbers.empty() ? otherwise : Vec3(numbers[0], numbers[1], numbers[2]);
}

AnimatedNode read_node(const GltfFile& file, const Json& json, const std::string& place) {
  AnimatedNode node;
  const std::vector<double> matrix = file.find_numbers(json, "matrix", 16, place);
  if (!matrix.empty()) node.matrix = to_affine(file, matrix.data(), place + ": matrix");
  for (const char* key : {"translation", "rotation", "scale"}) {
    if (node.matrix && json.contains(key)) file.fail(place, std::string("has a matrix and a ") + key);
  }
  node.translation = find_vec(file, json, "translation", Vec3::Zero(), place);
  node.scale = find_vec(file, json, "scale", Vec3::Ones(), place);
  const std::vector<double> rotation = file.find_numbers(json, "rotation", 4, place);
  if (rotation.empty()) return node;
  node.rotation.coeffs() = Eigen::Map<const Eigen::Vector4d>(rotation.data()).stableNormalized();
  if (node.rotation.coeffs().isZero(0)) file.fail(place, "rotation: expected a quaternion other than 0");
  return node;
}

/// Throws if a node is its own ancestor.
void require_no_cycles(const GltfFile& file, const std::vector<AnimatedNode>& nodes) {
  std::vector<int> seen_from(nodes.size(), -1);
  for (int first = 0; std::cmp_less(first, nodes.size()); ++first) {
    int n = first;
    for (; n >= 0 && seen_from[n] < 0; n = nodes[n].parent) seen_from[n] = first;
    if (n >= 0 && seen_from[n] == first) file.fail(place_of("node", n), "is its own ancestor");
  }
}

/// The nodes with their parents and transforms at rest. `children`: of each node.
std::vector<AnimatedNode> read_nodes(const GltfFile& file, std::vector<std::vector<int>>& children) {
  std::vector<AnimatedNode> nodes;
  for (const Json& json : file.list("nodes")) {
    const std::string place = place_of("node", nodes.size());
    nodes.push_back(read_node(file, json, place));
    children.push_back(file.find_indices(json, "children", file.count("nodes"), place));
  }
  for (std::size_t n = 0; n < nodes.size(); ++n) {
    for (const int child : children[n]) {
      int& parent = nodes[child].parent;
      if (parent >= 0)
        file.fail(place_of("node", child),
                  "is a child of " + place_of("node", parent) + " and of " + place_of("node", n));
      parent = static_cast<int>(n);
    }
  }
  require_no_cycles(file, nodes);
  return nodes;
}

/// Whether each node is a root or below one.
std::vector<bool> mark_below(std::vector<int> roots, const std::vector<std::vector<int>>& children) {
  std::vector<bool> is_below(children.size(), false);
  while (!roots.empty()) {
    const int n = roots.back();
    roots.pop_back();
    if (is_below[n]) continue;
    is_below[n] = true;
    roots.insert(roots.end(), children[n].begin(), children[n].end());
  }
  return is_below;
}

/// The default scene's roots; all nodes of a file without scenes.
std::vector<int> find_scene_roots(const GltfFile& file) {
  const int scene = file.find_index(file.top(), "scene", file.count("scenes"), "");
  if (file.count("scenes") > 0) {
    const std::size_t index = std::max(scene, 0);
    return file.find_indices(file.list("scenes")[index], "nodes", file.count("nodes"),
                             place_of("scene", index));
  }
  std::vector<int> all(file.count("nodes"));
  std::iota(all.begin(), all.end(), 0);
  return all;
}

// ---- Triangles ----

enum class Mode { triangles = 4, strip = 5, fan = 6 };

/// Appends the triangles of a primitive, whose vertices are numbered from `first`. Section 3.7.2.1 of the
/// specification.
void append_triangles(Mode mode, const std::vector<double>& indices, int first,
                      std::vector<Triangle>& triangles) {
  const std::size_t count = mode == Mode::triangles ? indices.size() / 3 : indices.size() - 2;
  for (std::size_t t = 0; t < count; ++t) {
    std::array<std::size_t, 3> at = {3 * t, 3 * t + 1, 3 * t + 2};
    if (mode == Mode::strip) at = {t, t + 1 + t % 2, t + 2 - t % 2};
    if (mode == Mode::fan) at = {t + 1, t + 2, 0};
    Triangle triangle;
    for (int c = 0; c < 3; ++c) triangle[c] = first + static_cast<int>(indices[at[c]]);
    const auto [a, b, c] = triangle;
    if (a != b && b != c && c != a) triangles.push_back(triangle);
  }
}

// ---- The body ----

/// A path of animation channels; width 0: the number of morph targets.
struct ChannelKind {
  std::string_view path;
  AnimationCurve AnimatedNode::*curve;
  std::size_t width;
  const char* type;
  const Components* components;
};
const std::array<ChannelKind, 4> kChannelKinds = {
    {{"translation", &AnimatedNode::translations, 3, "VEC3", &kFloats},
     {"rotation", &AnimatedNode::rotations, 4, "VEC4", &kSignedFractions},
     {"scale", &AnimatedNode::scales, 3, "VEC3", &kFloats},
     {"weights", &AnimatedNode::weights, 0, "SCALAR", &kSignedFractions}}};

/// Ignored parts of the file: the first place of each kind, and their number.
class Notes {
 public:
  void add(const std::string& what, const std::string& place, std::size_t count = 1) {
    const auto note = std::ranges::find(notes_, what, &Note::what);
    if (note == notes_.end())
      notes_.push_back({what, place, count});
    else
      note->count += count;
  }

  std::vector<std::string> messages(const std::string& file) const {
    std::vector<std::string> messages;
    for (const auto& [what, place, count] : notes_)
      messages.push_back(file + ": " + place + ": " + what +
                         (count > 1 ? "; " + std::to_string(count) + " in the file" : ""));
    return messages;
  }

 private:
  struct Note {
    std::string what, place;
    std::size_t count = 0;
  };
  std::vector<Note> notes_;
};

class BodyReader {
 public:
  BodyReader(GltfFile file, const GltfOptions& options) : file_(std::move(file)), options_(options) {}

  GltfBody read() {
    const GltfContents contents = read_contents(file_);
    std::vector<std::vector<int>> children;
    desc_.nodes = read_nodes(file_, children);
    scale_nodes();
    const std::vector<bool> is_in = mark_below(find_roots(contents), children);
    for (std::size_t n = 0; n < is_in.size(); ++n) {
      if (is_in[n]) add_part(static_cast<int>(n));
    }
    if (triangles_.empty())
      file_.fail("", options_.node.empty()
                         ? "the default scene has no triangles"
                         : "node \"" + options_.node + "\" and those below it have no triangles; " +
                               "nodes with meshes: " + list_names(contents.nodes, kMaxNames));
    const int clip = find_clip(contents);
    if (clip >= 0) add_clip(contents.clips[clip], clip);
    SkinnedMesh vertices(std::move(desc_));
    turn_mirrored(vertices);
    if (!has_uv_) uv_.clear();
    return {.vertices = std::move(vertices),
            .triangles = std::move(triangles_),
            .uv = std::move(uv_),
            .clip = clip < 0 ? "" : contents.clips[clip].name,
            .contents = contents,
            .warnings = notes_.messages(file_.name())};
  }

 private:
  /// Puts the nodes below a node that scales the whole.
  void scale_nodes() {
    if (options_.scale == 1) return;
    const int whole = static_cast<int>(desc_.nodes.size());
    for (AnimatedNode& node : desc_.nodes) {
      if (node.parent < 0) node.parent = whole;
    }
    desc_.nodes.push_back({.scale = Vec3::Constant(options_.scale)});
  }

  std::vector<int> find_roots(const GltfContents& contents) const {
    if (options_.node.empty()) return find_scene_roots(file_);
    return {find_named(file_, "node", read_names(file_, "nodes", "node"), options_.node, contents.nodes)};
  }

  // ---- Meshes ----

  void add_part(int n) {
    const Json& node = file_.list("nodes")[n];
    const std::string node_place = place_of("node", n);
    const int m = file_.find_index(node, "mesh", file_.count("meshes"), node_place);
    if (m < 0) return;
    const Json& mesh = file_.list("meshes")[m];
    const std::string place = place_of("mesh", m);
    SkinnedPart part{.node = n, .targets = std::vector<std::vector<Displacement>>(count_targets(m))};
    file_.charge(part.targets.size(), place);
    part.weights = file_.find_numbers(node, "weights", part.targets.size(), node_place);
    if (part.weights.empty()) part.weights = file_.find_numbers(mesh, "weights", part.targets.size(), place);
    part.weights.resize(part.targets.size(), 0.0);
    const int skin = file_.find_index(node, "skin", file_.count("skins"), node_place);
    if (skin >= 0) {
      part.skin = add_skin(skin);
      part.first_influence = {0};
    }
    const std::size_t first_triangle = triangles_.size();
    const Json& primitives = file_.find_list(mesh, "primitives", place);
    for (std::size_t p = 0; p < primitives.size(); ++p)
      add_primitive(primitives[p], place + ", " + place_of("primitive", p), part);
    if (part.rest.empty()) return;
    first_triangles_.push_back(first_triangle);
    desc_.parts.push_back(std::move(part));
  }

  std::size_t count_targets(int m) {
    const std::string place = place_of("mesh", m);
    const Json& primitives = file_.find_list(file_.list("meshes")[m], "primitives", place);
    file_.charge(primitives.size(), place);
    return primitives.empty() ? 0 : file_.find_list(primitives[0], "targets", place + ", primitive 0").size();
  }

  void add_primitive(const Json& primitive, const std::string& place, SkinnedPart& part) {
    file_.charge(1, place);
    constexpr std::uint64_t kTriangles = 4, kLast = 6;
    const std::uint64_t mode = file_.get_whole(primitive, "mode", kTriangles, place);
    if (mode > kLast) file_.fail(place, "mode is " + std::to_string(mode) + ", expected 0 to 6");
    if (mode < kTriangles) return notes_.add("points and lines are ignored", place);

    const Json& attributes = file_.get_object(primitive, "attributes", place);
    const std::vector<double> positions =
        read_attribute(attributes, "POSITION", {"VEC3", coordinate_types(kFloats)}, 0, place);
    const std::size_t count = positions.size() / 3, first = part.rest.size();
    if (uv_.size() + count > std::numeric_limits<int>::max())
      file_.fail(place, "the body has too many vertices");
    add_triangles(primitive, static_cast<Mode>(mode), count, place);
    for (std::size_t v = 0; v < count; ++v) part.rest.emplace_back(Eigen::Map<const Vec3>(&positions[3 * v]));
    add_uv(attributes, count, place);
    add_targets(primitive, first, count, place, part);
    if (part.skin >= 0) add_influences(attributes, count, place, part);
  }

  /// The numbers of an attribute. `count`: the number of vertices that it must have; 0: any.
  std::vector<double> read_attribute(const Json& attributes, const std::string& name,
                                     const GltfFormat& format, std::size_t count, const std::string& place) {
    const int accessor = file_.find_index(attributes, name.c_str(), file_.count("accessors"), place);
    const std::string at = place + ": " + name;
    if (accessor < 0) file_.fail(at, "is missing");
    const std::uint64_t actual =
        file_.get_whole(file_.list("accessors")[accessor], "count", std::nullopt, at);
    if (count > 0 && actual != count)
      file_.fail(at, "has " + std::to_string(actual) + " elements, expected one for each of the " +
                         std::to_string(count) + " vertices");
    return file_.read_numbers(accessor, format, at);
  }

  /// Types of coordinates: integers by an extension.
  Components coordinate_types(const Components& usual) const {
    return file_.uses("KHR_mesh_quantization") ? kQuantized : usual;
  }

  void add_triangles(const Json& primitive, Mode mode, std::size_t num_vertices, const std::string& place) {
    std::vector<double> indices;
    const int accessor = file_.find_index(primitive, "indices", file_.count("accessors"), place);
    const std::string at = place + ": indices";
    if (accessor >= 0) {
      indices = file_.read_numbers(accessor, {"SCALAR", kIndices}, at);
    } else {
      indices.resize(num_vertices);
      std::iota(indices.begin(), indices.end(), 0.0);
    }
    for (std::size_t k = 0; k < indices.size(); ++k) {
      if (indices[k] >= static_cast<double>(num_vertices))
        file_.fail(at, "number " + std::to_string(k) + " is " + std::to_string(std::llround(indices[k])) +
                           ", but there are " + std::to_string(num_vertices) + " vertices");
    }
    if (indices.size() < 3 || (mode == Mode::triangles && indices.size() % 3 != 0))
      file_.fail(at, "there are " + std::to_string(indices.size()) + ", expected " +
                         (mode == Mode::triangles ? "a multiple of 3" : "3 or more"));
    append_triangles(mode, indices, static_cast<int>(uv_.size()), triangles_);
  }

  void add_uv(const Json& attributes, std::size_t count, const std::string& place) {
    constexpr double kNotGiven = std::numeric_limits<double>::quiet_NaN();
    const std::size_t first = uv_.size();
    uv_.resize(first + count, {kNotGiven, kNotGiven});
    if (!attributes.contains("TEXCOORD_0")) return;
    has_uv_ = true;
    const std::vector<double> numbers =
        read_attribute(attributes, "TEXCOORD_0", {"VEC2", coordinate_types(kFractions)}, count, place);
    for (std::size_t v = 0; v < count; ++v) uv_[first + v] = {numbers[2 * v], numbers[2 * v + 1]};
  }

  void add_targets(const Json& primitive, std::size_t first, std::size_t count, const std::string& place,
                   SkinnedPart& part) {
    const Json& targets = file_.find_list(primitive, "targets", place);
    if (targets.size() != part.targets.size())
      file_.fail(place, "has " + std::to_string(targets.size()) +
                            " morph targets, but the mesh's first primitive has " +
                            std::to_string(part.targets.size()));
    file_.charge(targets.size(), place);
    const GltfFormat format{.type = "VEC3", .components = coordinate_types(kFloats), .may_be_empty = true};
    for (std::size_t t = 0; t < targets.size(); ++t) {
      if (!targets[t].contains("POSITION")) continue;
      const std::vector<double> numbers =
          read_attribute(targets[t], "POSITION", format, count, place + ", " + place_of("target", t));
      for (std::size_t v = 0; v < count; ++v) {
        const Vec3 by = Eigen::Map<const Vec3>(&numbers[3 * v]);
        if (by != Vec3::Zero()) part.targets[t].push_back({static_cast<int>(first + v), by});
      }
    }
  }

  // ---- Skins ----

  int add_skin(int index) {
    const auto [skin, is_new] = skins_.try_emplace(index, static_cast<int>(desc_.skins.size()));
    if (is_new) desc_.skins.push_back(read_skin(index));
    return skin->second;
  }

  Skin read_skin(int index) {
    const Json& json = file_.list("skins")[index];
    const std::string place = place_of("skin", index);
    Skin skin{.joints = file_.find_indices(json, "joints", file_.count("nodes"), place), .inverse_bind = {}};
    if (skin.joints.empty()) file_.fail(place, "joints: expected one node or more");
    skin.inverse_bind.assign(skin.joints.size(), Affine::Identity());
    const int accessor = file_.find_index(json, "inverseBindMatrices", file_.count("accessors"), place);
    if (accessor < 0) return skin;
    const std::string at = place + ": inverseBindMatrices";
    const std::vector<double> numbers = file_.read_numbers(accessor, {"MAT4", kFloats}, at);
    if (numbers.size() < 16 * skin.joints.size())
      file_.fail(at, "has " + std::to_string(numbers.size() / 16) + " matrices, but the skin has " +
                         std::to_string(skin.joints.size()) + " joints");
    for (std::size_t j = 0; j < skin.joints.size(); ++j)
      skin.inverse_bind[j] = to_affine(file_, &numbers[16 * j], at + ": element " + std::to_string(j));
    return skin;
  }

  void add_influences(const Json& attributes, std::size_t count, const std::string& place,
                      SkinnedPart& part) {
    const std::size_t num_sets = attributes.contains("JOINTS_1") || attributes.contains("WEIGHTS_1") ? 2 : 1;
    if (attributes.contains("JOINTS_2")) notes_.add("joints after the eighth of a vertex are ignored", place);
    std::array<std::vector<Influence>, 2> sets;  // (num_vertices x 4)
    for (std::size_t s = 0; s < num_sets; ++s)
      sets[s] =
          read_influences(attributes, std::to_string(s), count, desc_.skins[part.skin].joints.size(), place);
    std::size_t num_unweighted = 0;
    for (std::size_t v = 0; v < count; ++v) {
      double sum = 0;
      for (std::size_t k = 0; k < 4 * num_sets; ++k) {
        part.influences.push_back(sets[k / 4][4 * v + k % 4]);
        sum += part.influences.back().weight;
      }
      part.first_influence.push_back(part.influences.size());
      if (sum == 0) ++num_unweighted;
    }
    if (num_unweighted > 0)
      notes_.add("vertices without joint weights follow their first joint", place, num_unweighted);
  }

  /// Of the attributes JOINTS_… and WEIGHTS_…, four for each vertex.
  std::vector<Influence> read_influences(const Json& attributes, const std::string& set, std::size_t count,
                                         std::size_t num_joints, const std::string& place) {
    const std::string joints_name = "JOINTS_" + set, weights_name = "WEIGHTS_" + set;
    const std::vector<double> joints =
        read_attribute(attributes, joints_name, {"VEC4", kJoints}, count, place);
    const std::vector<double> weights =
        read_attribute(attributes, weights_name, {"VEC4", kFractions}, count, place);
    std::vector<Influence> influences;
    for (std::size_t k = 0; k < joints.size(); ++k) {
      const auto joint = static_cast<int>(joints[k]);
      const auto fail = [&](const std::string& name, const std::string& mistake) {
        file_.fail(place + ": " + name, place_of("vertex", k / 4) + " has " + mistake);
      };
      if (std::cmp_greater_equal(joint, num_joints))
        fail(joints_name, place_of("joint", joint) + ", but the skin has " + std::to_string(num_joints));
      if (weights[k] < 0) fail(weights_name, "a negative weight, expected 0 or more");
      influences.push_back({joint, weights[k]});
    }
    return influences;
  }

  // ---- Animation ----

  int find_clip(const GltfContents& contents) const {
    if (options_.clip.empty()) return contents.clips.empty() ? -1 : 0;
    std::vector<std::string> names;
    for (const GltfClip& clip : contents.clips) names.push_back(clip.name);
    return find_named(file_, "clip", names, options_.clip, names);
  }

  void add_clip(const GltfClip& clip, int index) {
    desc_.start = clip.start;
    desc_.end = clip.end;
    const Json& animation = file_.list("animations")[index];
    const std::string place = place_of("animation", index);
    const Json& channels = file_.find_list(animation, "channels", place);
    const Json& samplers = file_.find_list(animation, "samplers", place);
    for (std::size_t c = 0; c < channels.size(); ++c)
      add_channel(channels[c], samplers, place + ", " + place_of("channel", c));
  }

  void add_channel(const Json& channel, const Json& samplers, const std::string& place) {
    const Json& target = file_.get_object(channel, "target", place);
    const int n = file_.find_index(target, "node", desc_.nodes.size(), place);
    if (n < 0) return;  // for an extension
    const std::string path = file_.find_text(target, "path", place), node_place = place_of("node", n);
    const auto kind = std::ranges::find(kChannelKinds, path, &ChannelKind::path);
    if (kind == kChannelKinds.end())
      return notes_.add("channels other than translation, rotation, scale and weights are ignored", place);
    const std::size_t width = kind->width > 0 ? kind->width : count_targets_of_node(n);
    if (width == 0) file_.fail(place, "animates morph targets of " + node_place + ", which has none");
    AnimatedNode& node = desc_.nodes[n];
    if (node.matrix && kind->width > 0) file_.fail(place, "animates " + node_place + ", which has a matrix");
    AnimationCurve& curve = node.*kind->curve;
    if (!curve.empty()) file_.fail(place, "animates the " + path + " of " + node_place + " once more");
    const int s = file_.find_index(channel, "sampler", samplers.size(), place);
    if (s < 0) file_.fail(place, "sampler is missing");
    curve = read_curve(samplers[s], {kind->type, *kind->components}, width,
                       place + ", " + place_of("sampler", s));
    if (path == "rotation") require_rotations(curve, place);
  }

  std::size_t count_targets_of_node(int n) {
    const int m =
        file_.find_index(file_.list("nodes")[n], "mesh", file_.count("meshes"), place_of("node", n));
    return m < 0 ? 0 : count_targets(m);
  }

  AnimationCurve read_curve(const Json& sampler, const GltfFormat& format, std::size_t width,
                            const std::string& place) {
    AnimationCurve curve;
    const std::string name = file_.find_text(sampler, "interpolation", place);
    if (name == "STEP") curve.interpolation = Interpolation::step;
    if (name == "CUBICSPLINE") curve.interpolation = Interpolation::cubic_spline;
    if (curve.interpolation == Interpolation::linear && !name.empty() && name != "LINEAR")
      file_.fail(place, "interpolation is \"" + name + "\", expected LINEAR, STEP or CUBICSPLINE");
    curve.times = read_times(file_, sampler, place);
    const int output = file_.find_index(sampler, "output", file_.count("accessors"), place);
    if (output < 0) file_.fail(place, "output is missing");
    curve.values = file_.read_numbers(output, format, place + ": output");
    const std::size_t num_rows =
        curve.times.size() * (curve.interpolation == Interpolation::cubic_spline ? 3 : 1);
    if (curve.values.size() != num_rows * width)
      file_.fail(place + ": output", "has " + std::to_string(curve.values.size()) + " numbers, expected " +
                                         std::to_string(num_rows * width) + " for " +
                                         std::to_string(curve.times.size()) + " keys");
    return curve;
  }

  void require_rotations(const AnimationCurve& curve, const std::string& place) const {
    const bool is_spline = curve.interpolation == Interpolation::cubic_spline;
    for (std::size_t k = 0; k < curve.times.size(); ++k) {
      const std::size_t row = is_spline ? 3 * k + 1 : k;
      if (Eigen::Map<const Eigen::Vector4d>(&curve.values[4 * row]).isZero(0))
        file_.fail(place, "the rotation of key " + std::to_string(k) + " is 0, expected a unit quaternion");
    }
  }

  /// Swaps two corners of the triangles of parts that their nodes mirror.
  void turn_mirrored(const SkinnedMesh& vertices) {
    for (std::size_t p = 0; p < first_triangles_.size(); ++p) {
      if (!vertices.is_mirrored(static_cast<int>(p))) continue;
      const std::size_t end = p + 1 < first_triangles_.size() ? first_triangles_[p + 1] : triangles_.size();
      for (std::size_t t = first_triangles_[p]; t < end; ++t) std::swap(triangles_[t][1], triangles_[t][2]);
    }
  }

  GltfFile file_;
  const GltfOptions& options_;
  SkinnedMeshDesc desc_;
  std::map<int, int> skins_;                  // of the file, to those of `desc_`
  std::vector<std::size_t> first_triangles_;  // by part
  std::vector<Triangle> triangles_;
  std::vector<Eigen::Vector2d> uv_;  // (num_vertices)
  bool has_uv_ = false;              // of any primitive
  Notes notes_;
};

}  // namespace

GltfBody read_gltf_body(const std::filesystem::path& file, const GltfOptions& options) {
  return BodyReader(GltfFile(read_file_bytes(file), file.string(), file.parent_path()), options).read();
}

GltfBody parse_gltf_body(std::span<const unsigned char> bytes, const std::string& name,
                         const GltfOptions& options) {
  return BodyReader(GltfFile({bytes.begin(), bytes.end()}, name, std::nullopt), options).read();
}

MeshFromFile mesh_at_start(const GltfBody& body) {
  MeshFromFile result{.mesh = {.triangles = body.triangles}, .warnings = body.warnings};
  body.vertices.evaluate(body.vertices.start(), result.mesh.positions);
  for (const Triangle& triangle : body.triangles) {
    if (body.uv.empty()) break;
    CornerUv& corners = result.uv.emplace_back();
    for (int c = 0; c < 3; ++c)
      corners[c] = {body.uv[triangle[c]].x(), 1 - body.uv[triangle[c]].y()};  // v up
  }
  result.faces = make_faces(result.mesh.triangles, result.uv);
  return result;
}

GltfContents list_gltf(const std::filesystem::path& file) {
  GltfFile gltf(read_file_bytes(file), file.string(), file.parent_path());
  return read_contents(gltf);
}

}  // namespace weft::engine
