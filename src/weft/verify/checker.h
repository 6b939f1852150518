#pragma once
/// Independent frame checker: intersections of cloth, and penetration depth in solids.
///
/// It uses only positions and shapes, independent of their history, and shares no code with the contact
/// detection that it checks.

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
  Solid shape;                        // at its pose in this frame
  std::optional<Mat3> rotation = {};  // its orientation, if available: balls do not show it
};

/// One frame. All coordinates are finite.
struct Frame {
  std::vector<NamedCloth> cloths;
  std::vector<NamedCollider> colliders;
  std::vector<std::array<std::string, 2>> non_colliding = {};  // names of bodies that do not collide
};

struct FrameCheck {
  int intersections = 0;               // intersecting pairs: cloth with itself, other cloth and meshes
  std::vector<Crossing> first;         // the first of them; surfaces are the cloths, then the colliders
  std::optional<Penetration> deepest;  // empty if no collider has an inside

  double penetration() const { return deepest ? deepest->depth : 0; }  // [m]
};

/// Lists up to `num_listed` intersections; counts all.
FrameCheck check_frame(const Frame& frame, int num_listed = 8);

/// `cloth "sheet" triangle 7 crosses collider "chair" triangle 120`
std::string describe(const Frame& frame, const Crossing& crossing);

/// A sentence per pair of intersecting surfaces: `cloth "sheet" triangle 7 crosses collider "chair" triangle
/// 120, the first of 14 crossing pairs`.
std::vector<std::string> describe_by_surfaces(const Frame& frame, std::span<const Crossing> crossings);

/// `cloth "sheet" triangle 7 in collider "ball"`; "nowhere" if the depth is 0.
std::string describe(const Frame& frame, const Penetration& deepest);

}  // namespace weft::engine::verify
