#pragma once
/// A mesh made of another one, and where its parts come from.

#include <vector>

#include "weft/mesh/triangle_mesh.h"

namespace weft::engine {

struct DerivedMesh {
  TriangleMesh mesh;
  std::vector<int> vertex_of_source;  // (vertices of the source) index in `mesh`, -1 where it has none
  std::vector<int> source_triangle;   // (triangles of `mesh`) which of the source's each is a part of
  std::vector<CornerWeights> corner_weights;  // (triangles of `mesh`) where in that one its corners lie
};

/// `second`, made of first.mesh, as made of the first's source.
DerivedMesh compose(const DerivedMesh& first, DerivedMesh second);

}  // namespace weft::engine
