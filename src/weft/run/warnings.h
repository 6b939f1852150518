#pragma once
/// Sentences for what a World reports as data: what happened, and which key of a scene file to turn.

#include <string>

#include "weft/world/world.h"

namespace weft::engine {

/// The code as reports have it: "cap_reached", …
std::string to_string(WarningCode code);
std::string to_string(StepFault fault);

/// `cloth "sheet": … ; raise solver.…`
std::string describe(const World& world, const StepWarning& warning);

/// `cloth "sheet" particle 12 and collider "ball"`
std::string describe(const World& world, const InfeasiblePair& pair);

}  // namespace weft::engine
