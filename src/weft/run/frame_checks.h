#pragma once
/// Frames of worlds and of animation files as input for the independent checker.

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "weft/io/animation.h"
#include "weft/verify/checker.h"
#include "weft/world/world.h"

namespace weft::engine {

/// A frame for the checker, with the positions and triangles that it refers to. Movable, not copyable.
struct FrameToCheck {
  FrameToCheck() = default;
  FrameToCheck(FrameToCheck&&) = default;
  FrameToCheck& operator=(FrameToCheck&&) = default;

  verify::Frame frame;
  std::vector<std::vector<Vec3>> positions;  // of cloths, then of meshes among the colliders
  std::vector<std::vector<Triangle>> joined;  // of cloths that files show as triangle soups
  std::shared_ptr<const std::vector<std::vector<Triangle>>> solid;  // of colliders: triangles with an inside
};

/// Frames of a world.
class WorldFrames {
 public:
  explicit WorldFrames(const World& world);

  /// Valid until a cloth or collider is added or removed.
  FrameToCheck now() const { return at(world_.time()); }

  /// The current cloths, with the colliders' positions at another time, within a step [s].
  FrameToCheck at(double time) const;

 private:
  const World& world_;
  std::shared_ptr<const std::vector<std::vector<Triangle>>> solid_;  // see FrameToCheck
};

/// The warning for cloth inside a collider, if it is deeper than `weft verify` tolerates by default.
std::optional<StepWarning> find_inside(const verify::Frame& frame,
                                       const std::optional<verify::Penetration>& deepest);

/// Results of the checker for one frame.
struct FrameFindings {
  int intersections = 0;               // crossing pairs of triangles [1]
  std::vector<Vec3> places;            // centres of the first crossing triangles of cloth [m]
  std::vector<std::string> sentences;  // `cloth "sheet" triangle 7 crosses its triangle 120 …`
  std::optional<double> penetration;   // depth of cloth in colliders; empty: none has an inside [m]
  std::string deepest;                 // `cloth "sheet" triangle 7 in collider "ball"`; "nowhere"
};

/// `num_places`: the most that are listed [1].
FrameFindings check_frame(const Animation& meshes, const AnimationFrame& frame, int num_places);

/// Results of the checker for an animation. Frame 0 is the start.
///
/// Between frames the checker assumes straight paths (verify/passages.h), which real paths are not. A passage
/// is therefore only a possible one: it is reported, and is an offence only if `passages_offend`.
struct AnimationCheck {
  struct Offence {
    int frame = 0;
    std::string what;  // `cloth "sheet" triangle 7 crosses its triangle 120`
  };

  int frames = 0;  // checked
  int frames_with_crossings = 0;
  int intersections = 0;                  // crossing pairs of triangles in the worst frame
  int worst_frame = -1;                   // -1: none
  std::optional<double> penetration_max;  // empty: no collider has an inside [m]
  int deepest_frame = -1;                 // -1: cloth is never inside
  std::string deepest_place;
  int passages = 0;  // pairs of features that may have passed through each other, all frames
  std::vector<Offence> possible_passages;  // the first of them: between the frame and the one before
  std::vector<Offence> offences;           // the first ones
  bool is_clean = true;
};

struct AnimationCheckOptions {
  double tolerance = 1e-4;  // of the depth of cloth in colliders [m]
  int num_offences = 10;    // maximum in each list: offences, possible passages [1]
  bool passages_offend = false;
};

/// Checks every frame.
AnimationCheck check_animation(FrameSource& animation, const AnimationCheckOptions& options = {});

}  // namespace weft::engine
