#include "weft/mesh/vertex_normals.h"

#include <cmath>

namespace weft::engine {
namespace {

Vec3 vertex(std::span<const float> positions, int v) {
  return Eigen::Map<const Eigen::Vector3f>(positions.data() + 3 * static_cast<size_t>(v)).cast<double>();
}

}  // namespace

std::vector<float> compute_vertex_normals(const std::vector<Triangle>& triangles,
                                          std::span<const float> positions) {
  const std::vector<Vec3> sums =
      sum_triangle_normals(triangles, positions.size() / 3, [&](int v) { return vertex(positions, v); });
  std::vector<float> normals;
  normals.reserve(positions.size());
  for (const Vec3& sum : sums) {
    const double length = sum.norm();
    const Vec3 normal = length > 1e-30 && std::isfinite(length) ? Vec3(sum / length) : Vec3::UnitY();
    for (const double n : normal) normals.push_back(static_cast<float>(n));
  }
  return normals;
}

}  // namespace weft::engine
