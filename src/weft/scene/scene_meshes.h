#pragma once
/// Private to scene/: cloths and colliders of a scene as public descriptions, their mesh files read.

#include <string>
#include <vector>

#include "weft/cloth.h"
#include "weft/collider.h"
#include "weft/contact/collider.h"
#include "weft/scene/scene_desc.h"

namespace weft::engine {

/// Without pins and stiffened regions. Throws InputError, beginning with the cloth, where its file cannot be
/// read.
ClothDesc describe_cloth(const ClothSceneDesc& desc, bool has_contact, std::vector<std::string>& warnings);

/// Likewise.
ColliderDesc describe_collider(const ColliderSceneDesc& desc, double settle,
                               std::vector<std::string>& warnings);

/// How many of the points are inside the shape. Nothing is inside an open mesh.
int count_inside(const ColliderShape& shape, const std::vector<Vec3>& points);

}  // namespace weft::engine
