#pragma once
/// From a ColliderDesc to the engine's Collider: meshes are cleaned, and shells that face inwards are turned.

#include <string>
#include <vector>

#include "weft/collider.h"
#include "weft/contact/collider.h"

namespace weft::engine {

struct BuiltCollider {
  Collider collider;
  std::vector<int> vertex_of_source;  // (vertices given) -1: dropped; empty of plain shapes
  std::vector<std::string> warnings;  // flaws of the mesh, in sentences
};

/// Throws InputError, beginning with `who`, for a mesh that cannot be a collider.
BuiltCollider build_collider(const ColliderDesc& desc, const std::string& who);

/// Positions of the vertices given as those of the collider's mesh. Throws InputError for another number.
std::vector<Vec3> select_vertices(const std::vector<weft::Vec3>& given, const BuiltCollider& built);

/// The displacement that takes a collider from where `desc` puts it to a pose, and back.
Pose to_displacement(const weft::Pose& pose, const ColliderDesc& desc, const Vec3& pivot);
weft::Pose from_displacement(const Pose& displacement, const ColliderDesc& desc, const Vec3& pivot);

}  // namespace weft::engine
