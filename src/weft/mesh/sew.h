#pragma once
/// Garment pieces joined along borders that do not coincide vertex by vertex.
///
///         A  /\  /\  /            A  /\  /\  /
///       ----o--o----o---        ----o--*-o--o---
///                          →       /\ |\ /\ |
///       ---o-----o------          /  \| \  \|
///        B  \   / \   /
///
/// Border vertices within the distance of another border are joined to it: to a vertex there, or to a point
/// that divides the edge and the triangle at it (*). What is joined meets halfway.
///
/// A seam and not two layers, such as a lining below its shell: the angle between the pieces at the seam.
/// Both have their borders near each other all along, but on the two sides of a seam cloth goes different
/// ways:
///
///       A <——o o——> B      A <——o              A <——o
///                                 \            B <——o
///          flat: 180°            B  120°       layers: 0°
///
/// Below 25°, as a mean along the seam, they are layers: two sewing distances inside both they are still
/// within one of each other. Panels that lie flat on each other, as for a pillow that is not blown up yet,
/// are layers by that measure, and are left open.
///
/// A border is sewn to the nearest other one; where three run along one line, the third stays open. It may be
/// another border of the same piece or a far part of the same border, as in a tube of one panel: ten times
/// farther along the border than across. Edges inside the pieces and vertices there stay as they are.

#include "weft/mesh/derived_mesh.h"

namespace weft::engine {

struct SewnMesh : DerivedMesh {
  int num_seams = 0;
  int num_joined = 0;   // vertices of the input that have become one with others
  int num_divided = 0;  // edges of the input that were divided
};

/// Sews what lies within `distance` > 0 [m]; no vertex moves farther. The mesh must be clean (see
/// clean_mesh). No edge of the result has more than two triangles if none of the input had. Triangles keep
/// their corners' order: where pieces faced opposite ways, they still do. Deterministic.
SewnMesh sew_borders(const TriangleMesh& mesh, double distance);

/// What sew_borders would sew.
struct OpenSeams {
  int num_seams = 0;
  double gap = 0;  // the widest one's [m]
};

/// Seams between different pieces, not those whose vertices coincide already.
OpenSeams find_open_seams(const TriangleMesh& mesh, double distance);

}  // namespace weft::engine
