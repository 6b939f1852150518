#pragma once
/// Sewing: joins garment pieces along borders whose vertices need not coincide.
///
///         A  /\  /\  /            A  /\  /\  /
///       ----o--o----o---        ----o--*-o--o---
///                          →       /\ |\ /\ |
///       ---o-----o------          /  \| \  \|
///        B  \   / \   /
///
/// Border vertices within the distance of another border are joined to it: to a vertex there, or to a point
/// that divides the edge and its triangle (*). Joined points meet halfway.
///
/// The angle between the pieces distinguishes a seam from two layers, such as a lining below its shell. Both
/// have nearby borders, but at a seam the pieces extend in different directions:
///
///       A <——o o——> B      A <——o              A <——o
///                                 \            B <——o
///          flat: 180°            B  120°       layers: 0°
///
/// Below 25°, as a mean along the seam, they are layers: two sewing distances inside, both are still within
/// one of each other. Panels that lie flat on each other, as for an uninflated pillow, are layers by that
/// measure, and are left open.
///
/// A border is sewn to the nearest other one; where three run along one line, the third stays open. It may be
/// another border of the same piece, or a distant part of the same border, as in a tube of one panel: ten
/// times farther along the border than across. Interior edges and vertices are unchanged.

#include "weft/mesh/derived_mesh.h"

namespace weft::engine {

struct SewnMesh : DerivedMesh {
  int num_seams = 0;
  int num_joined = 0;   // vertices of the input that were merged with others
  int num_divided = 0;  // edges of the input that were divided
};

/// Sews borders within `distance` > 0 [m]; no vertex moves farther. The mesh must be clean (see clean_mesh).
/// No edge of the result has more than two triangles if none of the input had. Triangles keep their corners'
/// order: inconsistent orientations of pieces remain. Deterministic.
SewnMesh sew_borders(const TriangleMesh& mesh, double distance);

/// Seams that sew_borders would sew.
struct OpenSeams {
  int num_seams = 0;
  double gap = 0;  // of the widest one [m]
};

/// Seams between borders, also of one piece, except those whose vertices already coincide.
OpenSeams find_open_seams(const TriangleMesh& mesh, double distance);

}  // namespace weft::engine
