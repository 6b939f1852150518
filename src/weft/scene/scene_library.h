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

/// The folder with the shipped scenes: $WEFT_SCENES if set, else find_scene_folder() from the library and the
/// program that run. Throws InputError if there is none.
std::filesystem::path scene_folder();

/// `share/weft/scenes` in a folder above the library, or else above the program; or else `scenes` of the
/// source tree that they were built in. Empty if there is none.
std::filesystem::path find_scene_folder(const std::filesystem::path& library,
                                        const std::filesystem::path& program);

/// All of them, by name.
std::vector<ShippedScene> list_scenes();

/// A scene file from what a person typed: an existing file, or the name of a shipped scene. Throws InputError
/// naming the nearest shipped scene.
std::filesystem::path find_scene(const std::string& file_or_name);

}  // namespace weft::engine
