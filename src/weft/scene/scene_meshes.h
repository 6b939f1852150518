#pragma once
/// Private to scene/: cloths and colliders of a scene as public descriptions, with their mesh files loaded.

#include <string>
#include <variant>
#include <vector>

#include "weft/cloth.h"
#include "weft/collider.h"
#include "weft/contact/collider.h"
#include "weft/scene/scene_desc.h"

namespace weft::engine {

/// Without pins, stiffened regions and rest scales. Throws InputError, beginning with the name of the cloth, if its file
/// cannot be read.
ClothDesc describe_cloth(const ClothSceneDesc& desc, bool has_contact, std::vector<std::string>& warnings);

/// Its fabric or springs alone.
std::variant<Fabric, Springs> describe_fabric(const ClothSceneDesc& desc);

/// The same for a collider; `settle` as in SceneDesc [s].
ColliderDesc describe_collider(const ColliderSceneDesc& desc, double settle,
                               std::vector<std::string>& warnings, const OnPreparation& on_preparation = {});

/// Number of points inside the shape, of a mesh inside its closed shells.
int count_inside(const ColliderShape& shape, const std::vector<Vec3>& points);

/// The open shells of a mesh, with their holes filled; no triangles without such shells.
TriangleMesh fill_open_shells(const MeshShape& shape);

/// Number of points inside a closed mesh.
int count_inside(const TriangleMesh& closed, const std::vector<Vec3>& points);

}  // namespace weft::engine
