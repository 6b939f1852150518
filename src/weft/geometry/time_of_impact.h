#pragma once
/// When moving features come so near to each other that it counts as an impact.
///
/// Additive continuous collision detection (Li, Kaufman and Jiang 2021): from a time at which the distance is
/// d, nothing can come nearer than `gap` before another (d − gap) / (greatest relative speed) have passed;
/// time goes on by 0.9 of that, again and again.
///
///     |--- d0 ----------------|        No roots are looked for, so that none is missed: the time is
///     |------ d1 ------|               never later than the true one, and what is said to be free of
///     |--- d2 ---|                     impact is.
///     |gap|

#include <algorithm>
#include <array>
#include <optional>

#include "weft/core/shapes.h"
#include "weft/core/vec.h"

namespace weft::engine {

/// How near features may come: `separation`, or half of their distance at the start if that is less than
/// twice as much. Halving it step by step would end in rounding: not below `floor`, as long as the start was
/// above it by what rounding can take away.
struct ImpactLimit {
  double separation = 0;  // [m]
  double floor = 0;       // at most `separation` [m]
  double rounding = 0;    // of positions [m]

  /// The least distance for features that were `start` > 0 apart; below `start`.
  double gap(double start) const {
    return std::min(separation, std::max(start / 2, std::min(floor, start - rounding)));
  }

  /// What is within this above the gap counts as having reached it.
  double tolerance(double start) const { return 0.1 * std::min(start - gap(start), separation); }
};

/// Where features are at an impact: gap < normal · Σ w_i x_i(time) <= gap + tolerance; farther apart only
/// where features have grazed each other for so long that advancing was given up. Features that touch at the
/// start have their impact then.
struct Impact {
  double time;                    // 0 to 1, from start to end
  double distance_before;         // at the start [m]
  Vec3 normal;                    // from the second feature to the first, unit length
  std::array<double, 4> weights;  // of the features' corners: the first's positive, the second's negative
};

/// A vertex over a triangle; corners are the triangle's three, which is the second feature, and the vertex.
/// They move in straight lines.
std::optional<Impact> find_vertex_triangle_impact(const std::array<Vec3, 4>& start,
                                                  const std::array<Vec3, 4>& end, const ImpactLimit& limit);

/// Two edges; corners 0, 1 are the first's, 2, 3 the second's. They move in straight lines.
std::optional<Impact> find_edge_edge_impact(const std::array<Vec3, 4>& start, const std::array<Vec3, 4>& end,
                                            const ImpactLimit& limit);

/// The conservative advancement itself. `at(t)` gives features' distance at a time 0 to 1 and whatever else
/// is wanted, `at(t).distance` [m]; `travel` bounds by how much the distance can change from 0 to 1 [m].
/// Returns the first time of impact, and at(that time).
template <class At>
auto find_impact(const At& at, double travel, const ImpactLimit& limit) {
  struct Found {
    double time;
    double distance_before;
    decltype(at(0.0)) place;
  };
  constexpr double kShare = 0.9;
  // Features that graze each other for long need more advances than these. To stop early is safe: it counts
  // as an impact. Features that lie on each other do so in every step, and are given up sooner.
  constexpr int kMostAdvances = 1000, kMostWhereTouching = 100;
  Found now{0, 0, at(0.0)};
  const double start = now.distance_before = now.place.distance;
  if (start - travel > 2 * limit.separation) return std::optional<Found>();
  const double gap = limit.gap(start), tolerance = limit.tolerance(start);
  const int most = start > limit.floor ? kMostAdvances : kMostWhereTouching;
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
