#pragma once
/// Typical user input: garments and a moving figure as OBJ files, with scenes that combine them.

#include <filesystem>
#include <string>
#include <vector>

namespace weft::engine::wardrobe {

/// "stand", "walk", "kick", "fold", "sit".
std::vector<std::string> motion_names();

/// Writes meshes, and for every garment and motion a scene GARMENT_MOTION.toml of 60 frames, to the folder.
/// The scenes have default settings, except for the files. `cell` is the garments' mean edge [m]. Returns the
/// scenes' names in order. Throws InputError if a file cannot be written.
std::vector<std::string> write_wardrobe(const std::filesystem::path& folder, double cell);

}  // namespace weft::engine::wardrobe
