#pragma once
/// Worlds as animations: what a run writes to its file, and what pictures are made of.

#include "weft/io/glb_writer.h"
#include "weft/scene/scene_desc.h"
#include "weft/world/world.h"

namespace weft::engine {

/// Films a world that was built from a scene. The world must outlive the film.
class Film {
 public:
  Film(const SceneDesc& scene, const World& world);

  /// The world as it is now becomes the next frame.
  void add_frame();

  /// Throws the frames away, to film on.
  void clear();

  const Animation& animation() const { return animation_; }
  Animation take() { return std::move(animation_); }

 private:
  const World& world_;
  Animation animation_;
  std::size_t num_frames_ = 0;
};

}  // namespace weft::engine
