#pragma once
/// Removal of nearly flat triangles: needles by edge collapse of their short edge, caps by division of the
/// triangles behind their long one (M. Botsch, L. Kobbelt, A Robust Procedure to Eliminate Degenerate Faces
/// from Polygon Meshes, VMV 2001).
///
///     needle: its short edge a–b becomes one vertex
///     cap: dropped, and the triangle behind its long edge a–b divided at its corner c
///
///          a-----c-----b              a-----c-----b
///           '.       .'      →         '.   |   .'
///             '.   .'                    '. | .'
///                 d                          d
///
/// A triangle's stiffness grows with its base over its height: a height of a micrometre, as modellers and
/// sewing produce, is ten thousand times stiffer than its neighbours, in stretching and in bending. Contact
/// stretches an edge that is shorter than its corrections; shorter steps do not help.

#include "weft/mesh/derived_mesh.h"

namespace weft::engine {

/// Definition of a sliver.
struct SliverLimits {
  double flatness = 0.02;  // height over longest edge, 0 < flatness <= 0.1 [1]
  double short_edge = 0;   // edges below this, and 15 % of the longest around, make slivers [m]
};

struct MeshWithoutSlivers : DerivedMesh {
  int num_collapsed = 0;  // edges
  int num_divided = 0;    // long edges; at a border a cap is only dropped
};

/// Removes slivers. Vertices keep their positions; of a collapsed edge the one with the lower index stays, or
/// the one on a border. A triangle at a tip of the border is dropped. A sliver is kept if its removal would
/// make the mesh non-manifold or fold it over. A part's source triangle is extended in its plane beyond its
/// edge: weights may be slightly outside 0 … 1. The mesh must be clean (see clean_mesh). Deterministic.
MeshWithoutSlivers remove_slivers(const TriangleMesh& mesh, const SliverLimits& limits = {});

}  // namespace weft::engine
