#pragma once
/// Mesh files and point caches by the ending of their name.

#include <filesystem>
#include <memory>
#include <vector>

#include "weft/io/mesh_from_file.h"
#include "weft/io/point_cache_reader.h"

namespace weft::engine {

/// Reads a PLY (`.ply`), STL (`.stl`) or glTF (`.glb`, `.gltf`) file, of the last all meshes of the default
/// scene at the start of its first animation; any other is read as Wavefront OBJ. Upper case counts as lower
/// case.
MeshFromFile read_mesh(const std::filesystem::path& file);

/// The vertices of a file that has the same number of vertices and the same faces as `first`. Throws
/// InputError for others.
std::vector<Vec3> read_vertices(const std::filesystem::path& file, const MeshFromFile& first);

/// A point of a file with this unit, in metres and with y up: `up_is_z` says that the file's z axis is vertical.
Vec3 to_world(const Vec3& p, bool up_is_z, double scale);

/// Writes a Wavefront OBJ (`.obj`) or PLY (`.ply`) file, from which the same numbers are read back. Throws
/// InputError for another ending, and for a file that cannot be written.
void write_mesh(const std::filesystem::path& file, const std::vector<Vec3>& positions,
                const MeshFaces& faces);

/// Opens a PC2 (`.pc2`) or MDD (`.mdd`) point cache. Throws InputError for another ending.
std::unique_ptr<PointCacheReader> open_point_cache(const std::filesystem::path& file);

/// Whether the name ends in `.glb` or `.gltf`.
bool is_gltf(const std::filesystem::path& file);

/// Whether the name has this ending: ".ply". Upper case counts as lower case.
bool has_ending(const std::filesystem::path& file, const char* ending);

}  // namespace weft::engine
