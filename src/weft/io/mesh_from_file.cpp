#include "weft/io/mesh_from_file.h"

#include "weft/mesh/polygon.h"

namespace weft::engine {

void MeshFaces::add(std::span<const int> polygon, std::span<const Eigen::Vector2d> corner_uv) {
  corners.insert(corners.end(), polygon.begin(), polygon.end());
  uv.insert(uv.end(), corner_uv.begin(), corner_uv.end());
  ends.push_back(corners.size());
}

MeshFaces make_faces(const std::vector<Triangle>& triangles, const std::vector<CornerUv>& uv) {
  MeshFaces faces;
  for (std::size_t t = 0; t < triangles.size(); ++t)
    faces.add(triangles[t], uv.empty() ? std::span<const Eigen::Vector2d>() : std::span(uv[t]));
  return faces;
}

void append_polygon(std::span<const int> polygon, std::span<const Eigen::Vector2d> uv, MeshFromFile& result) {
  result.faces.add(polygon, uv);
  std::vector<Vec3> x;
  for (const int v : polygon) x.push_back(result.mesh.positions[v]);
  for (const auto [a, b, c] : triangulate(x)) {
    result.mesh.triangles.push_back({polygon[a], polygon[b], polygon[c]});
    if (!uv.empty()) result.uv.push_back({uv[a], uv[b], uv[c]});
  }
}

}  // namespace weft::engine
