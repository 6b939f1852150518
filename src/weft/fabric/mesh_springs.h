#pragma once
/// Spring stiffnesses of a mesh's edges that best approximate a fabric's stretching and shearing.
///
/// An edge of length l whose direction has the components c along warp and s along weft, under a homogeneous
/// strain e = (ε11, ε22, 2 ε12), stores ½ k l² (aᵀe)² with a = (c², s², c s). Around a vertex, of area A:
///
///     C = 1/A Σ_edges share k l² a aᵀ         share: of the edge's energy in the vertex's triangles
///
/// The k >= 0 minimise the squares of S (C − C_fabric) S over all vertices, S scaling the fabric's own c11,
/// c22 and g to 1. Springs always give C12 = G, as on a grid. Three edges per vertex cannot fit five numbers
/// everywhere: the mean result is reported.

#include <string>
#include <vector>

#include "weft/fabric/elements.h"

namespace weft::engine {

struct MeshSprings {
  std::vector<double> stiffness;      // of each edge of build_edges() [N/m]
  Mat3 mean = Mat3::Zero();           // C over the mesh, by area [N/m]
  std::vector<std::string> warnings;  // properties of the fabric that the springs change
};

/// Warnings call the fabric `name`.
MeshSprings make_mesh_springs(const RestMesh& mesh, const WarpField& warp, const Fabric& fabric,
                              const std::string& name);

}  // namespace weft::engine
