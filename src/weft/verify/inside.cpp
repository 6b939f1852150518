#include "weft/verify/inside.h"

#include <algorithm>
#include <cmath>

#include "weft/verify/predicates.h"

namespace weft::engine::verify {
namespace {

constexpr int kMaxCells = 256;  // per side of the grid

Eigen::Vector2d seen_along_x(const Vec3& p) { return {p.y(), p.z()}; }

}  // namespace

InsideOfMesh::InsideOfMesh(std::span<const Vec3> positions, std::span<const Triangle> triangles)
    : positions_(positions), triangles_(triangles) {
  for (const Triangle& triangle : triangles) {
    for (const int v : triangle) bounds_.extend(positions[v]);
  }
  num_cells_ = std::clamp(static_cast<int>(std::sqrt(static_cast<double>(triangles.size()))), 1, kMaxCells);
  first_in_cell_.assign(num_cells_ * num_cells_ + 1, 0);
  const auto for_each_cell = [&](std::size_t t, auto visit) {
    const auto& [a, b, c] = triangles_[t];
    const Vec3 low = positions_[a].cwiseMin(positions_[b]).cwiseMin(positions_[c]);
    const Vec3 high = positions_[a].cwiseMax(positions_[b]).cwiseMax(positions_[c]);
    for (int j = cell(low.y(), 1); j <= cell(high.y(), 1); ++j) {
      for (int k = cell(low.z(), 2); k <= cell(high.z(), 2); ++k) visit(j * num_cells_ + k);
    }
  };
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    for_each_cell(t, [&](int index) { ++first_in_cell_[index + 1]; });
  }
  for (std::size_t k = 1; k < first_in_cell_.size(); ++k) first_in_cell_[k] += first_in_cell_[k - 1];
  in_cell_.resize(first_in_cell_.back());
  std::vector<int> next = first_in_cell_;
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    for_each_cell(t, [&](int index) { in_cell_[next[index]++] = static_cast<int>(t); });
  }
}

int InsideOfMesh::cell(double coordinate, int axis) const {
  const double low = bounds_.min()[axis], size = bounds_.max()[axis] - low;
  if (!(size > 0)) return 0;
  return std::clamp(static_cast<int>((coordinate - low) / size * num_cells_), 0, num_cells_ - 1);
}

/// Winding of the triangle around p, viewed along x: +1, −1 or 0. Sides that go up in y to the left of p add
/// one, others subtract one; if p is on a side's line, it counts as right of it, for every triangle.
int InsideOfMesh::turns_round(const Triangle& triangle, const Vec3& p) const {
  int turns = 0;
  for (int k = 0; k < 3; ++k) {
    const Vec3 &a = positions_[triangle[k]], &b = positions_[triangle[(k + 1) % 3]];
    const bool from_below = a.y() <= p.y(), to_below = b.y() <= p.y();
    if (from_below == to_below) continue;
    const int side = orient2d(seen_along_x(a), seen_along_x(b), seen_along_x(p));
    if (from_below && side > 0) ++turns;
    if (to_below && side < 0) --turns;
  }
  return turns;
}

bool InsideOfMesh::contains(const Vec3& p) const {
  if (!bounds_.contains(p)) return false;
  int winding = 0;
  const int index = cell(p.y(), 1) * num_cells_ + cell(p.z(), 2);
  for (int k = first_in_cell_[index]; k < first_in_cell_[index + 1]; ++k) {
    const Triangle& triangle = triangles_[in_cell_[k]];
    const int turns = turns_round(triangle, p);
    if (turns == 0) continue;
    const auto& [a, b, c] = triangle;
    const int side = orient3d(positions_[a], positions_[b], positions_[c], p);
    if (side * turns > 0) winding += turns;  // the triangle is ahead of p
  }
  return winding != 0;
}

}  // namespace weft::engine::verify
