#pragma once
/// Fabrics by name, each number with its source.

#include <string>
#include <string_view>
#include <vector>

#include "weft/fabric/fabric.h"

namespace weft {

/// Where a preset's numbers come from.
struct FabricSources {
  std::string density, stretch, shear, bending, damping, thickness, friction;
};

struct FabricPreset {
  std::string name;   // "cotton_shirting"
  std::string title;  // one line: what it is
  Fabric fabric;
  FabricSources sources;
};

/// Five everyday fabrics, then the ten measured by H. Wang, J. O'Brien and R. Ramamoorthi, Data-Driven
/// Elastic Models for Cloth, ACM Transactions on Graphics 30(4), 2011.
const std::vector<FabricPreset>& fabric_presets();

/// The preset of this name; letters may be small or capital, "-" and " " stand for "_". Throws InputError
/// with the nearest name, or all of them.
const FabricPreset& find_fabric(std::string_view name);

}  // namespace weft
