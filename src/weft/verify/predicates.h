#pragma once
/// Exact orientation predicates: side of a plane or line.

#include "weft/core/vec.h"

/// The checker's own code: shares nothing with contact detection.
namespace weft::engine::verify {

/// The sign, +1, 0 or −1, of
///
///     | ax−dx  ay−dy  az−dz |
///     | bx−dx  by−dy  bz−dz |  =  (a − d) · ((b − d) × (c − d))
///     | cx−dx  cy−dy  cz−dz |
///
/// Positive if a, b, c turn clockwise viewed from d; 0 if and only if the four points are coplanar. Computed
/// in doubles first, with a bound on the rounding error. If that is inconclusive, with expansions:
/// unevaluated sums of doubles with the exact value (Shewchuk 1997, "Adaptive precision floating-point
/// arithmetic and fast robust geometric predicates", section 4.3 for the bound, 2 for the sums).
///
/// Exact for coordinates that are 0 or between 1e-90 and 1e90 in magnitude, in any mixture: the last bit of a
/// product of three then neither underflows nor overflows. Every finite float is in that range.
int orient3d(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d);

/// The sign of (a − c) × (b − c) in the plane: +1 if a, b, c turn counter-clockwise, 0 if they are collinear.
/// Exact in the same range.
int orient2d(const Eigen::Vector2d& a, const Eigen::Vector2d& b, const Eigen::Vector2d& c);

}  // namespace weft::engine::verify
