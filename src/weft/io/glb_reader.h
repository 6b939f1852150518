#pragma once
/// Animations back in: reads the .glb files that write_glb writes.

#include <filesystem>
#include <span>
#include <string>

#include "weft/io/animation.h"

namespace weft::engine {

/// The animation in the file: cloths with a position per frame, bodies with their poses and exact shapes.
/// Numbers come back as they were written: positions and moving poses as floats, shapes and resting poses as
/// doubles. A cloth's later frames are stored as differences from the first, so that their last bits may be
/// lost: a coordinate that moved by d is off by at most half the last place of d (3e-8 m for a metre).
///
/// Throws InputError, naming the file, if it cannot be read, is damaged, or was not written by Weft.
Animation read_glb(const std::filesystem::path& file);

/// The same from the file's bytes; `name` stands for the file in messages. Never reads another file.
Animation parse_glb(std::span<const unsigned char> bytes, const std::string& name);

}  // namespace weft::engine
