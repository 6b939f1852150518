#pragma once
/// Garments and a figure that moves, as OBJ files with scenes that bring them together: what people bring.

#include <filesystem>
#include <string>
#include <vector>

namespace weft::engine::wardrobe {

/// "stand", "walk", "kick", "fold", "sit".
std::vector<std::string> motion_names();

/// Writes meshes and a scene GARMENT_MOTION.toml of 60 frames for every garment and motion into the folder,
/// without any setting that is not needed to name the files. `cell` is the garments' mean edge [m]. Returns
/// the scenes' names in order. Throws InputError if a file cannot be written.
std::vector<std::string> write_wardrobe(const std::filesystem::path& folder, double cell);

}  // namespace weft::engine::wardrobe
