#pragma once
/// Contact points that a step reports: bodies, position and force.

#include "weft/core/vec.h"

namespace weft::engine {

/// A point at which a cloth touched another body in the last step. Exactly one of `other_cloth` and
/// `collider` is not -1; in self contact `other_cloth` is the cloth itself.
struct ContactPoint {
  Vec3 position;     // [m]
  Vec3 normal;       // unit length, towards the cloth
  Vec3 force;        // on the cloth, friction included; the other side gets the opposite [N]
  int cloth = 0;     // number
  int particle = 0;  // nearest particle of the cloth
  int other_cloth = -1, collider = -1;
  int other_vertex = -1;  // nearest vertex of the other cloth or of the collider mesh; -1: primitive shape
};

}  // namespace weft::engine
