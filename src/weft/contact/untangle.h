#pragma once
/// Repair of cloth that starts intersected, before the first step.
///
///              │ B           Where edges pierce triangles, each of two surfaces is cut into the parts on
///              │             either side of the other. The lightest of the four parts moves over to its
///     A1 ──────┼────── A2    own surface's other part, the row along the cut first; the stretch this causes
///              │             pulls the next row after it. Where cloth intersects itself, the two curves
///              │             cut it in the same way.
///
/// Where pins hold all parts, the cut is shortened at its ends (Volino and Magnenat-Thalmann 2006).
///
/// Particles inside a solid leave it by the shortest way, or, where neighbours disagree on that, all in one
/// direction. Of cloths in different layers the higher one moves outwards, away from the nearest solid, where it
/// is under the lower one. This repairs positions and is not a motion: only here may cloth pass through cloth.

#include <functional>
#include <vector>

#include "weft/contact/collider.h"
#include "weft/contact/surface.h"

namespace weft::engine {

/// Repair input.
struct RepairInput {
  const Surface* surface = nullptr;  // cloth first, then the meshes of colliders
  std::vector<int> first_vertex;     // of each cloth, then of each mesh, and the end of the last one
  int num_cloth_vertices = 0, num_cloth_triangles = 0;
  const std::vector<double>* inverse_mass = nullptr;    // (num_vertices) 0 where fixed [1/kg]
  const std::vector<double>* half_thickness = nullptr;  // (num_vertices) [m]
  std::vector<int> layers;                              // (cloths) see ClothDesc::layer
  std::vector<Vec3> rest;                               // (num_cloth_vertices) [m]
  std::vector<Vec3> origins;                            // (num_cloth_vertices) of float positions [m]
  struct Solid {
    int collider = 0;                      // number
    ColliderShape shape;                   // at its pose
    int first_vertex = 0, end_vertex = 0;  // of a mesh
    std::vector<Triangle> triangles = {};  // of its closed shells
  };
  std::vector<Solid> solids;  // primitive shapes, and meshes with closed shells
  // Collision filter, true: the bodies do not collide. Arguments: two vertices; or a cloth vertex and a
  // collider. Never empty.
  std::function<bool(int, int)> non_colliding, non_colliding_solid;
};

/// Edge–face intersection: an edge that pierces a triangle.
struct EdgeFaceIntersection {
  int edge = 0, triangle = 0;
  bool operator==(const EdgeFaceIntersection&) const = default;
  auto operator<=>(const EdgeFaceIntersection&) const = default;
};

/// Up to this depth cloth lies on a solid [m].
constexpr double kTouches = 1e-6;

/// A particle inside a solid.
struct Inside {
  int vertex = 0, collider = 0;
  double depth = 0;  // [m]
};

/// A cloth triangle in a primitive shape, with all corners outside.
struct InsideTriangle {
  int triangle = 0, collider = 0;
};

/// A particle between a solid and cloth of a lower layer, which should be outside of that.
struct Beneath {
  int vertex = 0, triangle = 0;  // the triangle above it
  double depth = 0;              // way to it, along `out` [m]
  Vec3 out = Vec3::Zero();       // away from the nearest solid, unit length
};

struct Intersections {
  std::vector<EdgeFaceIntersection> edge_face;
  std::vector<Inside> inside;
  std::vector<InsideTriangle> inside_triangles;
  std::vector<Beneath> beneath;

  bool empty() const { return size() == 0; }
  std::size_t size() const { return num_crossing() + beneath.size(); }
  std::size_t num_crossing() const { return edge_face.size() + inside.size() + inside_triangles.size(); }

  /// Fewer intersections, or as many and fewer particles in the wrong order.
  bool is_better_than(const Intersections& other) const {
    if (num_crossing() != other.num_crossing()) return num_crossing() < other.num_crossing();
    return beneath.size() < other.beneath.size();
  }
};

/// Finds the intersections with vertices at `positions` (num_vertices).
Intersections find_intersections(const RepairInput& input, const std::vector<Vec3>& positions);

struct UntangleResult {
  Intersections before, after;
  int rounds = 0;
};

/// Moves cloth positions (num_vertices) until no intersections are left, as far as possible. Takes seconds
/// for thousands of particles; a no-op where all is well. Calls on_round with the number of each round.
UntangleResult untangle(const RepairInput& input, std::vector<Vec3>& positions,
                        const std::function<void(int round)>& on_round = {});

}  // namespace weft::engine
