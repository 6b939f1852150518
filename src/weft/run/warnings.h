#pragma once
/// Text for the warnings that a World reports as data: the event, and the key of a scene file to change.

#include <string>

#include "weft/world/world.h"

namespace weft::engine {

/// The code as in reports: "cap_reached", …
std::string to_string(WarningCode code);
std::string to_string(StepFault fault);

/// `cloth "sheet": … ; raise solver.…`
std::string describe(const World& world, const StepWarning& warning);

/// `cloth "sheet" particle 12 and collider "ball"`
std::string describe(const World& world, const InfeasiblePair& pair);

}  // namespace weft::engine
