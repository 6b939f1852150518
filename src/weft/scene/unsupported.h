#pragma once
/// What a scene has that an integrator does not support.

#include <string>
#include <string_view>
#include <vector>

#include "weft/scene/scene_desc.h"

namespace weft::engine {

struct Unsupported {
  std::string key;       // of [solver], to be changed
  std::string sentence;  // without its subject, the integrator: `does not support …; use …`
};

/// Empty: it supports all. Throws InputError for an unknown name.
std::vector<Unsupported> find_unsupported(const SceneDesc& scene, std::string_view integrator);

}  // namespace weft::engine
