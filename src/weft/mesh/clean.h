#pragma once
/// Mesh cleaning: from an input mesh to a valid cloth mesh.

#include <string>
#include <vector>

#include "weft/mesh/derived_mesh.h"

namespace weft::engine {

struct CleanOptions {
  /// Vertices closer than this are merged [m]; 0 merges exact duplicates, negative none.
  double weld_distance = -1;
  /// Borders of pieces within this distance are sewn, at vertices or between them (see sew.h) [m]; 0 sews
  /// nothing.
  double sew_distance = 0;
  /// Edges of cloth shorter than this, among long ones, also count as slivers (see slivers.h) [m].
  double short_edge = 0;
  bool is_cloth = true;  // removes slivers, and warns of unsewn seams and of edges without bending springs
};

struct CleanMesh : DerivedMesh {
  std::vector<std::string> warnings;  // one sentence per kind of flaw, with counts and the first location
  std::vector<std::string> notes;     // requested changes, as sentences
};

/// Sews seams if requested; drops degenerate triangles, repeated triangles, and vertices without triangles;
/// removes slivers (see slivers.h). Coincident vertices and non-manifold edges are kept; `warnings` reports
/// everything. Throws InputError for coordinates that are not finite, indices out of range, and no remaining
/// triangles. Deterministic: welded vertices become the one with the lowest index; sewn ones meet halfway.
CleanMesh clean_mesh(const TriangleMesh& source, const CleanOptions& options = {});

}  // namespace weft::engine
