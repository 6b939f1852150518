#pragma once
/// Triangles that are nearly flat, out of a mesh: needles by collapsing their short edge, caps by dividing
/// what lies behind their long one (M. Botsch, L. Kobbelt, A Robust Procedure to Eliminate Degenerate Faces
/// from Polygon Meshes, VMV 2001).
///
///     needle: its short edge a–b becomes one vertex
///     cap: is dropped, and the triangle behind its long edge a–b divided at its corner c
///
///          a-----c-----b              a-----c-----b
///           '.       .'      →         '.   |   .'
///             '.   .'                    '. | .'
///                 d                          d
///
/// A triangle's stiffness grows as its base over its height: one of a micrometre, as modellers and sewing
/// leave them, is ten thousand times stiffer than its neighbours, in stretching and in bending. An edge that
/// is shorter than what contact moves its ends by is stretched by contact, and no shorter step helps.

#include "weft/mesh/derived_mesh.h"

namespace weft::engine {

/// What counts as a sliver.
struct SliverLimits {
  double flatness = 0.02;  // height over longest edge, 0 < flatness <= 0.1 [1]
  double short_edge = 0;   // edges shorter than this, and than 15 % of the longest around, make slivers [m]
};

struct MeshWithoutSlivers : DerivedMesh {
  int num_collapsed = 0;  // edges
  int num_divided = 0;    // long edges; at a border a cap is dropped alone
};

/// Removes slivers. Vertices stay where they are; of a collapsed edge the one with the lower index stays, or
/// the one on a border. A triangle at a tip of the border is dropped. A sliver is kept where the mesh would become non-manifold or fold over. What a
/// triangle is a part of is continued in its plane over its edge: weights may be a little outside 0 … 1. The
/// mesh must be clean (see clean_mesh). Deterministic.
MeshWithoutSlivers remove_slivers(const TriangleMesh& mesh, const SliverLimits& limits = {});

}  // namespace weft::engine
