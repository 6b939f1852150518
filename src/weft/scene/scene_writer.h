#pragma once
/// Writer for scene files (TOML) from SceneDesc.

#include <filesystem>
#include <string>
#include <vector>

#include "weft/scene/diagnostic.h"
#include "weft/scene/scene_desc.h"

namespace weft::engine {

/// Writes a scene that read_scene() reads back equal. Mesh file names are relative to the scene file's
/// folder; meshes in memory are written beside it as OBJ. Throws InputError for a file that cannot be
/// written, and for a motion or a sequence that a scene file cannot express.
void write_scene(const std::filesystem::path& file, const SceneDesc& scene);

/// Validates a scene that a program built. The messages are the reader's for the same scene in a file. Each
/// begins with section and key, as in "cloth[0].scale: expected …". Empty: the scene is valid.
std::vector<std::string> check_scene(const SceneDesc& scene);

}  // namespace weft::engine
