#pragma once
/// Sources of the GPU programs (GLSL 3.30).

#include <string>

#include "weft/render/device.h"

namespace weft::engine {

struct ShaderSource {
  std::string vertex, fragment;
};

ShaderSource shader_source(Program program);

}  // namespace weft::engine
