#pragma once
/// Is a point inside a closed mesh?

#include <span>
#include <vector>

#include "weft/mesh/triangle_mesh.h"

namespace weft::engine::verify {

/// Answers for many points: looks along +x from each and adds up the triangles ahead, +1 for a front left
/// behind, −1 for one met. The sum is the number of times the surface winds round the point. All decisions
/// are signs of orient2d and orient3d, and a ray through an edge or a corner is given to one of the triangles
/// there by one rule for all, so that there are no unlucky rays.
class InsideOfMesh {
 public:
  /// The spans must outlive this.
  InsideOfMesh(std::span<const Vec3> positions, std::span<const Triangle> triangles);

  /// True if the surface winds round p; points on the surface itself may count either way.
  bool contains(const Vec3& p) const;

 private:
  int cell(double coordinate, int axis) const;
  int turns_round(const Triangle& triangle, const Vec3& p) const;

  std::span<const Vec3> positions_;
  std::span<const Triangle> triangles_;
  Eigen::AlignedBox3d bounds_;
  // Triangles by the cells of a grid in y and z that they may cover.
  int num_cells_ = 1;               // along y, and along z
  std::vector<int> first_in_cell_;  // (num_cells² + 1) into in_cell_
  std::vector<int> in_cell_;        // triangles
};

}  // namespace weft::engine::verify
