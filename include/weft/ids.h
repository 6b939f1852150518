#pragma once
/// Handles of cloths and colliders.
///
/// An id is a value. It stays valid until its cloth or collider is removed. Its number is never reused: the
/// id of a removed body is an error, never another body. Every call throws InputError for an empty id, and
/// for one of another world or of a removed body. A clone of a world accepts its ids.

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
