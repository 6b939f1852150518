#include "weft/mesh/vertex_normals.h"

#include <cmath>

namespace weft::engine {
namespace {

Eigen::Vector3f vertex(std::span<const float> positions, int v) {
  return Eigen::Map<const Eigen::Vector3f>(positions.data() + 3 * static_cast<size_t>(v));
}

}  // namespace

std::vector<float> compute_vertex_normals(const std::vector<Triangle>& triangles,
                                          std::span<const float> positions) {
  std::vector<Vec3> sums(positions.size() / 3, Vec3::Zero());
  for (const auto& [a, b, c] : triangles) {
    const Vec3 x = vertex(positions, a).cast<double>();
    const Vec3 area =
        (vertex(positions, b).cast<double>() - x).cross(vertex(positions, c).cast<double>() - x);
    for (const int v : {a, b, c}) sums[v] += area;
  }
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
