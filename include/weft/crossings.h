#pragma once
/// Intersections of surfaces, by the independent checker of runs. Link weft::scene.

#include <vector>

#include "weft/export.h"
#include "weft/mesh.h"
#include "weft/vec.h"

namespace weft {

/// A triangle mesh in one frame.
struct Surface {
  std::vector<Vec3> positions = {};  // [m]
  std::vector<Triangle> triangles = {};
  bool is_cloth = true;  // other surfaces may cross themselves and each other
};

/// Two triangles that cross: indices of surfaces, and of their triangles. The first belongs to a cloth.
struct Crossing {
  int surface = 0, triangle = 0;
  int other_surface = 0, other_triangle = 0;

  bool operator==(const Crossing&) const = default;
};

/// All pairs of triangles that cross, in order; exact arithmetic. Surfaces that only touch do not cross. Shares no code
/// with the contact of steps. Throws InputError for a triangle with a vertex that is not there, and for positions that
/// are not finite floats.
WEFT_API std::vector<Crossing> find_crossings(const std::vector<Surface>& surfaces);

}  // namespace weft
