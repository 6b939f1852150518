#include "weft/render/picture.h"

namespace weft {

std::vector<float> compute_normals(const DrawnMesh& mesh) {
  using Eigen::Vector3f;
  const auto place = [&](int v) { return Eigen::Map<const Vector3f>(mesh.positions.data() + 3 * v); };
  std::vector<float> normals(mesh.positions.size(), 0.0f);
  const auto normal = [&](int v) { return Eigen::Map<Vector3f>(normals.data() + 3 * v); };
  for (const auto& [a, b, c] : mesh.triangles) {
    const Vector3f area = (place(b) - place(a)).cross(place(c) - place(a));
    for (const int v : {a, b, c}) normal(v) += area;
  }
  for (int v = 0; v < static_cast<int>(mesh.positions.size() / 3); ++v) {
    const float length = normal(v).norm();
    normal(v) = length > 1e-20f ? Vector3f(normal(v) / length) : Vector3f(Vector3f::UnitY());
  }
  return normals;
}

}  // namespace weft
