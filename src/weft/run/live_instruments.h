#pragma once
/// Measurements of a live simulation for its display.

#include <vector>

#include "weft/run/live_values.h"
#include "weft/world.h"

namespace weft::engine {

/// Colours, contacts, yarns and probe of the present state; each is empty without its instrument.
void read_instruments(const World& world, const LiveInstruments& wanted, const std::vector<LivePins>& pins,
                      LiveFrame& frame);

/// Energies and largest strain of the present state.
void measure_world(const weft::World& world, LiveSample& sample);

/// The pins of a scene's cloths (num_cloths), in its world.
std::vector<LivePins> find_pins(const SceneDesc& scene, const weft::World& world);

/// The seams of all cloths (num_cloths).
std::vector<SeamEdges> find_seams(const weft::World& world);

}  // namespace weft::engine
