#pragma once
/// A mesh derived from another one, with the origin of its parts.

#include <vector>

#include "weft/mesh/triangle_mesh.h"

namespace weft::engine {

struct DerivedMesh {
  TriangleMesh mesh;
  std::vector<int> vertex_of_source;          // (source vertices) index in `mesh`, -1: none
  std::vector<int> source_triangle;           // (triangles of `mesh`) source triangle of each
  std::vector<CornerWeights> corner_weights;  // (triangles of `mesh`) positions of its corners in that one
};

/// Composition: `second`, derived from first.mesh, as derived from the first's source.
DerivedMesh compose(const DerivedMesh& first, DerivedMesh second);

}  // namespace weft::engine
