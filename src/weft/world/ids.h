#pragma once
/// Handles of what a World holds.

#include <cstdint>

namespace weft {

/// A cloth's, as add_cloth gives it. Numbers are never given twice, so that an id of what was removed stays
/// an error. A clone answers to the ids of the world that it was made of.
struct ClothId {
  std::uint32_t world = 0;   // which; 0: none
  std::uint32_t number = 0;  // from 1 on; 0: of nothing
  bool operator==(const ClothId&) const = default;
};

/// A collider's, as add_collider gives it; likewise.
struct ColliderId {
  std::uint32_t world = 0;   // which; 0: none
  std::uint32_t number = 0;  // from 1 on; 0: of nothing
  bool operator==(const ColliderId&) const = default;
};

}  // namespace weft
