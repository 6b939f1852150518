#pragma once
/// Points bound to the surface of a collider, which they follow as it moves and deforms.

#include "weft/contact/collider.h"

namespace weft::engine {

/// A point bound to a collider. On a mesh: to its nearest triangle, by the weights of the corners and an
/// offset in the triangle's frame: the direction of the first edge, the direction across it in the plane, and
/// the normal. On a primitive shape: to the shape as a rigid body.
struct SurfaceAnchor {
  int triangle = -1;            // of a mesh; −1: on a primitive shape
  Vec3 weights = Vec3::Zero();  // of the triangle's corners, sum 1 [1]
  Vec3 offset =
      Vec3::Zero();  // in the triangle's frame; of a primitive shape the point in its initial pose [m]
};

/// A collider at a time.
struct PlacedCollider {
  const Collider* collider = nullptr;
  double time = 0;      // [s]
  ColliderShape shape;  // shape_at(*collider, time)
};

PlacedCollider place(const Collider& collider, double time);

/// Binds the point p of the world. A mesh must have a triangle with an area.
SurfaceAnchor bind_point(const PlacedCollider& body, const Vec3& p);

/// Position of the bound point with the collider at another place.
Vec3 position_of(const SurfaceAnchor& anchor, const PlacedCollider& body);

}  // namespace weft::engine
