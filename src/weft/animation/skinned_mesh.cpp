#include "weft/animation/skinned_mesh.h"

#include <algorithm>
#include <span>

namespace weft::engine {
namespace {

Vec3 evaluate_or(const AnimationCurve& curve, double time, const Vec3& constant) {
  if (curve.empty()) return constant;
  Vec3 value;
  evaluate(curve, time, {value.data(), 3});
  return value;
}

/// From the node to its parent.
Affine local_transform(const AnimatedNode& node, double time) {
  if (node.matrix) return *node.matrix;
  const Eigen::Quaterniond rotation =
      node.rotations.empty() ? node.rotation : evaluate_rotation(node.rotations, time);
  Affine transform;
  transform.linear() = rotation.toRotationMatrix() * evaluate_or(node.scales, time, node.scale).asDiagonal();
  transform.translation() = evaluate_or(node.translations, time, node.translation);
  return transform;
}

bool has_curve(const AnimatedNode& node) {
  return !node.translations.empty() || !node.rotations.empty() || !node.scales.empty();
}

/// The nodes whose transforms place the part.
std::span<const int> placing_nodes(const SkinnedMeshDesc& desc, const SkinnedPart& part) {
  return part.skin < 0 ? std::span(&part.node, 1) : std::span(desc.skins[part.skin].joints);
}

/// Nodes that place parts, and their ancestors: parents first.
std::vector<int> sort_nodes(const SkinnedMeshDesc& desc) {
  std::vector<int> order;
  std::vector<bool> is_in(desc.nodes.size(), false);
  const auto add = [&](int node) {
    const auto num_before = static_cast<std::ptrdiff_t>(order.size());
    for (; node >= 0 && !is_in[node]; node = desc.nodes[node].parent) {
      is_in[node] = true;
      order.push_back(node);
    }
    std::reverse(order.begin() + num_before, order.end());
  };
  for (const SkinnedPart& part : desc.parts) std::ranges::for_each(placing_nodes(desc, part), add);
  return order;
}

std::span<const Influence> influences_of(const SkinnedPart& part, std::size_t vertex) {
  const std::size_t first = part.first_influence[vertex];
  return {&part.influences[first], part.first_influence[vertex + 1] - first};
}

/// Makes the weights of every vertex sum to 1, and removes those that are 0.
void normalise_weights(SkinnedPart& part) {
  std::vector<Influence> influences;
  std::vector<std::size_t> first = {0};
  for (std::size_t v = 0; v + 1 < part.first_influence.size(); ++v) {
    const std::span<const Influence> own = influences_of(part, v);
    double sum = 0;
    for (const Influence& influence : own) sum += influence.weight;
    if (sum == 0) influences.push_back({own[0].joint, 1});
    for (const auto& [joint, weight] : own) {
      if (weight > 0) influences.push_back({joint, weight / sum});
    }
    first.push_back(influences.size());
  }
  part.influences = std::move(influences);
  part.first_influence = std::move(first);
}

void add_targets(const SkinnedPart& part, std::span<const double> weights, std::span<Vec3> vertices) {
  for (std::size_t t = 0; t < weights.size(); ++t) {
    if (weights[t] == 0) continue;
    for (const auto& [vertex, by] : part.targets[t]) vertices[vertex] += weights[t] * by;
  }
}

/// From the mesh at rest to the world, by joint.
std::vector<Affine> joint_transforms(const Skin& skin, const std::vector<Affine>& transforms) {
  std::vector<Affine> result(skin.joints.size());
  for (std::size_t j = 0; j < skin.joints.size(); ++j)
    result[j] = transforms[skin.joints[j]] * skin.inverse_bind[j];
  return result;
}

/// Moves the vertices of a part from rest to the world. `transforms`: from nodes to the world.
void place(const SkinnedMeshDesc& desc, const SkinnedPart& part, const std::vector<Affine>& transforms,
           std::span<Vec3> vertices) {
  if (part.skin < 0) {
    for (Vec3& x : vertices) x = transforms[part.node] * x;
    return;
  }
  const std::vector<Affine> joints = joint_transforms(desc.skins[part.skin], transforms);
  for (std::size_t v = 0; v < vertices.size(); ++v) {
    Vec3 sum = Vec3::Zero();
    for (const auto& [joint, weight] : influences_of(part, v)) sum += weight * (joints[joint] * vertices[v]);
    vertices[v] = sum;
  }
}

/// Determinant of the first vertex's transform.
double first_determinant(const SkinnedMeshDesc& desc, const SkinnedPart& part,
                         const std::vector<Affine>& transforms) {
  if (part.skin < 0) return transforms[part.node].linear().determinant();
  const std::vector<Affine> joints = joint_transforms(desc.skins[part.skin], transforms);
  Mat3 sum = Mat3::Zero();
  for (const auto& [joint, weight] : influences_of(part, 0)) sum += weight * joints[joint].linear();
  return sum.determinant();
}

}  // namespace

SkinnedMesh::SkinnedMesh(SkinnedMeshDesc desc)
    : desc_(std::move(desc)),
      moving_(sort_nodes(desc_)),
      transforms_(desc_.nodes.size(), Affine::Identity()) {
  transforms_ = compute_transforms(start());
  std::vector<bool> is_moving(desc_.nodes.size(), false);
  for (const int n : moving_) {
    const AnimatedNode& node = desc_.nodes[n];
    is_moving[n] = has_curve(node) || (node.parent >= 0 && is_moving[node.parent]);
  }
  std::erase_if(moving_, [&](int n) { return !is_moving[n]; });

  for (SkinnedPart& part : desc_.parts) {
    PartState& state = parts_.emplace_back();
    state.first = rest_.size();
    rest_.insert(rest_.end(), part.rest.begin(), part.rest.end());
    part.rest = {};
    const std::span<Vec3> vertices(rest_.begin() + static_cast<std::ptrdiff_t>(state.first), rest_.end());
    if (part.skin >= 0) normalise_weights(part);
    state.is_mirrored = first_determinant(desc_, part, transforms_) < 0;
    if (!desc_.nodes[part.node].weights.empty()) continue;
    add_targets(part, part.weights, vertices);
    part.targets = {};
    state.is_still =
        std::ranges::none_of(placing_nodes(desc_, part), [&](int n) { return bool(is_moving[n]); });
    if (state.is_still) place(desc_, part, transforms_, vertices);
  }
}

void SkinnedMesh::evaluate(double time, std::vector<Vec3>& positions) const {
  positions = rest_;
  const std::vector<Affine> transforms = compute_transforms(time);
  for (std::size_t p = 0; p < parts_.size(); ++p) {
    if (parts_[p].is_still) continue;
    const SkinnedPart& part = desc_.parts[p];
    const std::size_t end = p + 1 < parts_.size() ? parts_[p + 1].first : positions.size();
    const std::span<Vec3> vertices(positions.data() + parts_[p].first, end - parts_[p].first);
    const AnimationCurve& curve = desc_.nodes[part.node].weights;
    if (!curve.empty()) {
      std::vector<double> weights(part.targets.size());
      engine::evaluate(curve, time, weights);
      add_targets(part, weights, vertices);
    }
    place(desc_, part, transforms, vertices);
  }
}

std::vector<Affine> SkinnedMesh::compute_transforms(double time) const {
  std::vector<Affine> transforms = transforms_;
  for (const int n : moving_) {
    const AnimatedNode& node = desc_.nodes[n];
    transforms[n] = local_transform(node, time);
    if (node.parent >= 0) transforms[n] = transforms[node.parent] * transforms[n];
  }
  return transforms;
}

}  // namespace weft::engine
