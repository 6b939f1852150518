#pragma once
/// Picking: meshes under the mouse.

#include <optional>
#include <span>

#include "weft/render/camera.h"
#include "weft/render/picture.h"

namespace weft::engine {

struct Hit {
  int mesh = 0, triangle = 0;   // indices
  Vec3 weights = Vec3::Zero();  // of the triangle's corners, sum 1 [1]
  Vec3 point = Vec3::Zero();    // intersection with the ray [m]
  double distance = 0;          // from the ray's origin [m]
};

/// The nearest triangle on the ray, from either side; ties go to the first.
std::optional<Hit> find_first_hit(std::span<const DrawnMesh> meshes, const Ray& ray);

}  // namespace weft::engine
