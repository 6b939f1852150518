#pragma once
/// Pictures of scenes: the frames of an animation as lists of meshes to draw.

#include <optional>

#include "weft/io/animation.h"
#include "weft/model/cloth_model.h"
#include "weft/render/picture.h"

namespace weft::engine {

/// The springs of one cloth, to be drawn instead of its surface.
struct SpringsToDraw {
  int cloth = 0;  // index in the animation
  std::shared_ptr<const ClothTopology> topology;
};

struct SceneStyle {
  bool transparent = false;      // nothing behind the cloth and what holds it
  std::optional<double> ground;  // its height where the scene has no level plane; empty: below all frames [m]
  std::vector<SpringsToDraw> springs;  // of cloths that are drawn as springs
};

/// Draws the frames of an animation, which must outlive this. Cloth is woven of checks where it has fabric
/// coordinates; level planes are drawn as endless ground.
class ScenePictures {
 public:
  explicit ScenePictures(const Animation& animation, SceneStyle style = {});

  /// Frame 0 is the start.
  Picture at(int frame, const Camera& camera) const;

 private:
  const Animation& animation_;
  SceneStyle style_;
};

/// The camera turned as `like`, at the distance from which everything in these frames is in the picture.
Camera frame_scene(const Animation& animation, const std::vector<int>& frames, const Camera& like,
                   double aspect);

int num_frames(const Animation& animation);

}  // namespace weft::engine
