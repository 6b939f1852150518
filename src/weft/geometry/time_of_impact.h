#pragma once
/// Time of impact of moving features.
///
/// Additive continuous collision detection (ACCD; Li, Kaufman and Jiang 2021), a conservative advancement:
/// from a time at which the distance is d, no point can come nearer than `gap` before another
/// (d − gap) / (greatest relative speed) have passed. Time advances by 0.9 of that, repeatedly.
///
///     |--- d0 ----------------|        No root finding, so no root is missed: the result is never later
///     |------ d1 ------|               than the true time, and a result without impact is free of impact.
///     |--- d2 ---|
///     |gap|
///     |gap|

#include <algorithm>
#include <array>
#include <optional>

#include "weft/core/shapes.h"
#include "weft/core/vec.h"

namespace weft::engine {

/// Minimum distance of features: `separation`, or half of their distance at the start if that is less than
/// twice as much. Halving in every step would end in rounding. The gap is therefore at least `floor`, if the
/// start distance exceeds that by more than the rounding error.
struct ImpactLimit {
  double separation = 0;  // [m]
  double floor = 0;       // at most `separation` [m]
  double rounding = 0;    // of positions [m]

  /// The minimum distance for features that were `start` > 0 apart; below `start`.
  double gap(double start) const {
    return std::min(separation, std::max(start / 2, std::min(floor, start - rounding)));
  }

  /// Distances within this above the gap count as having reached it.
  double tolerance(double start) const { return 0.1 * std::min(start - gap(start), separation); }
};

/// Features at an impact: gap < normal · Σ w_i x_i(time) <= gap + tolerance. They are farther apart only if
/// they grazed each other for so long that the advancement was stopped. Features that touch at the start have
/// their impact then.
struct Impact {
  double time;                    // 0 to 1, from start to end
  double distance_before;         // at the start [m]
  Vec3 normal;                    // from the second feature to the first, unit length
  std::array<double, 4> weights;  // of the corners: first feature positive, second negative
};

/// A vertex and a triangle in straight motion. The corners are the three of the triangle, which is the second
/// feature, and the vertex.
std::optional<Impact> find_vertex_triangle_impact(const std::array<Vec3, 4>& start,
                                                  const std::array<Vec3, 4>& end, const ImpactLimit& limit);

/// Two edges in straight motion; corners 0, 1 are the first's, 2, 3 the second's.
std::optional<Impact> find_edge_edge_impact(const std::array<Vec3, 4>& start, const std::array<Vec3, 4>& end,
                                            const ImpactLimit& limit);

/// Conservative advancement. `at(t)` returns a result for a time 0 to 1, with the features' distance
/// `at(t).distance` [m]; `travel` bounds the change of the distance from 0 to 1 [m]. Returns the first time
/// of impact, and at(that time).
template <class At>
auto find_impact(const At& at, double travel, const ImpactLimit& limit) {
  struct Found {
    double time;
    double distance_before;
    decltype(at(0.0)) place;
  };
  constexpr double kShare = 0.9;
  // Features that graze each other for long need more advances than these. Stopping early is safe: it counts
  // as an impact. Features in resting contact graze in every step, so their limit is lower.
  constexpr int kMaxAdvances = 1000, kMaxAdvancesInTouch = 100;
  Found now{0, 0, at(0.0)};
  const double start = now.distance_before = now.place.distance;
  if (start - travel > 2 * limit.separation) return std::optional<Found>();
  const double gap = limit.gap(start), tolerance = limit.tolerance(start);
  const int most = start > limit.floor ? kMaxAdvances : kMaxAdvancesInTouch;
  for (int advance = 0; advance < most && start > 0; ++advance) {
    const double free = now.place.distance - gap;
    if (free > (1 - now.time) * travel) return std::optional<Found>();
    if (free <= tolerance) break;
    now.time += kShare * free / travel;
    if (now.time >= 1) return std::optional<Found>();
    now.place = at(now.time);
  }
  return std::optional<Found>(now);
}

}  // namespace weft::engine
