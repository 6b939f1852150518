#pragma once
/// Solid shapes that cloth is held off from, each still or moving by prescription.

#include <memory>
#include <string>
#include <variant>

#include "weft/animation/mesh_sequence.h"
#include "weft/animation/rigid_motion.h"
#include "weft/core/shapes.h"
#include "weft/geometry/shape_distance.h"
#include "weft/mesh/triangle_mesh.h"

namespace weft::engine {

/// A triangle mesh as a collider, still or deforming, moved from the mesh's own coordinates: p ↦ rotation p +
/// translation. Closed meshes face outwards; open ones hold cloth off on both sides.
struct MeshShape {
  std::shared_ptr<const TriangleMesh> mesh;  // never null
  Mat3 rotation = Mat3::Identity();
  Vec3 translation = Vec3::Zero();                    // [m]
  std::shared_ptr<const MeshSequence> sequence = {};  // where vertices go, in the mesh's own coordinates;
                                                      // null: they stay. As many vertices as the mesh.
  MeshSequence::Blend blend = {};                     // the moment of the sequence

  /// Where a vertex is now.
  Vec3 vertex(int v) const {
    return rotation * (sequence ? sequence->position(blend, v) : mesh->positions[v]) + translation;
  }
};

using ColliderShape = std::variant<Sphere, Plane, Capsule, OrientedBox, MeshShape>;

struct Collider {
  std::string name;
  ColliderShape shape;
  double friction = 0.3;       // Coulomb's coefficient, >= 0 [1]
  RigidMotion motion;          // turns about pivot()
  double static_friction = 0;  // while nothing slides; less than `friction`: the same [1]
};

/// Signed distance from p to the shape's surface, and the normal there (geometry/shape_distance.h).
SignedDistance signed_distance(const ColliderShape& shape, const Vec3& p);

/// The same of the triangle a, b, c, as far as `reach`.
TriangleSignedDistance signed_distance(const ColliderShape& shape, const Vec3& a, const Vec3& b,
                                       const Vec3& c, double reach = kNoReach);

/// The largest normal · p of all points p of the shape; infinite of planes and meshes [m].
double support(const ColliderShape& shape, const Vec3& normal);

/// The point that the collider turns about: a sphere's or box's centre, a plane's point, the middle of a
/// capsule's axis, a mesh's own origin.
Vec3 pivot(const ColliderShape& shape);

/// The collider's shape where its motion, and its sequence if it has one, have taken it.
ColliderShape shape_at(const Collider& collider, double time);

}  // namespace weft::engine
