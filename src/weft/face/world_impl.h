#pragma once
/// Private to face/: the implementation of the public World.

#include <algorithm>
#include <memory>
#include <string>
#include <vector>

#include "weft/face/build_cloth.h"
#include "weft/face/build_collider.h"
#include "weft/forces/wind.h"
#include "weft/world.h"
#include "weft/world/world.h"

namespace weft {

/// Particles whose springs are stiffer or softer than the cloth's others.
struct Stiffening {
  std::vector<int> particles;
  double factor = 1;
};

struct World::Impl {
  struct Cloth {
    ClothDesc desc;
    engine::RestShape rest;
    ClothNotes notes;
    std::vector<Stiffening> stiffened;
    std::vector<char> is_soft;  // (pinned particles, in the order of the pins' lists) held by springs
  };

  struct Collider {
    ColliderDesc desc;
    engine::BuiltCollider built;
  };

  engine::World world;
  std::vector<Cloth> cloths;        // in the order of `world`
  std::vector<Collider> colliders;  // in the order of `world`
  std::vector<engine::WindKey> wind_keys;
  weft::Wind wind;

  const Cloth& at(ClothId id) const { return cloths[world.index(id)]; }
  Cloth& at(ClothId id) { return cloths[world.index(id)]; }
  const Collider& at(ColliderId id) const { return colliders[world.index(id)]; }

  ClothId add(ClothDesc desc);
  ColliderId add(ColliderDesc desc);
};

struct Snapshot::Data {
  std::uint32_t world = 0;  // its identifier; 0: none
  engine::World::Snapshot state;
  std::vector<std::vector<char>> is_soft;  // (cloths)
};

/// Access to the engine inside a World, for the library's other parts.
struct WorldAccess {
  static engine::World& engine(World& world) { return world.impl_->world; }
  static const engine::World& engine(const World& world) { return world.impl_->world; }
  static std::size_t num_soft_pins(const World& world, ClothId cloth) {
    const std::vector<char>& is_soft = world.impl_->at(cloth).is_soft;
    return static_cast<std::size_t>(std::count(is_soft.begin(), is_soft.end(), 1));
  }
  static const engine::RestShape& rest(const World& world, ClothId cloth) {
    return world.impl_->at(cloth).rest;
  }
};

}  // namespace weft
