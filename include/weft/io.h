#pragma once
/// Mesh files. Link weft::scene.

#include <array>
#include <string>
#include <vector>

#include "weft/collider.h"
#include "weft/export.h"
#include "weft/mesh.h"

namespace weft {

/// A named part of a mesh. A face may be in several.
struct MeshGroup {
  std::string name = {};
  bool is_object = false;       // of an OBJ file: named by a line o, not by a line g
  std::vector<int> faces = {};  // at least one, from 0, ascending
  bool operator==(const MeshGroup&) const = default;
};

/// The faces of a mesh as a file has them: polygons.
struct MeshFaces {
  std::vector<int> sizes = {};                 // (num_faces) corners of each face, 3 or more
  std::vector<int> corners = {};               // vertices of the first face, then of the second, …
  std::vector<std::array<double, 2>> uv = {};  // (corners) u, v, NaN where there are none; or empty
  std::vector<MeshGroup> groups = {};          // in the order of their first faces
};

struct MeshFromFile {
  TriangleMesh mesh = {};  // vertices in the file's order; quads and polygons cut into triangles
  std::vector<std::string> warnings = {};  // unknown keywords, as sentences
  MeshFaces faces =
      {};  // as in the file; a face of n corners is n - 2 triangles of the mesh, face after face
};

/// Reads a Wavefront OBJ file. Throws InputError ("FILE:LINE: …") for an unusable one.
WEFT_API MeshFromFile read_obj(const std::string& file);

/// Writes an OBJ file, with enough digits to read the same numbers back. Throws InputError if it cannot be
/// written.
WEFT_API void write_obj(const std::string& file, const TriangleMesh& mesh);

/// The same of polygons. Throws InputError also for faces of other vertices, and for lists that do not fit each
/// other. A group's name must be one word, an object's words, without # and without a backslash at the end.
WEFT_API void write_obj(const std::string& file, const std::vector<Vec3>& vertices, const MeshFaces& faces);

/// Reads a PLY (`.ply`) or STL (`.stl`) file; any other is read as Wavefront OBJ. Throws InputError for an
/// unusable one.
WEFT_API MeshFromFile read_mesh(const std::string& file);

/// Writes an OBJ (`.obj`) or PLY (`.ply`) file, from which the same numbers are read back. Throws InputError for
/// another ending, and if it cannot be written.
WEFT_API void write_mesh(const std::string& file, const TriangleMesh& mesh);

/// The same of polygons; errors as of write_obj(). PLY files have no groups.
WEFT_API void write_mesh(const std::string& file, const std::vector<Vec3>& vertices, const MeshFaces& faces);

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
