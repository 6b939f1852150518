#pragma once
/// The independent checker of frames: does cloth cross anything, and how deep is it inside of anything?
///
/// It looks at positions and shapes alone, knows nothing of how they came about, and shares no code with the
/// detection of contact that it checks.

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "weft/verify/crossings.h"
#include "weft/verify/penetration.h"

namespace weft::engine::verify {

struct NamedCloth {
  std::string name;
  std::span<const Vec3> positions;  // [m]
  std::span<const Triangle> triangles;
};

struct NamedCollider {
  std::string name;
  Solid shape;                        // where it is in this frame
  std::optional<Mat3> rotation = {};  // how it is turned, where that is known: balls do not show it
};

/// One moment. All coordinates are finite.
struct Frame {
  std::vector<NamedCloth> cloths;
  std::vector<NamedCollider> colliders;
  std::vector<std::array<std::string, 2>> passing = {};  // names of things that may go through each other
};

struct FrameCheck {
  int intersections = 0;               // crossing pairs: cloth with itself, other cloth and meshes
  std::vector<Crossing> first;         // the first few of them; surfaces are the cloths, then the colliders
  std::optional<Penetration> deepest;  // empty if no collider has an inside

  double penetration() const { return deepest ? deepest->depth : 0; }  // [m]
};

/// Lists up to `num_listed` crossings; counts all.
FrameCheck check_frame(const Frame& frame, int num_listed = 8);

/// `cloth "sheet" triangle 7 crosses collider "chair" triangle 120`
std::string describe(const Frame& frame, const Crossing& crossing);

/// A sentence for every two surfaces that cross: `cloth "sheet" triangle 7 crosses collider "chair" triangle
/// 120, the first of 14 crossing pairs`.
std::vector<std::string> describe_by_surfaces(const Frame& frame, std::span<const Crossing> crossings);

/// `cloth "sheet" triangle 7 in collider "ball"`; "nowhere" if the depth is 0.
std::string describe(const Frame& frame, const Penetration& deepest);

}  // namespace weft::engine::verify
