#pragma once
/// The numbers of a scene that a person tunes, with their parameters: for panels with sliders.

#include <string>
#include <variant>
#include <vector>

#include "weft/parameters.h"
#include "weft/scene/scene_desc.h"

namespace weft::engine {

/// A number of a scene.
struct Tunable {
  std::string key;                       // as overrides name it: "cloth[0].fabric.c11"
  const Parameter* parameter = nullptr;  // unit, range, default and meaning
  std::variant<double*, int*, bool*, Vec3*, NewtonQuality*> value;
};

/// The tunable numbers of one part of a scene; `title` is that of its section in panels.
struct TunableGroup {
  std::string title;  // "cloth sheet"
  int cloth = -1;     // the cloth whose fabric it has; -1: none
  std::vector<Tunable> values;
};

/// All of them, in the order of scene files. They point into `scene`.
std::vector<TunableGroup> list_tunables(SceneDesc& scene);

/// Takes a fabric; a cloth of springs becomes one of this fabric.
void take_fabric(const FabricPreset& preset, ClothSceneDesc& cloth);

/// To be called after changes of numbers. A fabric that differs from its preset gets another name. Values that
/// scene files have once agree: density, thickness, friction, iterations.
void settle_tunables(SceneDesc& scene);

/// A velocity that is uniform and constant. Without drag in the scene: with that of light fabric.
void set_steady_wind(const Vec3& velocity, SceneDesc& scene);

}  // namespace weft::engine
