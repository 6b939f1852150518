#pragma once
/// Framing for live cameras: an estimate of a scene's future extent, from its start.

#include <vector>

#include "weft/world/world.h"

namespace weft::engine {

/// Points around the initial cloth and colliders, hanging cloth below its pins, and falling cloth. Cloth
/// falls to a level plane, else slightly below the lowest collider, else by its own size [m].
std::vector<Vec3> find_reach(const World& world);

}  // namespace weft::engine
