#pragma once
/// Mesh files. Link weft::scene.

#include <string>
#include <vector>

#include "weft/export.h"
#include "weft/mesh.h"

namespace weft {

struct MeshFromFile {
  TriangleMesh mesh = {};  // vertices in the file's order; quads and polygons cut into triangles
  std::vector<std::string> warnings = {};  // unknown keywords, as sentences
};

/// Reads a Wavefront OBJ file. Throws InputError ("FILE:LINE: …") for an unusable one.
WEFT_API MeshFromFile read_obj(const std::string& file);

/// Writes an OBJ file, with enough digits to read the same numbers back. Throws InputError if it cannot be
/// written.
WEFT_API void write_obj(const std::string& file, const TriangleMesh& mesh);

}  // namespace weft
