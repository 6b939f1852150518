#pragma once
/// From a mesh as people have it to one that cloth can be made of.

#include <string>
#include <vector>

#include "weft/mesh/derived_mesh.h"

namespace weft::engine {

struct CleanOptions {
  /// Vertices closer than this are sewn into one [m]; 0 sews exact duplicates, negative sews nothing.
  double weld_distance = -1;
  /// Borders of pieces within this distance are sewn, vertex on vertex or not (see sew.h) [m]; 0 sews
  /// nothing.
  double sew_distance = 0;
  /// Edges of cloth that are shorter than this are slivers too, among long ones (see slivers.h) [m].
  double short_edge = 0;
  bool is_cloth = true;  // whether to remove slivers, and to warn of unsewn seams and of edges without
                         // bending springs
};

struct CleanMesh : DerivedMesh {
  std::vector<std::string> warnings;  // one sentence per kind of flaw, with counts and the first place
  std::vector<std::string> notes;     // what was done as asked, in sentences
};

/// Sews seams if asked, and drops what cannot be cloth: triangles without area, repeated triangles, vertices
/// without triangles; and removes slivers (see slivers.h). Coincident vertices and non-manifold edges are
/// kept; everything is told in `warnings`. Throws InputError where nothing sensible is left: coordinates that
/// are not finite, indices out of range, no triangles. Deterministic: welded vertices become the one with the
/// lowest index; sewn ones meet halfway.
CleanMesh clean_mesh(const TriangleMesh& source, const CleanOptions& options = {});

}  // namespace weft::engine
