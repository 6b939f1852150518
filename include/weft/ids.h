#pragma once
/// Handles of cloths and colliders.
///
/// An id is a value. It stays valid until its cloth or collider is removed, and its number is never given
/// again, so that an id of something removed is an error, never something else. An empty id, one of another
/// world and one of something removed make every call throw InputError. A clone of a world accepts its ids.

#include <cstdint>

namespace weft {

/// Of a cloth, from World::add_cloth or World::cloth.
struct ClothId {
  std::uint32_t world = 0;   // which world; 0: none
  std::uint32_t number = 0;  // from 1 on; 0: empty
  bool operator==(const ClothId&) const = default;
};

/// Of a collider, from World::add_collider or World::collider.
struct ColliderId {
  std::uint32_t world = 0;   // which world; 0: none
  std::uint32_t number = 0;  // from 1 on; 0: empty
  bool operator==(const ColliderId&) const = default;
};

}  // namespace weft
