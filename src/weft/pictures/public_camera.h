#pragma once
/// Private to pictures/: conversions of the public camera.

#include "weft/pictures.h"
#include "weft/render/camera.h"

namespace weft::engine {

/// Throws InputError for an invalid camera.
Camera to_engine(const weft::Camera& camera);

/// With the size of `like`.
weft::Camera from_engine(const Camera& camera, const weft::Camera& like);

inline PictureSize size_of(const weft::Camera& camera) { return {camera.width, camera.height}; }

}  // namespace weft::engine
