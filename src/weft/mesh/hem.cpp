#include "weft/mesh/hem.h"

#include <algorithm>

#include "weft/core/angle.h"

namespace weft::engine {
namespace {

using Point = Eigen::Vector3f;

Point at(std::span<const float> values, int vertex) {
  return Eigen::Map<const Point>(&values[3 * static_cast<std::size_t>(vertex)]);
}

}  // namespace

Hem::Hem(const std::vector<Triangle>& triangles, int num_vertices) {
  TriangleMesh mesh;
  mesh.positions.resize(num_vertices);
  mesh.triangles = triangles;
  std::vector<std::vector<int>> along(num_vertices);
  std::vector<std::array<int, 2>> border;
  for (const Edge& edge : build_edges(mesh)) {
    if (edge.num_triangles != 1) continue;
    along[edge.a].push_back(edge.b);
    along[edge.b].push_back(edge.a);
    border.push_back({edge.a, edge.b});
  }
  // A ring where exactly two border edges meet; where more meet, the tubes end.
  std::vector<int> ring(num_vertices, -1);
  for (int v = 0; v < num_vertices; ++v) {
    if (along[v].size() != 2) continue;
    ring[v] = static_cast<int>(centers_.size());
    centers_.push_back(v);
    neighbours_.push_back({along[v][0], along[v][1]});
  }
  for (const auto& [a, b] : border) {
    if (ring[a] < 0 || ring[b] < 0) continue;
    // The rings may run in opposite senses along the border: then vertex k faces vertex -k.
    const bool is_opposite = (neighbours_[ring[a]][1] == b) == (neighbours_[ring[b]][1] == a);
    for (int k = 0; k < kSides; ++k) {
      const auto other = [&](int j) {
        return ring[b] * kSides + (is_opposite ? (kSides - j) % kSides : j % kSides);
      };
      const int here = ring[a] * kSides + k, next = ring[a] * kSides + (k + 1) % kSides;
      triangles_.push_back({here, next, other(k)});
      triangles_.push_back({next, other(k + 1), other(k)});
    }
  }
}

std::vector<float> Hem::place(std::span<const float> positions, std::span<const float> normals,
                              double radius) const {
  std::vector<float> placed;
  placed.reserve(centers_.size() * kSides * 3);
  for (std::size_t r = 0; r < centers_.size(); ++r) {
    const Point center = at(positions, centers_[r]);
    Point normal = at(normals, centers_[r]);
    const Point along = at(positions, neighbours_[r][1]) - at(positions, neighbours_[r][0]);
    Point across = along.cross(normal);
    across /= std::max(across.norm(), 1e-12f);
    for (int k = 0; k < kSides; ++k) {
      const auto [sine, cosine] = sin_cos_deg(360.0 * k / kSides);
      const Point p = center + static_cast<float>(radius) *
                                   (static_cast<float>(cosine) * normal + static_cast<float>(sine) * across);
      placed.insert(placed.end(), p.begin(), p.end());
    }
  }
  return placed;
}

}  // namespace weft::engine
