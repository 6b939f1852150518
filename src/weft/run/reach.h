#pragma once
/// Where a scene will probably go, guessed from its start: for cameras that must look before the future is
/// known.

#include <vector>

#include "weft/world/world.h"

namespace weft::engine {

/// Points around all that is at the start, what can hang from pins, and what falls, down to a level plane, to
/// a little below the lowest collider, or by its own size [m].
std::vector<Vec3> find_reach(const World& world);

}  // namespace weft::engine
