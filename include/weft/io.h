#pragma once
/// Mesh files. Link weft::scene.

#include <string>
#include <vector>

#include "weft/export.h"
#include "weft/mesh.h"

namespace weft {

struct MeshFromFile {
  TriangleMesh mesh = {};  // vertices in the file's order; quads and polygons cut into triangles
  std::vector<std::string> warnings = {};  // unknown keywords, in sentences
};

/// Reads a Wavefront OBJ file. Throws InputError ("FILE:LINE: …") for one that cannot be used.
WEFT_API MeshFromFile read_obj(const std::string& file);

/// Writes one with as many digits as it takes to read the same numbers back. Throws InputError if it cannot be
/// written.
WEFT_API void write_obj(const std::string& file, const TriangleMesh& mesh);

}  // namespace weft
