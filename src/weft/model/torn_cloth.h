#pragma once
/// Cloth that can tear: its models and states, whatever has torn.

#include <memory>
#include <span>
#include <vector>

#include "weft/fabric/elements.h"
#include "weft/model/cloth_model.h"
#include "weft/model/cloth_state.h"

namespace weft::engine {

/// What the models of such cloth are built from. Its topology is a mesh; the fabric has a strength, and membranes.
struct TearingCloth {
  std::shared_ptr<const ClothTopology> whole;
  WarpField warp;  // (num_triangles)
  Fabric fabric;
};

/// The model with these broken edges of the whole mesh (mesh/tear.h), and with the material and gas of the present one.
/// From torn cloth gas has escaped. Throws InputError for an edge that is not there.
std::shared_ptr<const ClothModel> build_torn_model(const TearingCloth& cloth, const ClothModel& present,
                                                   std::span<const int> broken);

/// The state with more particles: of each, the present one that it is or comes from. Sets ClothState::torn to `broken`.
ClothState split_particles(const ClothState& state, std::span<const int> sources, std::vector<int> broken);

}  // namespace weft::engine
