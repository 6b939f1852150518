#pragma once
/// Depth pictures: distances to meshes, and which mesh is seen, per pixel. Needs no graphics device.

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "weft/render/camera.h"
#include "weft/render/picture.h"

namespace weft::engine {

/// Rows from the top; values belong to the centres of pixels.
struct DepthPicture {
  std::vector<float> depth;         // (height x width) along the viewing direction; infinity: nothing [m]
  std::vector<std::int32_t> index;  // (height x width) of the mesh, the ground's after the last; -1: nothing
};

/// Triangles are seen from either side, at any distance in front of the eye. `ground`: height of an endless
/// level plane [m].
DepthPicture draw_depths(std::span<const DrawnMesh> meshes, std::optional<double> ground,
                         const Camera& camera, PictureSize size);

}  // namespace weft::engine
