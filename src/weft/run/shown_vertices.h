#pragma once
/// The vertices of the user's mesh, in animations for other programs.

#include <optional>

#include "weft/io/animation.h"
#include "weft/world.h"

namespace weft::engine {

/// The vertices to show of a cloth. Empty if its particles are the vertices, each with one texture coordinate or
/// none.
std::optional<ShownVertices> show_vertices(const weft::World& world, ClothId cloth);

}  // namespace weft::engine
