#pragma once
/// Intersections of surfaces: cloth with itself, with other cloth, with meshes.
///
/// Two surfaces cross if no small movement of their vertices could separate them; otherwise they only touch.
/// The test is exact, by the signs of orient3d, in three cases:
///
///     1. The interiors of two non-coplanar triangles have a point in common.
///
///     2. An edge is exactly in the plane of a triangle of the other surface and runs through its interior,
///        and triangles at the edge are strictly on both sides.
///                                                        \  |  /
///     3. Two edges overlap exactly over a                 \|/         viewed along the two edges:
///        length, and the triangles at one separate     ----- -----     one surface is ----, the other |
///        those at the other.                                |
///
/// So a vertex, an edge or a whole side of cloth that is exactly on another surface touches and does not
/// cross, and neither does cloth folded flat: coplanar triangles never count, nor do degenerate triangles. A
/// surface that reaches the other side through a patch where both coincide exactly is not detected.
///
/// The rule needs no exception for neighbours: non-coplanar triangles that share an edge have no interior
/// points in common; those that share one vertex cross if the line from it runs through both.

#include <array>
#include <compare>
#include <span>
#include <vector>

#include "weft/mesh/triangle_mesh.h"

namespace weft::engine::verify {

using Corners = std::array<Vec3, 3>;

/// Case 1.
bool insides_cross(const Corners& a, const Corners& b);

/// A surface in one frame. Coordinates are finite, in the range of orient3d.
struct SurfaceView {
  std::span<const Vec3> positions;      // [m]
  std::span<const Triangle> triangles;  // indices into positions
  bool is_cloth = true;                 // other surfaces may cross themselves and each other
};

struct TriangleId {
  int surface = 0, triangle = 0;

  auto operator<=>(const TriangleId&) const = default;
};

/// Two crossing triangles; `a` belongs to a cloth, and a < b if both do.
struct Crossing {
  TriangleId a, b;

  auto operator<=>(const Crossing&) const = default;
};

/// All intersections in order: every pair of triangles of case 1, and for each place of cases 2 and 3 the
/// first pair that meets there. A long cut counts once for every two triangles along it.
///
/// Sweep and prune finds pairs with overlapping boxes, along the axis of greatest extent, in strips along the
/// second: for cloth about n log n.
std::vector<Crossing> find_crossings(std::span<const SurfaceView> surfaces);

}  // namespace weft::engine::verify
