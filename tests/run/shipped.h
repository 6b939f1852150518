#pragma once
/// Shipped scenes, for tests of runs.

#include <string>

#include "weft/scene/scene_reader.h"

namespace weft::engine {

inline SceneDesc shipped(const std::string& name, const Overrides& overrides = {}) {
  return read_scene(std::string(WEFT_SOURCE_DIR) + "/scenes/" + name + ".toml", overrides);
}

}  // namespace weft::engine
