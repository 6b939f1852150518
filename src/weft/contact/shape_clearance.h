#pragma once
/// Remaining clearance: culls cloth vertices that cannot touch a primitive shape in a step, without measuring
/// all distances.
///
///     measured     |<------------- distance ------------->|        A vertex measured at a distance from a
///                  |                                      |        shape is not tested again until cloth and
///     since then   |<- room ->|<--- cloth and shape --->|          shape have moved by as much.
///
/// Bounds are conservative: a vertex that could be near is never skipped.

#include <cmath>
#include <vector>

#include "weft/contact/moving_shape.h"
#include "weft/contact/proximity.h"

namespace weft::engine {

/// The greater of the two squared lengths; NaN if either is NaN.
inline double farther_sq(double length_sq, const Vec3& v) {
  const double other = v.squaredNorm();
  return other > length_sq || std::isnan(other) ? other : length_sq;
}

/// The largest displacement of the first `num_vertices` vertices from start to end [m].
double farthest_way(const SurfaceMotion& motion, int num_vertices);

/// Lower bound for the distance of the axis-aligned box from `min` to `max` to a primitive shape during the
/// step [m].
double least_distance(const MovingShape& shape, const Vec3& min, const Vec3& max);

class ShapeClearance {
 public:
  /// Begins a step. Each of `num_vertices` vertices starts it within `travel` of where it started the step
  /// before; infinite or NaN: unknown, all distances are discarded [m].
  void begin_step(const std::vector<MovingShape>& shapes, int num_vertices, double travel);

  /// Writes into `near`, in ascending order, the vertices that may come nearer to the shape than `reach` in
  /// this step, if none moves farther than `way` [m].
  void find_near(int shape, double way, double reach, std::vector<int>& near) const;

  /// Stores a measurement: the vertex, `way` from its start position, is at this distance at the end [m].
  void set(int shape, int vertex, double distance, double way);

 private:
  struct Row {
    ColliderShape at;             // at the start of the step
    double moved = 0;             // by cloth and shape together since the first step [m]
    double move = 0;              // by the shape, in this step [m]
    std::vector<double> farther;  // (num_vertices) lower bound of the distance, plus `moved` [m]
  };

  std::vector<Row> rows_;  // (shapes)
};

}  // namespace weft::engine
