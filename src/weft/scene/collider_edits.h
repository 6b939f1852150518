#pragma once
/// Edits of a scene's colliders by hand: added, displaced, turned.

#include "weft/scene/scene_desc.h"

namespace weft::engine {

enum class NewCollider { ball, box, capsule, floor };

/// Adds a collider under a name that no other has, and returns its index. `size`: half of its length [m].
std::size_t add_collider(NewCollider kind, const Vec3& center, double size, SceneDesc& scene);

/// Removes a collider, with the contact settings of its name.
void remove_collider(std::size_t index, SceneDesc& scene);

/// Whether a hand can move it: it has no motion of its own, and it is no plane.
bool is_movable(const ColliderSceneDesc& collider);

/// p ↦ rotation p + translation, in the world's coordinates. Balls and planes are only displaced.
void displace(const Pose& displacement, ColliderSceneDesc& collider);

/// Angles about fixed x, then y, then z, with rotation_from_angles_deg() as their inverse [degrees].
Vec3 angles_of(const Mat3& rotation);

}  // namespace weft::engine
