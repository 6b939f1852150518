#pragma once
/// Wavefront OBJ in, as people have it, and out.

#include <filesystem>
#include <string>
#include <vector>

#include "weft/mesh/triangle_mesh.h"

namespace weft::engine {

struct ObjMesh {
  TriangleMesh mesh;         // all objects and groups of the file together; vertices as in the file
  std::vector<CornerUv> uv;  // of the triangles' corners, not a number where the file gives none;
                             // (num_triangles), or empty if it gives none at all
  std::vector<std::string>
      warnings;  // unknown keywords that were passed over, one sentence each, with counts
};

/// Reads the vertices and faces of an OBJ file. Quads and polygons, concave ones too, are cut into triangles;
/// vertices keep the file's order and are never split or merged, for texture coordinates are kept by corner;
/// normals, materials, texture maps, lines, points and unknown keywords are passed over. Throws InputError
/// ("FILE:LINE: what is wrong, what was expected") for a file that cannot be read, a coordinate that is not a
/// finite number, a face with fewer than three vertices or with an index that does not exist, and a file
/// without vertices or without faces.
ObjMesh read_obj(const std::filesystem::path& file);

/// The same from text; `name` stands for the file in messages.
ObjMesh parse_obj(const std::string& text, const std::string& name);

struct ObjObject {
  std::string name;  // one word
  TriangleMesh mesh;
};

/// Writes vertices and triangles, with as many digits as it takes to read the same doubles back.
/// `uv` as in ObjMesh. Throws InputError if the file cannot be written.
void write_obj(const std::filesystem::path& file, const TriangleMesh& mesh,
               const std::vector<CornerUv>& uv = {});

/// The same for several meshes, each as an object of its own.
void write_obj(const std::filesystem::path& file, const std::vector<ObjObject>& objects);

}  // namespace weft::engine
