#pragma once
/// Rounded hems along the borders of cloth, for drawing: cloth of one layer has no thickness otherwise.

#include <span>
#include <vector>

#include "weft/mesh/triangle_mesh.h"

namespace weft::engine {

/// Tubes around the border edges of a mesh. Each border vertex gets a ring of kHemSides vertices.
class Hem {
 public:
  static constexpr int kSides = 6;

  explicit Hem(const std::vector<Triangle>& triangles, int num_vertices);

  /// The mesh's vertex in each ring (num_rings).
  const std::vector<int>& centers() const { return centers_; }

  /// Of the tubes; vertex k of ring r is r kSides + k.
  const std::vector<Triangle>& triangles() const { return triangles_; }

  /// Positions of the rings' vertices (num_rings x kSides x 3), from the mesh's positions and unit normals
  /// (num_vertices x 3) [m].
  std::vector<float> place(std::span<const float> positions, std::span<const float> normals,
                           double radius) const;

 private:
  std::vector<int> centers_;
  std::vector<std::array<int, 2>> neighbours_;  // (num_rings) previous and next vertex of the mesh
  std::vector<Triangle> triangles_;
};

}  // namespace weft::engine
