#pragma once
/// Remaining clearance: which vertices of cloth may touch a plain shape in a step, without measuring all.
///
///     measured     |<------------- distance ------------->|        A vertex that was found at a distance
///     from
///                  |                                      |        a shape need not be looked at again until
///     since then   |<- room ->|<--- cloth and shape --->|            cloth and shape have moved by as much.
///
/// Bounds are conservative: a vertex that could be near is never left out.

#include <cmath>
#include <vector>

#include "weft/contact/moving_shape.h"
#include "weft/contact/proximity.h"

namespace weft::engine {

/// The greater of the two squared lengths, not a number if either is none.
inline double farther_sq(double length_sq, const Vec3& v) {
  const double other = v.squaredNorm();
  return other > length_sq || std::isnan(other) ? other : length_sq;
}

/// How far any of the first `num_vertices` vertices moves from start to end [m].
double farthest_way(const SurfaceMotion& motion, int num_vertices);

/// No point of the axis-aligned box from `min` to `max` comes nearer to a plain shape during the step; may be
/// less than it is [m].
double least_distance(const MovingShape& shape, const Vec3& min, const Vec3& max);

class ShapeClearance {
 public:
  /// A step begins. Each of `num_vertices` vertices starts it within `travel` of where it started the step
  /// before; infinite or not a number: nothing is known of them [m].
  void begin_step(const std::vector<MovingShape>& shapes, int num_vertices, double travel);

  /// Puts into `near`, in ascending order, the vertices that may come nearer to the shape than `reach` in
  /// this step, if none moves farther than `way` [m].
  void find_near(int shape, double way, double reach, std::vector<int>& near) const;

  /// The vertex, `way` from where it starts the step, is at this distance from the shape at the end [m].
  void set(int shape, int vertex, double distance, double way);

 private:
  struct Row {
    ColliderShape at;             // where the step begins
    double moved = 0;             // by cloth and shape together, since the first step [m]
    double move = 0;              // by the shape, in this step [m]
    std::vector<double> farther;  // (num_vertices) than this less `moved` at the start of the step [m]
  };

  std::vector<Row> rows_;  // (shapes)
};

}  // namespace weft::engine
