#include "weft/animation/skinned_mesh.h"

#include <algorithm>
#include <cmath>
#include <functional>
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

bool is_finite(const Affine& transform) { return transform.matrix().allFinite(); }

bool are_finite(std::span<const double> values) {
  return std::ranges::all_of(values, [](double value) { return std::isfinite(value); });
}

bool is_valid(const AnimationCurve& curve, std::size_t width) {
  if (curve.interpolation > Interpolation::cubic_spline) return false;
  const std::size_t values_per_key = curve.interpolation == Interpolation::cubic_spline ? 3 * width : width;
  if (curve.values.size() != curve.times.size() * values_per_key) return false;
  return are_finite(curve.times) && are_finite(curve.values) &&
         std::ranges::adjacent_find(curve.times, std::greater_equal<>()) == curve.times.end();
}

bool is_valid(const AnimatedNode& node) {
  return (!node.matrix || is_finite(*node.matrix)) && node.translation.allFinite() &&
         node.rotation.coeffs().allFinite() && node.scale.allFinite() && is_valid(node.translations, 3) &&
         is_valid(node.rotations, 4) && is_valid(node.scales, 3);
}

bool has_cycle(const std::vector<AnimatedNode>& nodes) {
  for (std::size_t n = 0; n < nodes.size(); ++n) {
    std::size_t num_above = 0;
    for (int above = nodes[n].parent; above >= 0; above = nodes[above].parent) {
      if (++num_above == nodes.size()) return true;
    }
  }
  return false;
}

bool is_below(int index, std::size_t count) { return index >= 0 && static_cast<std::size_t>(index) < count; }

bool has_valid_influences(const SkinnedPart& part, std::size_t num_joints) {
  const std::vector<std::size_t>& first = part.first_influence;
  if (first.size() != part.rest.size() + 1 || first.front() != 0 || first.back() != part.influences.size())
    return false;
  return std::ranges::adjacent_find(first, std::greater_equal<>()) == first.end() &&
         std::ranges::all_of(part.influences, [&](const Influence& influence) {
           return is_below(influence.joint, num_joints) && std::isfinite(influence.weight) &&
                  influence.weight >= 0;
         });
}

bool is_valid(const SkinnedPart& part, const SkinnedMeshDesc& desc) {
  if (part.rest.empty() || !is_below(part.node, desc.nodes.size())) return false;
  if (part.skin >= 0 && (!is_below(part.skin, desc.skins.size()) ||
                         !has_valid_influences(part, desc.skins[part.skin].joints.size())))
    return false;
  const AnimationCurve& curve = desc.nodes[part.node].weights;
  if (part.weights.size() != part.targets.size() || !is_valid(curve, part.targets.size())) return false;
  for (const std::vector<Displacement>& target : part.targets) {
    for (const auto& [vertex, by] : target) {
      if (!is_below(vertex, part.rest.size()) || !by.allFinite()) return false;
    }
  }
  return are_finite(part.weights) &&
         std::ranges::all_of(part.rest, [](const Vec3& p) { return p.allFinite(); });
}

}  // namespace

bool is_valid(const SkinnedMeshDesc& desc) {
  const std::size_t num_nodes = desc.nodes.size();
  for (const AnimatedNode& node : desc.nodes) {
    if ((node.parent >= 0 && !is_below(node.parent, num_nodes)) || !is_valid(node)) return false;
  }
  if (has_cycle(desc.nodes)) return false;
  for (const Skin& skin : desc.skins) {
    if (skin.joints.size() != skin.inverse_bind.size() ||
        !std::ranges::all_of(skin.joints, [&](int joint) { return is_below(joint, num_nodes); }) ||
        !std::ranges::all_of(skin.inverse_bind, is_finite))
      return false;
  }
  return std::isfinite(desc.start) && std::isfinite(desc.end) && !desc.parts.empty() &&
         std::ranges::all_of(desc.parts, [&](const SkinnedPart& part) { return is_valid(part, desc); });
}

/// Moves the vertices of a part from rest to the world. `transforms`: from nodes to the world.
void SkinnedMesh::place(std::size_t p, const std::vector<Affine>& transforms,
                        std::span<Vec3> vertices) const {
  const SkinnedPart& part = desc_.parts[p];
  if (part.skin < 0) {
    for (Vec3& x : vertices) x = transforms[part.node] * x;
    return;
  }
  const std::vector<Affine> joints = joint_transforms(desc_.skins[part.skin], transforms);
  for (std::size_t v = 0; v < vertices.size(); ++v) {
    Vec3 sum = Vec3::Zero();
    for (const auto& [joint, weight] : influences_of(p, v)) sum += weight * (joints[joint] * vertices[v]);
    vertices[v] = sum;
  }
}

/// Determinant of the first vertex's transform.
double SkinnedMesh::first_determinant(std::size_t p, const std::vector<Affine>& transforms) const {
  const SkinnedPart& part = desc_.parts[p];
  if (part.skin < 0) return transforms[part.node].linear().determinant();
  const std::vector<Affine> joints = joint_transforms(desc_.skins[part.skin], transforms);
  Mat3 sum = Mat3::Zero();
  for (const auto& [joint, weight] : influences_of(p, 0)) sum += weight * joints[joint].linear();
  return sum.determinant();
}

std::span<const Influence> SkinnedMesh::influences_of(std::size_t part, std::size_t vertex) const {
  const std::vector<std::size_t>& first = parts_[part].first_influence;
  return {&parts_[part].influences[first[vertex]], first[vertex + 1] - first[vertex]};
}

/// Makes the weights of every vertex sum to 1, and leaves out those that are 0.
void SkinnedMesh::normalise_weights(const SkinnedPart& part, PartState& state) {
  state.first_influence = {0};
  for (std::size_t v = 0; v + 1 < part.first_influence.size(); ++v) {
    const std::size_t first = part.first_influence[v];
    const std::span<const Influence> given(&part.influences[first], part.first_influence[v + 1] - first);
    double sum = 0;
    for (const Influence& influence : given) sum += influence.weight;
    if (sum == 0) state.influences.push_back({given[0].joint, 1});
    for (const auto& [joint, weight] : given) {
      if (weight > 0) state.influences.push_back({joint, weight / sum});
    }
    state.first_influence.push_back(state.influences.size());
  }
}

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

  for (std::size_t p = 0; p < desc_.parts.size(); ++p) {
    const SkinnedPart& part = desc_.parts[p];
    PartState& state = parts_.emplace_back();
    state.first = rest_.size();
    rest_.insert(rest_.end(), part.rest.begin(), part.rest.end());
    const std::span<Vec3> vertices(rest_.begin() + static_cast<std::ptrdiff_t>(state.first), rest_.end());
    if (part.skin >= 0) normalise_weights(part, state);
    state.is_mirrored = first_determinant(p, transforms_) < 0;
    if (!desc_.nodes[part.node].weights.empty()) continue;
    add_targets(part, part.weights, vertices);
    state.is_still =
        std::ranges::none_of(placing_nodes(desc_, part), [&](int n) { return bool(is_moving[n]); });
    if (state.is_still) place(p, transforms_, vertices);
  }
}

bool SkinnedMesh::is_still() const {
  return std::ranges::all_of(parts_, [](const PartState& part) { return part.is_still; });
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
    place(p, transforms, vertices);
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
