#pragma once
/// Solid shapes that cloth is held off from, each still or moving by prescription.

#include <string>
#include <variant>

#include "weft/animation/rigid_motion.h"
#include "weft/core/shapes.h"

namespace weft {

using ColliderShape = std::variant<Sphere, Plane>;

struct Collider {
  std::string name;
  ColliderShape shape;
  double friction = 0.3;  // Coulomb's coefficient, >= 0 [1]
  RigidMotion motion;     // turns about the sphere's centre or the plane's point
};

/// Signed distance from p to the shape's surface, negative inside, and the outward unit normal there. At a
/// sphere's centre the normal points up.
struct SignedDistance {
  double distance;  // [m]
  Vec3 normal;
};

SignedDistance signed_distance(const ColliderShape& shape, const Vec3& p);

/// The point that the collider turns about.
Vec3 pivot(const ColliderShape& shape);

/// The collider's shape where its motion has taken it.
ColliderShape shape_at(const Collider& collider, double time);

}  // namespace weft
