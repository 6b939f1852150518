#pragma once
/// Reader and writer for PLY 1.0: text and binary files of either byte order.

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "weft/io/mesh_from_file.h"

namespace weft::engine {

/// Reads the vertices and faces of a PLY file. Quads and polygons, concave ones too, are triangulated.
/// Vertices keep the file's order. Read are, whatever their scalar type and position in the file:
/// - `vertex`: x, y, z, and texture coordinates s, t or u, v or texture_u, texture_v;
/// - `face`: the list vertex_indices or vertex_index, and the list texcoord of u, v for each corner, which
///   replaces the vertices' texture coordinates where it is not empty.
/// Other elements and properties are ignored. Numbers in text keep all their digits. Texture coordinates that
/// are not finite count as missing.
///
/// Throws InputError ("FILE:LINE: mistake" in the header and in text, "FILE: byte N: mistake" in binary data)
/// for
/// - a file that cannot be read, or has no vertices or no faces,
/// - a header that does not follow the format, or defines a name twice,
/// - data that do not have the header's counts and types,
/// - a coordinate that is not a finite number,
/// - a face with fewer than three vertices or with an index that does not exist.
MeshFromFile read_ply(const std::filesystem::path& file);

/// The same from the file's bytes; `name` is the file name in messages.
MeshFromFile parse_ply(std::string_view bytes, const std::string& name);

/// Type of the coordinates in a written file. `doubles` are read back as the same bits.
enum class PlyNumbers { doubles, floats };

/// Writes vertices and polygons as little-endian binary. Where every vertex has one pair of texture
/// coordinates, they are its properties s and t, else the faces' list texcoord. Groups are not written: PLY has
/// none. Throws InputError if the file cannot be written.
void write_ply(const std::filesystem::path& file, const std::vector<Vec3>& positions, const MeshFaces& faces,
               PlyNumbers numbers = PlyNumbers::doubles);

}  // namespace weft::engine
