#pragma once
/// What a person should know of a scene before it runs: how large things are, and what crosses at the start.

#include <string>
#include <vector>

#include "weft/scene/scene_desc.h"
#include "weft/world/world.h"

namespace weft::engine {

/// A sentence for every two things that cross, or of which one is in the other, before anything has moved.
std::vector<std::string> check_start(const World& world);

struct SizeCheck {
  /// `cloth "shirt": 0.62 m wide, 0.71 m high, 0.24 m deep, 5230 triangles`, for every cloth and every mesh
  /// among the colliders. Wide, high and deep are along x, y and z.
  std::vector<std::string> sizes;
  std::vector<std::string> warnings;  // of a mesh that seems to be in another unit, or to lie on its back
};

/// `world` is the scene's.
SizeCheck check_sizes(const SceneDesc& scene, const World& world);

}  // namespace weft::engine
