#pragma once
/// Converts a ColliderDesc to the engine's Collider: cleans meshes, orients their triangles, and fills holes.

#include <string>
#include <vector>

#include "weft/collider.h"
#include "weft/contact/collider.h"

namespace weft::engine {

struct BuiltCollider {
  Collider collider;
  std::vector<int> vertex_of_source;  // (input vertices) -1: dropped; empty for primitive shapes
  std::vector<std::string> warnings;  // flaws of the mesh, as sentences
};

/// Throws InputError, beginning with `who`, for an invalid collider mesh.
BuiltCollider build_collider(const ColliderDesc& desc, const std::string& who);

/// Positions of the collider's mesh from those of the input vertices. Throws InputError for another number.
std::vector<Vec3> select_vertices(const std::vector<weft::Vec3>& given, const BuiltCollider& built);

/// Converts a pose to the displacement from `desc`'s pose, and back.
Pose to_displacement(const weft::Pose& pose, const ColliderDesc& desc, const Vec3& pivot);
weft::Pose from_displacement(const Pose& displacement, const ColliderDesc& desc, const Vec3& pivot);

}  // namespace weft::engine
