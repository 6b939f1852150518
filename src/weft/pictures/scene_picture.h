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

/// Values of cloth's vertices, shown by colours.
struct ShownValues {
  std::string title;                                    // with the unit, as in "speed [m/s]"
  std::vector<std::vector<std::vector<float>>> frames;  // (num_frames) of (num_cloths) of (num_vertices)
  std::array<double, 2> range = {0, 1};                 // of the first and the last colour
};

/// The least and the largest value in these frames.
std::array<double, 2> find_range(const ShownValues& values, const std::vector<int>& frames);

/// Speeds of all vertices, from differences of frames; 0 in the first one [m/s].
std::vector<std::vector<std::vector<float>>> compute_speeds(const Animation& animation);

struct SceneStyle {
  bool transparent = false;            // no background behind cloth and colliders
  bool has_ground = true;              // false: only if the scene has a level plane
  std::optional<double> ground;        // height if the scene has no level plane; empty: below all frames [m]
  std::vector<Color> cloth_colors;     // of the first cloths, in place of the animation's
  std::vector<SpringsToDraw> springs;  // of cloths that are drawn as springs
  std::optional<int> smooth;           // Loop subdivisions of cloth, with hems; empty: its triangles, without
  std::optional<ShownValues> values;   // in place of the cloths' colours
};

/// Draws the frames of an animation, which must outlive this. Cloth of a preset's fabric has its weave, other
/// cloth with fabric coordinates has checks; level planes are drawn as endless ground.
class ScenePictures {
 public:
  explicit ScenePictures(const Animation& animation, SceneStyle style = {});

  /// Frame 0 is the start.
  Picture at(int frame, const Camera& camera) const;

  /// What each mesh of at() shows, then the ground. A cloth is its index, a body its index plus the number of
  /// cloths; -1: the ground is no body.
  std::vector<int> shown() const;

 private:
  /// Topology of a cloth that is drawn smooth.
  struct Smooth {
    LoopSubdivision subdivision;
    Hem hem;
    std::vector<float> fabric_coordinates;
  };

  const SpringsToDraw* find_springs(int cloth) const;
  DrawnMesh draw_cloth(int cloth, int frame, const Camera& camera) const;

  const Animation& animation_;
  SceneStyle style_;
  std::vector<Smooth> smooth_;  // (num_cloths), or empty
  double inset_ = 0;            // of bodies below smooth cloth [m]
};

/// Subdivisions that make a cloth's triangles small in a picture: 2 for the coarsest, 0 for the finest.
int choose_smoothness(const Animation& animation);

enum class Framed { everything, cloth };

/// The camera with the orientation of `like`, at a distance that shows all cloth, and all bodies but planes, in
/// these frames; `like` itself if there is nothing.
Camera frame_scene(const Animation& animation, const std::vector<int>& frames, const Camera& like,
                   double aspect, Framed framed = Framed::everything);

int num_frames(const Animation& animation);

}  // namespace weft::engine
