#pragma once
/// Reader for STL, text and binary.

#include <filesystem>
#include <string>
#include <string_view>

#include "weft/io/mesh_from_file.h"

namespace weft::engine {

/// Reads the facets of an STL file. A file that begins with "solid" is text, unless its size is that of a
/// binary file: 84 + 50 n bytes, n the count at byte 80. Coordinates are floats. Corners with equal coordinates
/// are one vertex; vertices have the order of the facets. Facets without area are dropped, with a warning that
/// counts them. Normals, names and attributes are ignored.
///
/// Throws InputError ("FILE:LINE: mistake" in text, "FILE: byte N: mistake" in binary files) for
/// - a file that cannot be read, or has no facets with area,
/// - a coordinate that is not a finite float,
/// - a binary file with fewer facets than its count, and text that ends before endsolid,
/// - words in another order than the format's, and a facet without exactly three vertices.
MeshFromFile read_stl(const std::filesystem::path& file);

/// The same from the file's bytes; `name` is the file name in messages.
MeshFromFile parse_stl(std::string_view bytes, const std::string& name);

}  // namespace weft::engine
