#pragma once
/// Pictures of scenes: frames of an animation as lists of meshes to draw.

#include <optional>

#include "weft/io/animation.h"
#include "weft/mesh/hem.h"
#include "weft/mesh/loop_subdivision.h"
#include "weft/model/cloth_model.h"
#include "weft/render/picture.h"

namespace weft::engine {

/// The springs of one cloth, drawn instead of its surface.
struct SpringsToDraw {
  int cloth = 0;  // index in the animation
  std::shared_ptr<const ClothTopology> topology;
};

/// The least and the largest value in these frames.
std::array<double, 2> find_range(FrameSource& source, const std::vector<int>& frames);

/// The frames of a source, which must outlive this, with the vertices' speeds as values: from differences of
/// frames; 0 in the first one [m/s].
class FramesWithSpeeds final : public FrameSource {
 public:
  explicit FramesWithSpeeds(FrameSource& source) : source_(source) {}
  const Animation& meshes() const override { return source_.meshes(); }
  int num_frames() override { return source_.num_frames(); }
  AnimationFrame read(int frame) override;

 private:
  FrameSource& source_;
};

struct SceneStyle {
  bool transparent = false;            // no background behind cloth and colliders
  std::optional<double> ground;        // height of a ground where no plane is level; empty: none [m]
  std::vector<Color> cloth_colors;     // of the first cloths, in place of the animation's
  std::vector<SpringsToDraw> springs;  // of cloths that are drawn as springs
  std::optional<int> smooth;           // Loop subdivisions of cloth, with hems; empty: its triangles, without
  std::array<double, 2> range = {0, 1};  // of a frame's values, by the first and the last colour
};

/// Draws the frames of an animation, whose meshes must outlive this. Cloth of a preset's fabric has its weave,
/// other cloth with fabric coordinates has checks; level planes are drawn as endless ground. A frame's values
/// are shown in place of the cloths' colours.
class ScenePictures {
 public:
  ScenePictures(const Animation& meshes, const AnimationFrame& start, SceneStyle style = {});

  Picture at(const AnimationFrame& frame, const Camera& camera) const;

  /// What each mesh of at() shows, then the ground. A cloth is its index, a body its index plus the number of
  /// cloths; -1: the ground is no body.
  std::vector<int> shown(const AnimationFrame& frame) const;

 private:
  /// Topology of a cloth that is drawn smooth.
  struct Smooth {
    LoopSubdivision subdivision;
    Hem hem;
    std::vector<float> fabric_coordinates;
  };

  Smooth make_smooth(const AnimatedCloth& cloth, const std::vector<float>& positions) const;
  const SpringsToDraw* find_springs(int cloth) const;
  DrawnMesh draw_cloth(int cloth, const AnimationFrame& frame, const Camera& camera) const;

  const Animation& meshes_;
  SceneStyle style_;
  std::vector<Smooth> smooth_;  // (num_cloths), or empty
  double inset_ = 0;            // of bodies below smooth cloth [m]
};

/// Subdivisions that make a cloth's triangles small in a picture: 2 for the coarsest, 0 for the finest.
int choose_smoothness(const Animation& animation);

enum class Framed { everything, cloth };

/// The camera with the orientation of `like`, at a distance that shows all cloth, and all bodies but planes, in
/// these frames; `like` itself if there is nothing.
Camera frame_scene(FrameSource& source, const std::vector<int>& frames, const Camera& like, double aspect,
                   Framed framed = Framed::everything);

/// Height of a ground below all frames, for scenes without a level plane; empty: there is one, or nothing [m].
std::optional<double> find_ground(FrameSource& source);

}  // namespace weft::engine
