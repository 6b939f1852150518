#include "weft/mesh/derived_mesh.h"

#include <utility>

namespace weft::engine {

DerivedMesh compose(const DerivedMesh& first, DerivedMesh second) {
  for (std::size_t t = 0; t < second.source_triangle.size(); ++t) {
    const int parent = second.source_triangle[t];
    const CornerWeights& outer = first.corner_weights[parent];
    for (Vec3& w : second.corner_weights[t]) w = w.x() * outer[0] + w.y() * outer[1] + w.z() * outer[2];
    second.source_triangle[t] = first.source_triangle[parent];
  }
  std::vector<int> vertices = first.vertex_of_source;
  for (int& v : vertices) v = v < 0 ? v : second.vertex_of_source[v];
  second.vertex_of_source = std::move(vertices);
  return second;
}

}  // namespace weft::engine
