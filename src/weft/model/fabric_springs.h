#pragma once
/// Springs that replace a fabric's membrane, as a cloth's material.

#include "weft/fabric/grid_springs.h"
#include "weft/fabric/mesh_springs.h"
#include "weft/model/cloth_model.h"

namespace weft::engine {

/// Sets the members of `material` that these springs and the fabric's damping determine; the others stay.
void set_fabric_springs(const GridSprings& springs, const Fabric& fabric, ClothMaterial& material);

/// For a cloth of this topology, built by build_mesh_topology() from the springs' mesh.
void set_fabric_springs(const MeshSprings& springs, const ClothTopology& topology, const Fabric& fabric,
                        ClothMaterial& material);

}  // namespace weft::engine
