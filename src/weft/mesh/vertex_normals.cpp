#include "weft/mesh/vertex_normals.h"

#include <cmath>

#include "weft/mesh/soup.h"

namespace weft::engine {
namespace {

Vec3 vertex(std::span<const float> positions, int v) {
  return Eigen::Map<const Eigen::Vector3f>(positions.data() + 3 * static_cast<size_t>(v)).cast<double>();
}

}  // namespace

std::vector<float> compute_vertex_normals(const std::vector<Triangle>& triangles,
                                          std::span<const float> positions) {
  const auto add_up = [&](const std::vector<Triangle>& of) {
    return sum_triangle_normals(of, positions.size() / 3, [&](int v) { return vertex(positions, v); });
  };
  std::vector<Vec3> sums;
  if (is_soup(triangles)) {
    const std::vector<Triangle> joined = join_soup(triangles, positions);
    const std::vector<Vec3> at_places = add_up(joined);
    for (const Triangle& t : joined) {
      for (const int v : t) sums.push_back(at_places[v]);
    }
    sums.resize(positions.size() / 3, Vec3::Zero());
  } else {
    sums = add_up(triangles);
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
