#pragma once
/// What touches what, where and how hard: what a step tells of its contacts.

#include "weft/core/vec.h"

namespace weft::engine {

/// A place where a cloth touched something in the last step. Exactly one of `other_cloth` and `collider` is
/// not -1; cloth that touches itself is its own other cloth.
struct ContactPoint {
  Vec3 position;     // [m]
  Vec3 normal;       // unit length, towards the cloth
  Vec3 force;        // on the cloth, friction included; the other side gets the opposite [N]
  int cloth = 0;     // number
  int particle = 0;  // of the cloth, the nearest
  int other_cloth = -1, collider = -1;
  int other_vertex = -1;  // the nearest of the other cloth or of the collider's mesh; -1: of a plain shape
};

}  // namespace weft::engine
