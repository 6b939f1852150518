#pragma once
/// Triangle meshes as surfaces of solids: whether they close, which way they face, what is inside.

#include <span>
#include <vector>

#include "weft/mesh/triangle_mesh.h"

namespace weft::engine {

/// How the triangles meet at their edges; every edge of a good solid joins two that run along it in opposite
/// directions.
struct SurfaceEdges {
  int border = 0;        // edges of one triangle
  int non_manifold = 0;  // of more than two
  int twisted = 0;       // of two that run along it in the same direction: one of them faces the wrong way
  int unbalanced = 0;    // more triangles run along it in one direction than in the other: all but the good
                         // ones, and those at which several good solids meet
};

SurfaceEdges count_surface_edges(const TriangleMesh& mesh);

/// True if every edge is balanced: the surface divides space into inside and outside, and all of it faces
/// outwards, or all of it inwards.
inline bool is_closed(const SurfaceEdges& edges) { return edges.unbalanced == 0; }

/// The volume inside a closed mesh that faces outwards, negative if it faces inwards [m³]:
///
///     V = Σ a·(b × c)/6   over the triangles a b c; a hollow's volume is taken off, overlap counts twice
///
/// Of an open mesh the number depends on where it lies and means nothing.
double compute_signed_volume(const TriangleMesh& mesh);

/// Of a closed mesh's shells, its parts that no vertex joins.
struct Shells {
  int count = 0;
  int turned = 0;  // that faced inwards
};

/// Turns the shells that face inwards right side out, but for hollows: those that are inside other shells
/// altogether.
Shells turn_shells_outwards(TriangleMesh& mesh);

/// How often a closed mesh winds around each point (num_points): 1 inside where it faces outwards, -1 where
/// it faces inwards, 0 outside and in hollows, 2 where two parts overlap. Found by the triangles above the
/// point; an edge that two of them share is counted for exactly one. Points on the surface may go either way.
std::vector<int> compute_winding_numbers(const TriangleMesh& mesh, const std::vector<Vec3>& points);

/// The same of one point; `triangles` are those of the mesh, `positions` may hold more than its vertices.
int compute_winding_number(std::span<const Triangle> triangles, const std::vector<Vec3>& positions,
                           const Vec3& point);

}  // namespace weft::engine
