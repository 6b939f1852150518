#pragma once
/// Point-in-mesh test for closed meshes.

#include <span>
#include <vector>

#include "weft/mesh/triangle_mesh.h"

namespace weft::engine::verify {

/// Tests many points: a ray along +x from each sums the triangles ahead, +1 for leaving through a front, −1
/// for entering through one. The sum is the winding number of the surface around the point. All decisions are
/// signs of orient2d and orient3d, and a single rule assigns a ray through an edge or a corner to one of the
/// triangles there: there are no degenerate rays.
class InsideOfMesh {
 public:
  /// The spans must outlive this.
  InsideOfMesh(std::span<const Vec3> positions, std::span<const Triangle> triangles);

  /// True if the winding number of p is not 0; results for points on the surface are arbitrary.
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
