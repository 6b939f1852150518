#pragma once
/// Reader and writer for Wavefront OBJ, robust against common deviations.

#include <filesystem>
#include <string>
#include <vector>

#include "weft/io/mesh_from_file.h"

namespace weft::engine {

/// Reads the vertices and faces of an OBJ file. Quads and polygons, concave ones too, are triangulated.
/// Vertices keep the file's order and are never split or merged, because texture coordinates are stored by
/// corner. Groups (`g`, several names on a line) and objects (`o`) are kept, those without faces left out, and
/// lines (`l`), as pairs of vertices.
/// Normals, materials, texture maps, points and unknown keywords are ignored.
///
/// Throws InputError ("FILE:LINE: mistake, expected value") for
/// - a file that cannot be read, or has no vertices or no faces,
/// - a coordinate that is not a finite number,
/// - a face with fewer than three vertices or with an index that does not exist.
MeshFromFile read_obj(const std::filesystem::path& file);

/// The same from text; `name` is the file name in messages.
MeshFromFile parse_obj(const std::string& text, const std::string& name);

/// The vertices of a file that has `faces`, which are not read again. Throws InputError for other faces.
std::vector<Vec3> read_obj_vertices(const std::filesystem::path& file, const MeshFaces& faces);

struct ObjObject {
  std::string name;
  TriangleMesh mesh;
};

/// Writes vertices and faces, with enough digits to read the same doubles back: polygons, texture coordinates
/// (each once), groups and objects. A group's name must be one word, an object's words, without # and without a
/// backslash at the end. Throws InputError for others, and if the file cannot be written.
void write_obj(const std::filesystem::path& file, const std::vector<Vec3>& positions, const MeshFaces& faces);

/// What write_obj() writes.
std::string obj_text(const std::vector<Vec3>& positions, const MeshFaces& faces);

/// The same of triangles. `uv` as in MeshFromFile.
void write_obj(const std::filesystem::path& file, const TriangleMesh& mesh,
               const std::vector<CornerUv>& uv = {});

/// The same for several meshes, each as a separate object.
void write_obj(const std::filesystem::path& file, const std::vector<ObjObject>& objects);

}  // namespace weft::engine
