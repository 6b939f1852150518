#pragma once
/// Cloth that starts crossed, set apart before the first step.
///
///              │ B           Where edges run through triangles each of two surfaces is cut into what is on
///              │             the one side of the other and what is on the other side. The lightest of the
///     A1 ──────┼────── A2    four parts goes over to its own surface's other part, the row along the cut
///              │             first; what that stretches pulls the next row after it. Of cloth that crosses
///              │             itself the two curves cut it in the same way.
///
/// Where pins hold all parts the cut itself is made shorter at its ends (Volino and Magnenat-Thalmann 2006).
///
/// What is inside a solid goes out by the nearest way, or, where neighbours disagree on that, all in one
/// direction. This is a repair of places, not a motion: cloth may pass through cloth here, as nowhere else.

#include <functional>
#include <vector>

#include "weft/contact/collider.h"
#include "weft/contact/surface.h"

namespace weft::engine {

/// What is to be set apart.
struct Tangle {
  const Surface* surface = nullptr;  // cloth first, then the meshes of colliders
  std::vector<int> first_vertex;     // of each cloth, then of each mesh, and the end of the last one
  int num_cloth_vertices = 0, num_cloth_triangles = 0;
  const std::vector<double>* inverse_mass = nullptr;    // (num_vertices) 0 where it must stay [1/kg]
  const std::vector<double>* half_thickness = nullptr;  // (num_vertices) [m]
  std::vector<Vec3> rest;                               // (num_cloth_vertices) [m]
  std::vector<Vec3> origins;                            // (num_cloth_vertices) of places stored as floats [m]
  struct Solid {
    int collider = 0;                      // number
    ColliderShape shape;                   // where it is
    int first_vertex = 0, end_vertex = 0;  // of a closed mesh
  };
  std::vector<Solid> solids;  // plain shapes and closed meshes
  // Whether things go through each other: those of two vertices; that of a vertex of cloth, and a collider.
  // Never empty.
  std::function<bool(int, int)> pass, pass_solid;
};

/// An edge that runs through a triangle.
struct Pierced {
  int edge = 0, triangle = 0;
  bool operator==(const Pierced&) const = default;
  auto operator<=>(const Pierced&) const = default;
};

/// A particle inside a solid.
struct Inside {
  int vertex = 0, collider = 0;
  double depth = 0;  // [m]
};

struct Knots {
  std::vector<Pierced> pierced;
  std::vector<Inside> inside;

  bool empty() const { return pierced.empty() && inside.empty(); }
  std::size_t size() const { return pierced.size() + inside.size(); }
};

/// What crosses where vertices are at `positions` (num_vertices).
Knots find_knots(const Tangle& tangle, const std::vector<Vec3>& positions);

struct UntangleResult {
  Knots before, after;
  int rounds = 0;
};

/// Moves places of cloth (num_vertices) until nothing crosses, as far as that is possible. Takes seconds for
/// thousands of particles; does nothing where nothing crosses.
UntangleResult untangle(const Tangle& tangle, std::vector<Vec3>& positions);

}  // namespace weft::engine
