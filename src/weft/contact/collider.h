#pragma once
/// Colliders: solid shapes that are static or move by prescription.

#include <memory>
#include <string>
#include <variant>

#include "weft/animation/rigid_motion.h"
#include "weft/animation/vertex_source.h"
#include "weft/core/shapes.h"
#include "weft/geometry/shape_distance.h"
#include "weft/mesh/triangle_mesh.h"

namespace weft::engine {

/// A triangle mesh as a collider, static or deforming, placed from mesh coordinates: p ↦ rotation p +
/// translation. Closed shells face outwards; open ones collide on both sides.
struct MeshShape {
  std::shared_ptr<const TriangleMesh> mesh;  // never null
  Mat3 rotation = Mat3::Identity();
  Vec3 translation = Vec3::Zero();                  // [m]
  std::shared_ptr<const VertexSource> source = {};  // vertex animation in mesh coordinates; null: static.
                                                    // As many vertices as the mesh.
  std::shared_ptr<const std::vector<Vec3>> deformed = {};  // vertices of the source now; null: the mesh's

  /// Current vertices in mesh coordinates (num_vertices) [m].
  const std::vector<Vec3>& vertices() const { return deformed ? *deformed : mesh->positions; }

  /// Current position of a vertex in the world [m].
  Vec3 vertex(int v) const { return rotation * vertices()[v] + translation; }

  /// A copy with the vertices at `time`.
  MeshShape at(double time) const;
};

using ColliderShape = std::variant<Sphere, Plane, Capsule, OrientedBox, MeshShape>;

struct Collider {
  std::string name;
  ColliderShape shape;
  double friction = 0.3;       // Coulomb's coefficient, >= 0 [1]
  RigidMotion motion;          // rotates about pivot()
  double static_friction = 0;  // of sticking contacts; below `friction`: equal to it [1]
};

/// Signed distance from p to the shape's surface, and the normal there (see geometry/shape_distance.h).
SignedDistance signed_distance(const ColliderShape& shape, const Vec3& p);

/// Signed distance of the triangle a, b, c, searched up to `reach`.
TriangleSignedDistance signed_distance(const ColliderShape& shape, const Vec3& a, const Vec3& b,
                                       const Vec3& c, double reach = kNoReach);

/// Support function: the largest normal · p of all points p of the shape; infinite for planes and meshes [m].
double support(const ColliderShape& shape, const Vec3& normal);

/// The centre of rotation: a sphere's or box's centre, a plane's point, the middle of a capsule's axis, a
/// mesh's own origin.
Vec3 pivot(const ColliderShape& shape);

/// The shape at `time`, moved by the collider's motion and its source of vertices, if any.
ColliderShape shape_at(const Collider& collider, double time);

}  // namespace weft::engine
