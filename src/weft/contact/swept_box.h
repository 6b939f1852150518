#pragma once
/// Private to contact/: a swept AABB in SIMD registers.

#include "weft/core/float4.h"
#include "weft/core/vec.h"
#include "weft/geometry/aabb.h"

namespace weft::engine {

inline Float4 to_float4(const Vec3& v) {
  return {static_cast<float>(v.x()), static_cast<float>(v.y()), static_cast<float>(v.z()), 0};
}

/// A MovingAabb in registers: bounds of the start points, and of their displacements [m]. Empty by default.
struct SweptBox {
  Float4 min = Float4::Constant(Aabb::kInfinity), max = -min;
  Float4 way_min = min, way_max = max;

  /// As MovingAabb::may_meet.
  bool may_meet(const SweptBox& other) const {
    const Float4 towards = (other.way_max - way_min).cwiseMax(Float4::Zero()),
                 away = (way_max - other.way_min).cwiseMax(Float4::Zero());
    return (min - other.max).is_at_most(towards) && (other.min - max).is_at_most(away);
  }

  void add(const Float4& place, const Float4& way) {
    min = min.cwiseMin(place);
    max = max.cwiseMax(place);
    way_min = way_min.cwiseMin(way);
    way_max = way_max.cwiseMax(way);
  }

  void merge(const SweptBox& other) {
    min = min.cwiseMin(other.min);
    max = max.cwiseMax(other.max);
    way_min = way_min.cwiseMin(other.way_min);
    way_max = way_max.cwiseMax(other.way_max);
  }

  MovingAabb to_aabb() const {
    return {{{min[0], min[1], min[2]}, {max[0], max[1], max[2]}},
            {{way_min[0], way_min[1], way_min[2]}, {way_max[0], way_max[1], way_max[2]}}};
  }
};

}  // namespace weft::engine
