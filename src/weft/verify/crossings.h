#pragma once
/// Where surfaces pass through each other: cloth through itself, through other cloth, through meshes.
///
/// Two surfaces cross where no small movement of their vertices could part them; where one could, they only
/// touch. That is decided exactly, by the signs of orient3d, in three ways:
///
///     1. The insides of two triangles that do not lie in one plane have a point in common.
///
///     2. An edge lies exactly in the plane of a triangle of the other surface and runs through its inside,
///     and
///        triangles at the edge lie strictly on both sides.
///                                                       \  |  /
///     3. Two edges lie exactly on each other over a        \|/         seen along the two edges:
///        length, and the triangles at one separate     ----- -----     one surface is ----, the other |
///        those at the other.                                |
///
/// So a vertex, an edge or a whole side of cloth that lies exactly on another surface touches and does not
/// cross, and neither does cloth folded flat: triangles that lie in one plane never count, nor do triangles
/// without area. Where a surface reaches the other side by way of a patch on which both lie exactly on each
/// other, that is not seen.
///
/// The rule needs no exception for neighbours: triangles that share an edge cannot have inner points in
/// common without lying in one plane; those that share one vertex cross if the line from it runs through
/// both.

#include <array>
#include <compare>
#include <span>
#include <vector>

#include "weft/mesh/triangle_mesh.h"

namespace weft::engine::verify {

using Corners = std::array<Vec3, 3>;

/// The first of the three ways.
bool insides_cross(const Corners& a, const Corners& b);

/// A surface at one moment. Coordinates are finite, in the range of orient3d.
struct SurfaceView {
  std::span<const Vec3> positions;      // [m]
  std::span<const Triangle> triangles;  // indices into positions
  bool is_cloth = true;                 // surfaces that are not cloth may cross themselves and each other
};

struct TriangleId {
  int surface = 0, triangle = 0;

  auto operator<=>(const TriangleId&) const = default;
};

/// Two triangles that cross; `a` belongs to a cloth, and a < b if both do.
struct Crossing {
  TriangleId a, b;

  auto operator<=>(const Crossing&) const = default;
};

/// All crossings in order: every pair of triangles that crosses the first way, and for each place of the
/// second and third way the first pair that meets there. A long cut counts once for every two triangles along
/// it.
///
/// Pairs whose boxes overlap are found by sweeping along the direction in which the surfaces spread most, in
/// strips along the second: for cloth about n log n.
std::vector<Crossing> find_crossings(std::span<const SurfaceView> surfaces);

}  // namespace weft::engine::verify
