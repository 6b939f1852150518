#pragma once
/// Private to scene/: mesh files of cloths and colliders, loaded and judged.

#include <string>
#include <vector>

#include "weft/contact/collider.h"
#include "weft/mesh/clean.h"
#include "weft/scene/scene_desc.h"

namespace weft {

enum class MeshUse { cloth, collider };  // what a mesh is judged as

/// Reads and cleans a mesh file; `uv` becomes its triangles' texture coordinates, empty if it has none.
/// `owner` ("cloth \"shirt\"") begins every warning, note and error. Throws InputError where the mesh cannot
/// be used.
CleanMesh load_mesh(const MeshFile& source, MeshUse use, const std::string& owner,
                    std::vector<std::string>& warnings, std::vector<CornerUv>* uv = nullptr);

/// The collider, its mesh loaded if it has one: turned right side out if it faces inwards. Everything odd
/// about the mesh is told. Throws InputError as load_mesh.
Collider make_collider(const ColliderSceneDesc& desc, std::vector<std::string>& warnings);

/// How many of the points are inside the shape. Nothing is inside an open mesh.
int count_inside(const ColliderShape& shape, const std::vector<Vec3>& points);

}  // namespace weft
