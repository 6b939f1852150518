#pragma once
/// Starts of cloths from an earlier state, in place of the scene's own positions and velocities.

#include <string>
#include <vector>

#include "weft/core/vec.h"
#include "weft/scene/scene_world.h"

namespace weft::engine {

/// Vectors of the vertices of a cloth's mesh as it was given, in their order (num_vertices).
struct ClothStart {
  std::string cloth;             // its name
  std::vector<Vec3> positions;   // in world coordinates [m]
  std::vector<Vec3> velocities;  // [m/s]
};

struct SceneStart {
  std::string source;              // for messages: "frame 60 of out/flag"
  std::vector<ClothStart> cloths;  // at least one
};

/// Moves the cloths of these names there; pins hold them there. Others stay, with a note. Throws InputError if
/// no cloth has one of these names, or if one has another number of vertices.
void set_start(const SceneStart& start, PublicScene& built);

}  // namespace weft::engine
