#pragma once
/// Writer for scene files (TOML) from SceneDesc.

#include <filesystem>
#include <string>
#include <vector>

#include "weft/scene.h"
#include "weft/scene/scene_desc.h"

namespace weft::engine {

/// Writes a scene that read_scene() reads back equal. Mesh file names are relative to the scene file's
/// folder; meshes in memory are written beside it as OBJ. Throws InputError for a file that cannot be
/// written, and for a motion or a sequence that a scene file cannot express.
void write_scene(const std::filesystem::path& file, const SceneDesc& scene);

/// The text of a scene file, for comparisons: with a hash of the contents in place of the name of each mesh
/// file, and of each mesh in memory. Throws InputError for a file that cannot be read, and like write_scene().
std::string scene_text_with_hashes(const SceneDesc& scene);

/// Validates a scene that a program built. The messages are the reader's for the same scene in a file. Each
/// begins with section and key, as in "cloth[0].scale: expected …". Empty: the scene is valid.
std::vector<std::string> check_scene(const SceneDesc& scene);

}  // namespace weft::engine
