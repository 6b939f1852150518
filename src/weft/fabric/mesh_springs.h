#pragma once
/// The stiffness of a mesh's edges, as springs, that makes it stretch and shear most like a fabric.
///
/// An edge of length l whose direction has the components c along warp and s along weft, under a homogeneous
/// strain e = (ε11, ε22, 2 ε12), stores ½ k l² (aᵀe)² with a = (c², s², c s). Around a vertex, of area A:
///
///     C = 1/A Σ_edges share k l² a aᵀ         share: of the edge's energy that lies in the vertex's
///     triangles
///
/// The k >= 0 are those with the least squares of S (C − C_fabric) S over all vertices, S scaling the
/// fabric's own c11, c22 and g to 1. Springs cannot help C12 = G, as on a grid, and three edges per vertex
/// cannot be right about five numbers in every place: what they come to on average is reported.

#include <string>
#include <vector>

#include "weft/fabric/elements.h"

namespace weft::engine {

struct MeshSprings {
  std::vector<double> stiffness;      // of each edge of build_edges() [N/m]
  Mat3 mean = Mat3::Zero();           // C over the mesh, by area [N/m]
  std::vector<std::string> warnings;  // what of the fabric the springs change, by name
};

/// `name` is how the fabric is called in warnings.
MeshSprings make_mesh_springs(const TriangleMesh& mesh, const WarpField& warp, const Fabric& fabric,
                              const std::string& name);

}  // namespace weft::engine
