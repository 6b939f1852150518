#pragma once
/// Scene files (TOML) in, with every mistake reported at its place.

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "weft/scene/diagnostic.h"
#include "weft/scene/scene_desc.h"

namespace weft::engine {

/// Replaces or adds values before the scene is judged: "path.to.key=value", with [n] for the n-th table of an
/// array, as in "solver.integrator=desbrun" or "cloth[0].fabric.density=0.3". The value is TOML; what is not
/// is a string.
using Overrides = std::vector<std::string>;

/// Reads and judges a scene file. Throws SceneError with every mistake, not only the first.
SceneDesc read_scene(const std::filesystem::path& file, const Overrides& overrides = {});

/// The same from text; `file` is used in messages, to name the scene, and to find mesh files beside it.
SceneDesc parse_scene(std::string_view text, const std::filesystem::path& file,
                      const Overrides& overrides = {});

/// Every key that read_scene() knows, as a page of Markdown: what it holds, its unit and its default, taken
/// from what the reader asks a file for.
std::string describe_scene_keys();

}  // namespace weft::engine
