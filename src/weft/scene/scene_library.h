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

/// The folder with the shipped scenes: $WEFT_SCENES if set, else share/weft/scenes beside the running
/// program's folder, else the source tree that this library was built from. Throws InputError if none of them
/// exists.
std::filesystem::path scene_folder();

/// All of them, by name.
std::vector<ShippedScene> list_scenes();

/// A scene file from what a person typed: an existing file, or the name of a shipped scene. Throws InputError
/// naming the nearest shipped scene.
std::filesystem::path find_scene(const std::string& file_or_name);

}  // namespace weft::engine
