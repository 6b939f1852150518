#pragma once
/// Private to face/: pins of the public World, which are pins or attachments (soft pins) of the engine's.

#include <string>

#include "weft/world/world.h"

namespace weft::engine {

/// The beginning of a message on a body: `cloth "sheet": `.
std::string who(const std::string& kind, const std::string& name);

/// Sets the targets of soft pins to their particles' positions.
void hold_soft_pins(World& world, ClothId cloth);

}  // namespace weft::engine
