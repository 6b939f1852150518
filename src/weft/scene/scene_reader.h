#pragma once
/// Reader for scene files (TOML): reports every mistake with line and column.

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "weft/scene.h"
#include "weft/scene/scene_desc.h"

namespace weft::engine {

/// Replaces or adds values before validation: "path.to.key=value", with [n] for the n-th table of an array,
/// as in "solver.integrator=desbrun" or "cloth[0].fabric.density=0.3". A value that is not TOML is a string.
using Overrides = std::vector<std::string>;

/// Reads and validates a scene file. Throws SceneError with every mistake, not only the first.
SceneDesc read_scene(const std::filesystem::path& file, const Overrides& overrides = {});

/// The same from text. `file` is used in messages, names the scene, and gives the folder of mesh files.
SceneDesc parse_scene(std::string_view text, const std::filesystem::path& file,
                      const Overrides& overrides = {});

/// Contents of a scene file. Throws SceneError if it cannot be read.
std::string read_scene_text(const std::filesystem::path& file);

/// Reference of all keys that read_scene() reads, as Markdown: the table of weft/parameters.h.
std::string describe_scene_keys();

}  // namespace weft::engine
