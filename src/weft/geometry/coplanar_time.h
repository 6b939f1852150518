#pragma once
/// The time at which four moving points become coplanar.

#include <array>
#include <optional>

#include "weft/core/vec.h"

namespace weft::engine {

/// Four points move in straight lines from `start` to `end`, in time 0 to 1. Returns the first time > 0 at
/// which the volume that they span,
///
///     V(t) = (x₁ − x₀) × (x₂ − x₀) · (x₃ − x₀),
///
/// a cubic in t, changes its sign; empty if it never does. A vertex that passes through a triangle, and an
/// edge that passes through another, do so at such a time (Provot 1997); the positions at that time decide
/// whether they really meet. Bisection between the cubic's extrema, to 1e-9.
std::optional<double> find_coplanar_time(const std::array<Vec3, 4>& start, const std::array<Vec3, 4>& end);

}  // namespace weft::engine
