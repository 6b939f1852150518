#pragma once
/// Checks of a scene before its run: sizes of meshes, and initial intersections.

#include <optional>
#include <string>
#include <vector>

#include "weft/scene/scene_desc.h"
#include "weft/world/world.h"

namespace weft::engine {

/// A message for each pair of bodies that intersect initially, or one of which is inside the other.
std::vector<std::string> check_start(const World& world);

/// Why a run refuses a start for which check_start() has found something; empty: it does not.
std::optional<std::string> refuse_start(const SceneDesc& scene, const std::vector<std::string>& found);

struct SizeCheck {
  /// `cloth "shirt": 0.62 m wide, 0.71 m high, 0.24 m deep, 5230 triangles`, for every cloth and every mesh
  /// collider. Width, height and depth are along x, y and z.
  std::vector<std::string> sizes;
  std::vector<std::string> warnings;  // of meshes with a suspect unit or orientation
};

/// `world` is the scene's.
SizeCheck check_sizes(const SceneDesc& scene, const World& world);

}  // namespace weft::engine
