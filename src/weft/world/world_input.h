#pragma once
/// Validation of a World's input. Each function throws InputError.

#include <string>
#include <vector>

#include "weft/contact/collider.h"
#include "weft/error.h"
#include "weft/forces/wind.h"
#include "weft/model/cloth_model.h"
#include "weft/solver.h"

namespace weft::engine {

inline void require(bool condition, const std::string& message) {
  if (!condition) throw InputError(message);
}

/// `cloth` is its name.
void require_valid(const ClothMaterial& material, const std::string& cloth);
void require_valid(const ClothTopology& topology, const std::string& cloth);
void require_valid(const Collider& collider);

/// The message begins with `who`, of the form "collider "ball", moved: ".
void require_valid(const Pose& pose, const std::string& who);

/// Vectors that floats can hold. The message begins with `what`.
void require_finite(const std::vector<Vec3>& values, const std::string& what);

void require_valid(const IntegratorSettings& settings);

/// Valid wind that the integrator supports.
void require_valid(const Wind& wind, const std::string& integrator);

/// An integrator that supports elements.
void require_elements_supported(const std::string& integrator, const ClothElements& elements,
                                const std::string& cloth);
void require_seams_supported(const std::string& integrator, const Seams& seams, const std::string& cloth);
void require_pressure_supported(const std::string& integrator, const std::string& cloth);

/// For gas inside the cloth: every edge joins two triangles that face the same way.
void require_closed(const TriangleMesh& mesh, const std::string& cloth);

}  // namespace weft::engine
