#pragma once
/// The meshes of scenes garments/walk and garments/sewn_dress: a skinned figure that walks, as glTF, a skirt, a shirt and
/// the panels of a dress for it.

#include <filesystem>
#include <string>

namespace weft::engine::wardrobe {

/// Writes figure.glb, with the clip "walk" of 5 s, walk_skirt.obj, with the group "waist", walk_shirt.obj and
/// dress_pattern.obj. Returns the seams of that one as in a scene. Throws InputError if a file cannot be written.
std::string write_walk(const std::filesystem::path& folder);

}  // namespace weft::engine::wardrobe
