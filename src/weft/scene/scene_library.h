#pragma once
/// The scenes that ship with Weft.

#include <filesystem>
#include <string>
#include <vector>

namespace weft::engine {

struct ShippedScene {
  std::string name;  // e.g. "paper/fig6_ball"
  std::filesystem::path file;
};

/// Folder of the shipped scenes: $WEFT_SCENES if set, else find_scene_folder() for the running library and
/// program. Throws InputError if there is none.
std::filesystem::path scene_folder();

/// `share/weft/scenes` in a folder above the library, else above the program, else `scenes` of the source
/// tree that they were built in. Empty if there is none.
std::filesystem::path find_scene_folder(const std::filesystem::path& library,
                                        const std::filesystem::path& program);

/// All shipped scenes, sorted by name.
std::vector<ShippedScene> list_scenes();

/// The scene file for a user's input: an existing file, or the name of a shipped scene. Throws InputError
/// with the nearest shipped scene.
std::filesystem::path find_scene(const std::string& file_or_name);

}  // namespace weft::engine
