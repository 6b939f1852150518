#pragma once
/// Scenes out: SceneDesc as a scene file (TOML).

#include <filesystem>
#include <string>
#include <vector>

#include "weft/scene/diagnostic.h"
#include "weft/scene/scene_desc.h"

namespace weft::engine {

/// Writes a scene that read_scene() reads back equal. Mesh files are named relative to the scene file's folder;
/// meshes in memory are written beside it as OBJ. Throws InputError for a file that cannot be written, and for
/// a motion or a sequence that a scene file cannot express.
void write_scene(const std::filesystem::path& file, const SceneDesc& scene);

/// Mistakes of a scene that a program has made: the sentences that the reader has for the same scene in a file,
/// each beginning with section and key, as in "cloth[0].scale: expected …". Empty: read_scene() would accept it.
std::vector<std::string> check_scene(const SceneDesc& scene);

}  // namespace weft::engine
