#pragma once
/// Converts a ClothDesc to the engine's topology, material and elements: mesh cleaning, warp direction,
/// elements or springs, thickness.

#include <memory>
#include <string>
#include <vector>

#include "weft/cloth.h"
#include "weft/model/cloth_model.h"

namespace weft::engine {

/// Rest shape of a cloth.
struct RestShape {
  std::shared_ptr<const ClothTopology> topology;
  std::vector<CornerUv> uv;  // of the topology's triangles; empty: none
};

/// Cleans and sews a mesh as `desc` says; `notes` receives the report. Throws InputError, beginning with
/// `who`, for an invalid cloth mesh.
RestShape build_rest_shape(const ClothDesc& desc, const std::string& who, ClothNotes& notes);

struct ClothSubstance {
  ClothMaterial material;
  std::shared_ptr<const ClothElements> elements;  // null: springs only
};

/// Throws InputError, beginning with `who`, for an invalid fabric.
ClothSubstance build_substance(const ClothDesc& desc, const RestShape& rest, const std::string& who,
                               std::vector<std::string>& warnings);

/// Multiplies the factors of springs with both ends among the particles; an empty list counts as all 1.
void multiply_spring_factors(const ClothTopology& topology, const std::vector<int>& particles, double factor,
                             std::vector<double>& factors);

}  // namespace weft::engine
