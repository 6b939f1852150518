#pragma once
/// Private to world/: validation of a World's input. Each function throws InputError.

#include <string>

#include "weft/contact/collider.h"
#include "weft/error.h"
#include "weft/forces/wind.h"
#include "weft/model/cloth_model.h"

namespace weft::engine {

inline void require(bool condition, const std::string& message) {
  if (!condition) throw InputError(message);
}

/// `cloth` is its name.
void require_valid(const ClothMaterial& material, const std::string& cloth);
void require_valid(const ClothTopology& topology, const std::string& cloth);
void require_valid(const Collider& collider);
void require_valid(const Pose& pose, const std::string& owner);

/// Valid wind that the integrator supports.
void require_valid(const Wind& wind, const std::string& integrator);

/// An integrator that supports elements.
void require_elements_supported(const std::string& integrator, const std::string& cloth);

}  // namespace weft::engine
