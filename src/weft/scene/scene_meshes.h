#pragma once
/// Private to scene/: cloths and colliders of a scene as public descriptions, with their mesh files loaded.

#include <string>
#include <vector>

#include "weft/cloth.h"
#include "weft/collider.h"
#include "weft/contact/collider.h"
#include "weft/io/mesh_from_file.h"
#include "weft/scene/scene_desc.h"

namespace weft::engine {

/// Without pins and stiffened regions. Throws InputError, beginning with the name of the cloth, if its file
/// cannot be read.
ClothDesc describe_cloth(const ClothSceneDesc& desc, bool has_contact, std::vector<std::string>& warnings);

/// Faces of the mesh as its file has them; of a mesh in memory its triangles, of a grid its cells. Their
/// vertices are those of World::vertex_positions. Throws InputError like describe_cloth().
MeshFaces read_faces(const ClothSceneDesc& desc);

/// The vertices of the faces of a group, ascending. Throws InputError, beginning with the name of the cloth,
/// for a name that its mesh has not.
std::vector<int> find_group(const ClothSceneDesc& desc, const std::string& name);

/// describe_cloth() for a collider; `settle` as in SceneDesc [s].
ColliderDesc describe_collider(const ColliderSceneDesc& desc, double settle,
                               std::vector<std::string>& warnings);

/// Number of points inside the shape; 0 for an open mesh.
int count_inside(const ColliderShape& shape, const std::vector<Vec3>& points);

}  // namespace weft::engine
