#pragma once
/// Animation curves: numbers by key times, interpolated as in glTF 2.0 (appendix C, "Animation Sampler
/// Interpolation Modes").

#include <span>
#include <vector>

#include "weft/core/vec.h"

namespace weft::engine {

enum class Interpolation {
  linear,        // rotations: spherical, along the shortest arc (slerp)
  step,          // the value of the last key
  cubic_spline,  // Hermite spline; rotations: by component, then normalised
};

/// Vectors of one width at key times, constant before the first key and after the last.
struct AnimationCurve {
  Interpolation interpolation = Interpolation::linear;
  std::vector<double> times;  // (num_keys), strictly increasing [s]
  std::vector<double>
      values;  // (num_keys x width); cubic_spline: (num_keys x 3 x width), by key the incoming
               // tangent, the value and the outgoing tangent, tangents per second

  bool empty() const { return times.empty(); }
};

/// Overwrites `value` (width) by the curve's value at `time` [s]. The curve must not be empty.
void evaluate(const AnimationCurve& curve, double time, std::span<double> value);

/// The unit quaternion of a curve of width 4 (x, y, z, w) at `time` [s]. Keys are not zero; their lengths do
/// not matter for `linear` and `step`. A spline through zero is zero there, which as a matrix is no rotation.
Eigen::Quaterniond evaluate_rotation(const AnimationCurve& curve, double time);

}  // namespace weft::engine
