#pragma once
/// Two surfaces of colliders that may hold cloth between each other, around a point.

#include <array>

#include "weft/contact/step_bodies.h"
#include "weft/geometry/shape_distance.h"

namespace weft::engine {

/// Two surfaces around a point, which they carry along with their mean motion.
struct Between {
  Vec3 start, end;                              // the point [m]
  std::array<Vec3, 2> ways;                     // how far the surfaces move in the step [m]
  std::array<SignedDistance, 2> before, after;  // of the point from them, at the start and the end

  /// How much nearer than to fit the surfaces are to the middle at the end [m].
  double missing(double half_thickness) const {
    return half_thickness - 0.5 * (after[0].distance + after[1].distance);
  }
};

/// Looks from a point at the start of the step. Sides on meshes move to the triangles nearest to it.
Between look_between(const StepBodies& bodies, std::array<HoldingSide, 2>& sides, const Vec3& start);

/// Cosine between the normals of the surfaces at the start; beside a box's face that of the box there.
double cosine_at_start(const StepBodies& bodies, const Between& between,
                       const std::array<HoldingSide, 2>& sides);

/// Whether p is beside a box, by more than `room` from it: the planes of its faces have no end.
bool is_beside(const StepBodies& bodies, const HoldingSide& side, const Vec3& p, double room);

/// The face of a box that looks most along a direction, of those that p is in front of, or behind by up to
/// `depth`; -1: none.
int face_along(const OrientedBox& box, const Vec3& direction, const Vec3& p, double depth);

}  // namespace weft::engine
