#pragma once
/// Primitive shapes of colliders and regions of space.

#include <variant>

#include "weft/core/vec.h"

namespace weft::engine {

struct Sphere {
  Vec3 center = Vec3::Zero();  // [m]
  double radius = 1;           // > 0 [m]
  bool operator==(const Sphere&) const = default;
};

/// Half space below a plane, solid: { p : (p - point) · normal < 0 }.
struct Plane {
  Vec3 point = Vec3::Zero();    // [m]
  Vec3 normal = Vec3::UnitY();  // unit length [1]
  bool operator==(const Plane&) const = default;
};

/// All points within `radius` of the segment a–b; a = b is a sphere.
struct Capsule {
  Vec3 a = Vec3::Zero();   // [m]
  Vec3 b = Vec3::UnitY();  // [m]
  double radius = 0.5;     // > 0 [m]
  bool operator==(const Capsule&) const = default;
};

/// A solid box in any orientation.
struct OrientedBox {
  Vec3 center = Vec3::Zero();            // [m]
  Vec3 half_size = Vec3::Constant(0.5);  // along its own axes, > 0 [m]
  Mat3 rotation = Mat3::Identity();      // from the box's own axes (its columns) to the world's [1]
  bool operator==(const OrientedBox&) const = default;
};

/// A solid primitive.
using SolidShape = std::variant<Sphere, Plane, Capsule, OrientedBox>;

/// Axis-aligned box.
struct Box {
  Vec3 min = Vec3::Zero();  // [m]
  Vec3 max = Vec3::Ones();  // [m]

  bool contains(const Vec3& p) const { return (p.array() >= min.array() && p.array() <= max.array()).all(); }
  bool operator==(const Box&) const = default;
};

}  // namespace weft::engine
