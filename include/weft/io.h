#pragma once
/// Mesh files. Link weft::scene.

#include <string>
#include <vector>

#include "weft/collider.h"
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

struct GltfOptions {
  std::string node = {};  // its meshes and those below it are the body; "": all of the default scene
  std::string clip = {};  // animation; "": the first one, if there is one
  double scale = 1;       // length of the file's unit, > 0 [m]
};

struct BodyFromFile {
  TriangleMesh mesh = {};                  // at the start of the clip; uv as in MeshFromFile
  VertexMotion motion = {};                // by the clip; empty if nothing moves
  std::string clip = {};                   // its name; "": none
  std::vector<std::string> warnings = {};  // ignored parts of the file, as sentences
};

/// Reads the meshes of a glTF 2.0 file (.glb, .gltf) as a body that moves, with its skins, morph targets and
/// nodes. Give `mesh` and `motion` to a ColliderDesc. Throws InputError ("FILE: PLACE: …") for an unusable
/// file, and for a node or clip that is not in it.
WEFT_API BodyFromFile read_gltf(const std::string& file, const GltfOptions& options = {});

}  // namespace weft
