#include "weft/model/fabric_springs.h"

namespace weft::engine {

void set_fabric_springs(const GridSprings& springs, const Fabric& fabric, ClothMaterial& material) {
  material.structural = springs.along_x;
  material.structural_z = springs.along_z;
  material.shear = springs.diagonal;
  material.damping_time = fabric.damping;
}

void set_fabric_springs(const MeshSprings& springs, const ClothTopology& topology, const Fabric& fabric,
                        ClothMaterial& material) {
  material.structural = 1;
  material.spring_factors = springs.stiffness;  // the edges are a mesh's first springs
  material.spring_factors.resize(topology.springs.size(), 0.0);
  material.damping_time = fabric.damping;
}

}  // namespace weft::engine
