#pragma once
/// The meshes of scene garments/walk: a skinned figure that walks, as glTF, and a skirt and a shirt for it.

#include <filesystem>

namespace weft::engine::wardrobe {

/// Writes figure.glb, with the clip "walk" of 5 s, walk_skirt.obj, with the group "waist", and walk_shirt.obj.
/// Throws InputError if a file cannot be written.
void write_walk(const std::filesystem::path& folder);

}  // namespace weft::engine::wardrobe
