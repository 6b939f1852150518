#pragma once
/// Triangle meshes as surfaces of solids: closedness, orientation, inside test.

#include <span>
#include <vector>

#include "weft/mesh/triangle_mesh.h"

namespace weft::engine {

/// Edge statistics of a surface; every edge of a valid solid joins two triangles that run along it in
/// opposite directions.
struct SurfaceEdges {
  int border = 0;        // edges of one triangle
  int non_manifold = 0;  // of more than two
  int twisted = 0;       // of two that run along it in the same direction: one faces the wrong way
  /// More triangles run along it in one direction than in the other: all but valid edges, and those at which
  /// several valid solids meet.
  int unbalanced = 0;
};

SurfaceEdges count_surface_edges(const TriangleMesh& mesh);

/// True if every edge is balanced: the surface divides space into inside and outside, and faces consistently
/// outwards or inwards.
inline bool is_closed(const SurfaceEdges& edges) { return edges.unbalanced == 0; }

/// Volume of a closed mesh that faces outwards, negative if it faces inwards [m³]:
///
///     V = Σ a·(b × c)/6   over the triangles a b c; hollows are subtracted, overlaps count twice
///
/// For an open mesh the number depends on its position and is meaningless. `at(v)` is a vertex's position.
template <class At>
double compute_signed_volume(std::span<const Triangle> triangles, const At& at) {
  if (triangles.empty()) return 0;
  const Vec3 near = at(triangles[0][0]);  // correct for any point; a near one keeps the terms small
  double sum = 0;
  for (const auto& [a, b, c] : triangles) sum += (at(a) - near).dot((at(b) - near).cross(at(c) - near));
  return sum / 6;
}
double compute_signed_volume(const TriangleMesh& mesh);

/// A part of a mesh that edges connect: those of two triangles, and balanced ones of more.
struct Shell {
  std::vector<int> triangles;  // ascending
  bool is_closed = true;       // every edge is balanced, by its triangles alone
};

/// In the order of their first triangles.
std::vector<Shell> find_shells(const TriangleMesh& mesh);

/// The same vertices with the triangles of closed shells only, which have an inside; and with all others.
TriangleMesh find_solid_part(const TriangleMesh& mesh);
TriangleMesh find_open_part(const TriangleMesh& mesh);

/// Flips triangles that face another way than most in their part, where edges of two triangles connect parts.
/// Returns their number. A part with one side only, such as a Möbius strip, stays.
int orient_triangles(TriangleMesh& mesh);

struct TurnedShells {
  int count = 0;   // of all shells
  int turned = 0;  // closed ones that faced inwards
};

/// Flips closed shells that face inwards, except hollows, which are inside other ones.
TurnedShells turn_shells_outwards(TriangleMesh& mesh);

/// Winding number of a closed mesh around each point (num_points): 1 inside where it faces outwards, -1 where
/// it faces inwards, 0 outside and in hollows, 2 where two parts overlap. Found from the triangles above the
/// point; a shared edge counts for exactly one triangle. Results for points on the surface are arbitrary.
std::vector<int> compute_winding_numbers(const TriangleMesh& mesh, const std::vector<Vec3>& points);

/// Winding number of one point; `triangles` are the mesh's, `positions` may contain more than its vertices.
int compute_winding_number(std::span<const Triangle> triangles, const std::vector<Vec3>& positions,
                           const Vec3& point);

}  // namespace weft::engine
