#pragma once
/// Reader for animations: the .glb files that write_glb writes.

#include <filesystem>
#include <span>
#include <string>

#include "weft/io/animation.h"

namespace weft::engine {

/// The animation in the file: cloths with a position per frame, bodies with their poses and exact shapes.
/// Numbers keep their precision: positions and moving poses are floats, shapes and resting poses doubles. A
/// cloth's later frames are stored as differences from the first, so that their last bits may be lost. A
/// coordinate that moved by d has an error of at most half the last place of d (3e-8 m for a metre).
///
/// Throws InputError, naming the file, if it cannot be read, is damaged, or was not written by Weft.
Animation read_glb(const std::filesystem::path& file);

/// The same from the file's bytes; `name` is the file name in messages. Never reads another file.
Animation parse_glb(std::span<const unsigned char> bytes, const std::string& name);

}  // namespace weft::engine
