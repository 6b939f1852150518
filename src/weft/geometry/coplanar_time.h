#pragma once
/// When four moving points come to lie in one plane.

#include <array>
#include <optional>

#include "weft/core/vec.h"

namespace weft::engine {

/// Four points move in straight lines from `start` to `end`, in time 0 to 1. Returns the first time > 0 at
/// which the volume that they span,
///
///     V(t) = (x₁ − x₀) × (x₂ − x₀) · (x₃ − x₀),
///
/// a cubic in t, changes its sign; nothing if it never does. A vertex that goes through a triangle, and an
/// edge that goes through another, do so at such a time (Provot 1997); where the points are then tells
/// whether they really meet. Found by bisection between the cubic's extremes, to 1e-9.
std::optional<double> find_coplanar_time(const std::array<Vec3, 4>& start, const std::array<Vec3, 4>& end);

}  // namespace weft::engine
