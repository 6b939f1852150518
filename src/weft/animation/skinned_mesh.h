#pragma once
/// Skinned meshes: vertices moved by an animated tree of nodes, joints and morph targets, as in glTF 2.0.

#include <optional>
#include <span>
#include <vector>

#include "weft/animation/animation_curve.h"
#include "weft/animation/vertex_source.h"
#include "weft/core/vec.h"

namespace weft::engine {

using Affine = Eigen::AffineCompact3d;

/// A node of the tree, placed in its parent by p ↦ translation + rotation (scale p), or by a matrix.
/// A curve that is not empty replaces the constant value.
struct AnimatedNode {
  int parent = -1;                    // -1: none
  std::optional<Affine> matrix = {};  // replaces the other values, and is not animated
  Vec3 translation = Vec3::Zero();    // [m]
  Eigen::Quaterniond rotation = Eigen::Quaterniond::Identity();   // unit
  Vec3 scale = Vec3::Ones();                                      // may be negative [1]
  AnimationCurve translations = {}, rotations = {}, scales = {};  // of width 3, 4 (x, y, z, w) and 3
  AnimationCurve weights = {};  // of the morph targets of the node's part, of width num_targets
};

/// Joints, and the matrices from the mesh to each joint's coordinates at rest.
struct Skin {
  std::vector<int> joints;           // nodes (num_joints)
  std::vector<Affine> inverse_bind;  // (num_joints)
};

struct Influence {
  int joint = 0;      // of the skin
  double weight = 0;  // >= 0 [1]
};

struct Displacement {
  int vertex = 0;
  Vec3 by = Vec3::Zero();  // [m]
};

/// A mesh at a node: vertices at rest, displaced by Σ weight · morph target, then placed by the node. A skin
/// replaces the node's transform by the weighted mean of its joints' (linear blend skinning).
struct SkinnedPart {
  int node = 0;
  int skin = -1;                                        // -1: none
  std::vector<Vec3> rest = {};                          // (num_vertices) [m]
  std::vector<std::vector<Displacement>> targets = {};  // (num_targets) of the vertices that move
  std::vector<double> weights = {};                     // (num_targets), unless the node's are animated [1]
  std::vector<Influence> influences = {};         // of a skin, by vertex. Weights are divided by their sum;
                                                  // if it is 0, the vertex follows its first joint.
  std::vector<std::size_t> first_influence = {};  // of a skin: (num_vertices + 1); at least one each
};

struct SkinnedMeshDesc {
  std::vector<AnimatedNode> nodes;
  std::vector<Skin> skins = {};
  std::vector<SkinnedPart> parts;
  double start = 0, end = 0;  // first and last key of the clip [s]
};

/// Whether sizes match, indices are in range, numbers are finite, times increase, and nodes have no cycles.
bool is_valid(const SkinnedMeshDesc& desc);

/// The vertices of all parts, one part after another.
class SkinnedMesh final : public VertexSource {
 public:
  /// The description must be valid.
  explicit SkinnedMesh(SkinnedMeshDesc desc);

  const SkinnedMeshDesc& desc() const { return desc_; }

  int num_vertices() const override { return static_cast<int>(rest_.size()); }
  bool is_still() const override;
  void evaluate(double time, std::vector<Vec3>& positions) const override;

  double start() const { return desc_.start; }  // first and last key of the clip [s]
  double end() const { return desc_.end; }

  /// Whether the part is a mirror image of its vertices at rest when the clip starts. The transform of its
  /// first vertex decides. Front sides of triangles are then clockwise.
  bool is_mirrored(int part) const { return parts_[part].is_mirrored; }

 private:
  struct PartState {
    std::size_t first = 0;              // vertex
    std::vector<Influence> influences;  // of a skin, as in SkinnedPart, with weights > 0 of sum 1
    std::vector<std::size_t> first_influence;
    bool is_still = false;  // `rest_` has its final positions
    bool is_mirrored = false;
  };

  std::vector<Affine> compute_transforms(double time) const;
  static void normalise_weights(const SkinnedPart& part, PartState& state);
  std::span<const Influence> influences_of(std::size_t part, std::size_t vertex) const;
  void place(std::size_t part, const std::vector<Affine>& transforms, std::span<Vec3> vertices) const;
  double first_determinant(std::size_t part, const std::vector<Affine>& transforms) const;

  SkinnedMeshDesc desc_;
  std::vector<int> moving_;         // nodes that move and place parts, parents first
  std::vector<Affine> transforms_;  // from nodes to the world; those of `moving_` when the clip starts
  std::vector<PartState> parts_;
  std::vector<Vec3> rest_;  // (num_vertices), with displacements by constant weights [m]
};

}  // namespace weft::engine
