#pragma once
/// Private to the library: the engine's data of a public VertexMotion.

#include <memory>

#include "weft/animation/skinned_mesh.h"
#include "weft/collider.h"

namespace weft {

struct VertexMotionAccess {
  static VertexMotion make(std::shared_ptr<const engine::SkinnedMesh> source) {
    VertexMotion motion;
    motion.source_ = std::move(source);
    return motion;
  }
  static const std::shared_ptr<const engine::SkinnedMesh>& source(const VertexMotion& motion) {
    return motion.source_;
  }
};

}  // namespace weft
