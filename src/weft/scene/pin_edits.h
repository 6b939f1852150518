#pragma once
/// Edits of a cloth's pins, vertex by vertex.

#include <span>
#include <vector>

#include "weft/scene/scene_desc.h"

namespace weft::engine {

/// What the pins of a cloth select: vertices, numbered as ParticleIndices does.
using PinnedVertices = std::vector<std::vector<int>>;  // (pins of the cloth)

/// Holds these vertices still, those that no pin holds yet.
void pin_vertices(std::span<const int> vertices, const PinnedVertices& pinned, ClothSceneDesc& cloth);

/// Takes these vertices away from all pins; a pin keeps its others, and its motion.
void unpin_vertices(std::span<const int> vertices, const PinnedVertices& pinned, ClothSceneDesc& cloth);

}  // namespace weft::engine
