#pragma once
/// Axis-aligned bounding boxes in floats, for the broad phase of collision detection.

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>

#include "weft/core/vec.h"

namespace weft::engine {

/// { p : min <= p <= max }, component by component. Empty by default: it overlaps nothing, not even itself.
struct Aabb {
  static constexpr float kInfinity = std::numeric_limits<float>::infinity();
  std::array<float, 3> min = {kInfinity, kInfinity, kInfinity};
  std::array<float, 3> max = {-kInfinity, -kInfinity, -kInfinity};

  /// Two boxes overlap if and only if their projections on all three axes do: six comparisons at most.
  /// Boxes that touch overlap.
  bool overlaps(const Aabb& other) const {
    return min[0] <= other.max[0] && other.min[0] <= max[0] && min[1] <= other.max[1] &&
           other.min[1] <= max[1] && min[2] <= other.max[2] && other.min[2] <= max[2];
  }

  /// The same, with a count of the number comparisons.
  bool overlaps(const Aabb& other, std::int64_t& num_comparisons) const {
    const auto is_below = [&](float a, float b) {
      ++num_comparisons;
      return a <= b;
    };
    for (int k = 0; k < 3; ++k) {
      if (!is_below(min[k], other.max[k]) || !is_below(other.min[k], max[k])) return false;
    }
    return true;
  }

  void merge(const Aabb& other) {
    for (int k = 0; k < 3; ++k) {
      min[k] = std::min(min[k], other.min[k]);
      max[k] = std::max(max[k], other.max[k]);
    }
  }

  /// Half the surface area, 0 if empty.
  float half_area() const {
    const float a = std::max(0.0f, max[0] - min[0]), b = std::max(0.0f, max[1] - min[1]),
                c = std::max(0.0f, max[2] - min[2]);
    return a * b + b * c + c * a;
  }

  /// Squared distance from p, 0 inside.
  double distance_sq(const Vec3& p) const {
    double sum = 0;
    for (int k = 0; k < 3; ++k) {
      const double beyond = std::max({0.0, min[k] - p[k], p[k] - max[k]});
      sum += beyond * beyond;
    }
    return sum;
  }
};

/// Bounds of moving points: start points in `box`, straight displacements in `way`.
struct MovingAabb {
  Aabb box;  // at the start [m]
  Aabb way;  // displacements, not positions [m]

  /// False if no point of the one can coincide with a point of the other at the same time. Only the relative
  /// motion counts, however far both move. Six comparisons at most.
  bool may_meet(const MovingAabb& other) const {
    for (int k = 0; k < 3; ++k) {
      if (box.min[k] > other.box.max[k] + std::max(0.0f, other.way.max[k] - way.min[k])) return false;
      if (other.box.min[k] > box.max[k] + std::max(0.0f, way.max[k] - other.way.min[k])) return false;
    }
    return true;
  }

  void merge(const MovingAabb& other) {
    box.merge(other.box);
    way.merge(other.way);
  }
};

/// The next larger float: equals std::nextafter(x, infinity) for any x below infinity, and is faster.
inline float next_above(float x) {
  if (x == 0) return std::numeric_limits<float>::denorm_min();
  const auto bits = std::bit_cast<std::int32_t>(x);
  return std::bit_cast<float>(x > 0 ? bits + 1 : bits - 1);
}

/// The smallest float box that contains the box from min to max, enlarged by `margin`.
inline Aabb make_aabb(const Vec3& min, const Vec3& max, double margin = 0) {
  Aabb box;
  for (int k = 0; k < 3; ++k) {
    const double low = min[k] - margin, high = max[k] + margin;
    box.min[k] = static_cast<float>(low);
    box.max[k] = static_cast<float>(high);
    if (box.min[k] > low) box.min[k] = -next_above(-box.min[k]);
    if (box.max[k] < high) box.max[k] = next_above(box.max[k]);
  }
  return box;
}

}  // namespace weft::engine
