#pragma once
/// Pictures of scenes: frames of an animation as lists of meshes to draw.

#include <optional>

#include "weft/io/animation.h"
#include "weft/model/cloth_model.h"
#include "weft/render/picture.h"

namespace weft::engine {

/// The springs of one cloth, drawn instead of its surface.
struct SpringsToDraw {
  int cloth = 0;  // index in the animation
  std::shared_ptr<const ClothTopology> topology;
};

struct SceneStyle {
  bool transparent = false;            // no background behind cloth and colliders
  bool has_ground = true;              // false: only if the scene has a level plane
  std::optional<double> ground;        // height if the scene has no level plane; empty: below all frames [m]
  std::vector<Color> cloth_colors;     // of the first cloths, in place of the animation's
  std::vector<SpringsToDraw> springs;  // of cloths that are drawn as springs
};

/// Draws the frames of an animation, which must outlive this. Cloth with fabric coordinates is drawn with
/// checks; level planes are drawn as endless ground.
class ScenePictures {
 public:
  explicit ScenePictures(const Animation& animation, SceneStyle style = {});

  /// Frame 0 is the start.
  Picture at(int frame, const Camera& camera) const;

  /// What each mesh of at() shows, then the ground. A cloth is its index, a body its index plus the number of
  /// cloths; -1: the ground is no body.
  std::vector<int> shown() const;

 private:
  const SpringsToDraw* find_springs(int cloth) const;

  const Animation& animation_;
  SceneStyle style_;
};

/// The camera with the orientation of `like`, at a distance that shows everything but planes in these frames;
/// `like` itself if there is nothing.
Camera frame_scene(const Animation& animation, const std::vector<int>& frames, const Camera& like,
                   double aspect);

int num_frames(const Animation& animation);

}  // namespace weft::engine
