#pragma once
/// The common numbering of vertices and triangles: those of cloths in their order, then those of collider meshes.

#include <algorithm>
#include <memory>
#include <span>
#include <utility>
#include <vector>

#include "weft/contact/collider.h"
#include "weft/contact/constraint.h"
#include "weft/contact/surface.h"
#include "weft/model/cloth_model.h"
#include "weft/model/cloth_state.h"

namespace weft::engine {

/// A cloth as contact handling sees it during a step.
struct ContactCloth {
  const ClothModel* model = nullptr;
  ClothState* state = nullptr;
  const std::vector<char>* is_pinned = nullptr;  // (num_particles)
  double pressure = 0;                           // on its surface, from inside, >= 0 [Pa]
  int layer = 0;                                 // see ClothDesc::layer
};

/// A vertex or a triangle of a body; exactly one of cloth and collider is not -1.
struct BodyPlace {
  int cloth = -1, collider = -1, index = 0;
};

/// The mesh of a collider.
struct ColliderMesh {
  int collider = 0;                             // number
  int first_vertex = 0, end_vertex = 0;         // under the common numbering
  int first_triangle = 0, end_triangle = 0;     // likewise
  std::vector<Triangle> solid;                  // of closed shells, under the common numbering
  std::vector<char> is_solid;                   // (vertices) whether on a closed shell
  Vec3 min = Vec3::Zero(), max = Vec3::Zero();  // of its vertices, in its own coordinates [m]

  bool has_inside_at(int vertex) const { return is_solid[vertex - first_vertex] != 0; }

  /// Bounds of its vertices at the shape's pose; infinite for a deforming mesh.
  std::pair<Vec3, Vec3> bounds_at(const MeshShape& shape) const;
};

/// Lengths of a cloth's edges at rest.
struct RestEdges {
  double mean = 0, longest = 0;  // [m]
};

struct Numbering {
  std::vector<std::shared_ptr<const ClothTopology>> topologies;  // (cloths)
  std::vector<std::shared_ptr<const TriangleMesh>> meshes;       // (bodies)
  std::vector<int> first_vertex;                                 // of each cloth, and the end of the last one
  std::vector<ColliderMesh> bodies;
  std::vector<RestEdges> rest_edges;   // (cloths)
  std::vector<double> rest_circle_sq;  // (cloth vertices) squared radius of the largest of the minimal
                                       // enclosing circles of the triangles there, at rest [m²]

  int num_cloths() const { return static_cast<int>(topologies.size()); }
  int num_cloth_vertices() const { return first_vertex.back(); }
  bool is_of_cloth(int vertex) const { return vertex < first_vertex.back(); }
  int cloth_of(int vertex) const { return mesh_of(first_vertex, vertex); }
  const RestEdges& rest_edges_at(int vertex) const { return rest_edges[cloth_of(vertex)]; }

  const ColliderMesh& body_of(int vertex) const;
  const ColliderMesh& body_with(int collider) const;
  bool is_on_solid(int vertex) const { return !is_of_cloth(vertex) && body_of(vertex).has_inside_at(vertex); }

  /// Whether one side of a pair is a collider mesh.
  bool is_on_body(const Constraint& c) const { return !is_of_cloth(std::max(c.vertex[0], c.vertex[3])); }

  BodyPlace place_of(int vertex) const;
  BodyPlace place_of_triangle(const Surface& surface, int triangle) const;

  /// Whether the cloths and meshes are those that are numbered.
  bool holds_for(std::span<const ContactCloth> cloths, const std::vector<Collider>& colliders) const;
};

/// Numbers all bodies. `surface` receives their triangles, `rest` the rest positions of cloth vertices [m].
Numbering number_bodies(std::span<const ContactCloth> cloths, const std::vector<Collider>& colliders,
                        Surface& surface, std::vector<Vec3>& rest);

}  // namespace weft::engine
