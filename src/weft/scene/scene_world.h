#pragma once
/// Builds the World of a scene.

#include <memory>
#include <string>
#include <vector>

#include "weft/scene/scene_desc.h"
#include "weft/world.h"
#include "weft/world/world.h"

namespace weft::engine {

/// Messages from building a scene.
struct SceneNotes {
  double untangle_seconds = 0;        // time for removing initial intersections [s]
  std::vector<std::string> warnings;  // suspect properties of meshes, pins and colliders
  std::vector<StepReport> settling;   // of the steps before time 0
  std::vector<std::string> notes;     // changes to meshes that the scene asks for
};

struct PublicScene : SceneNotes {
  weft::World world;
};

/// The same with the internal World.
struct SceneWorld : SceneNotes {
  World world;
};

struct SceneStart;  // scene_start.h

/// Loads meshes, places cloth, sets pins. A collider mesh that faces inwards is flipped. `start` then moves
/// cloths, before intersections are removed and the scene settles; null: none. Throws InputError if a mesh
/// cannot be used, if a pin selects nothing, and like set_start().
PublicScene build_scene(const SceneDesc& scene, std::shared_ptr<JobSystem> jobs,
                        const SceneStart* start = nullptr, const OnPreparation& on_preparation = {});

/// The same before intersections are removed and the scene settles: at the time -SceneDesc::settle.
PublicScene place_scene(const SceneDesc& scene, std::shared_ptr<JobSystem> jobs,
                        const OnPreparation& on_preparation = {});
SceneWorld build_world(const SceneDesc& scene, std::shared_ptr<JobSystem> jobs,
                       const OnPreparation& on_preparation = {});

/// The pins of a cloth as input for the world that has it, with particles selected by their initial positions.
/// Throws InputError for a selection without particles.
std::vector<weft::Pin> describe_pins(const ClothSceneDesc& cloth, ClothId id, const weft::World& world);

/// A scene's wind as input for a World.
weft::Wind describe_wind(const WindDesc& wind);

}  // namespace weft::engine
