#pragma once
/// Access to the contents of a public Scene, for the library's other parts.

#include "weft/scene.h"
#include "weft/scene/scene_reader.h"

namespace weft {

struct Scene::State {
  std::string text;
  std::filesystem::path file;
  engine::Overrides overrides;
  engine::SceneDesc desc;  // of these
};

struct SceneAccess {
  static const engine::SceneDesc& desc(const Scene& scene) { return scene.state_->desc; }
};

}  // namespace weft
