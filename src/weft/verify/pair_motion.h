#pragma once
/// Exact continuous test: whether a vertex passes through a triangle, or an edge through an edge, in linear
/// motion.
///
/// Root parity (Brochu, Edwards and Bridson 2012, "Efficient geometrically exact continuous collision
/// detection"): f is the difference of the two features' points, a function of time and of the two positions
/// on them. It has an odd number of roots if and only if one feature has passed through the other; grazing
/// contact, or passing back, gives an even number. f maps a prism (vertex and triangle) or a cube (edge and
/// edge). Its number of roots is odd if a ray from the origin meets the image of the boundary an odd number
/// of times. The image of a side is a bilinear patch: two triangles, with the origin possibly between those
/// and the patch.
///
/// All decisions are exact signs, for the motion with the vertex, or the first edge, displaced by 1e-45 m in
/// a fixed direction. So a vertex that moves exactly through a vertex or an edge of a surface passes through
/// an odd number of the triangles there, and one that moves in the plane of a triangle passes through none.
/// Exact for coordinates that are 0 or between 1e-37 and 1e50 in magnitude.

#include <array>

#include "weft/core/vec.h"

namespace weft::engine::verify {

struct PointMotion {
  Vec3 start, end;  // [m]
};

struct PairMotion {
  bool passes = false;
  bool touches_at_start = false,
       touches_at_end = false;  // exactly: the perturbation then decides `passes`
};

PairMotion test_vertex_triangle(const PointMotion& vertex, const std::array<PointMotion, 3>& triangle);
PairMotion test_edge_edge(const std::array<PointMotion, 2>& first, const std::array<PointMotion, 2>& second);

}  // namespace weft::engine::verify
