#pragma once
/// From a scene to a world that can step.

#include <memory>
#include <string>
#include <vector>

#include "weft/scene/scene_desc.h"
#include "weft/world.h"
#include "weft/world/world.h"

namespace weft::engine {

/// What building a scene has to say.
struct SceneNotes {
  double untangle_seconds = 0;        // that setting apart what crossed at the start took [s]
  std::vector<std::string> warnings;  // what is odd about meshes, pins and colliders, in sentences
  std::vector<std::string> notes;     // what was done to meshes as the scene asks, in sentences
};

struct PublicScene : SceneNotes {
  weft::World world;
};

/// The same without the public face.
struct SceneWorld : SceneNotes {
  World world;
};

/// Loads meshes, places cloth, sets pins. A collider's mesh that faces inwards is turned right side out.
/// Throws InputError where a mesh cannot be used or a pin selects nothing.
PublicScene build_scene(const SceneDesc& scene, std::shared_ptr<JobSystem> jobs);
SceneWorld build_world(const SceneDesc& scene, std::shared_ptr<JobSystem> jobs);

/// A scene's wind, as a World takes it.
weft::Wind describe_wind(const WindDesc& wind);

}  // namespace weft::engine
