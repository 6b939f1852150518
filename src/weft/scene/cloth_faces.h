#pragma once
/// The faces of a cloth as the user's file has them, and its groups.

#include <filesystem>
#include <string>
#include <vector>

#include "weft/io/mesh_from_file.h"
#include "weft/scene/scene_desc.h"

namespace weft::engine {

/// Reads a mesh file. Errors begin with `owner`, the body that it is of.
MeshFromFile read_mesh_of(const std::filesystem::path& file, const std::string& owner);

/// Polygons of the cloth's file; of a mesh in memory its triangles, of a grid its cells. Their vertices are
/// those of World::vertex_positions. Throws InputError, beginning with the name of the cloth, if the file cannot
/// be read.
MeshFaces read_faces(const ClothSceneDesc& desc);

/// The vertices of the faces of a group, ascending. Throws InputError, beginning with the name of the cloth, for
/// a name that its file has not.
std::vector<int> find_group(const ClothSceneDesc& desc, const std::string& name);

}  // namespace weft::engine
