#pragma once
/// Frames of earlier runs as starts of scenes.

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

#include "weft/scene/scene_start.h"

namespace weft::engine {

/// A frame of a run, as DIR@FRAME, DIR@last or DIR.
struct StartFrom {
  std::filesystem::path folder;
  std::optional<int> frame;  // empty: the last one
};

/// Throws InputError for a text of another form.
StartFrom parse_start_from(const std::string& text);

/// DIR@FRAME or DIR@last, with an absolute path.
std::string to_text(const StartFrom& from);

/// Positions from the point caches, and velocities from differences of positions. The velocity of frame k is
/// that of the parabola through the frames k − 2, k − 1 and k; of frame 0 through 0, 1 and 2. It differs
/// from the difference quotient of two frames by no more than the quotient itself: contact may have stopped the
/// cloth between two frames. Throws InputError if the folder has no such run, point cache or frame.
SceneStart read_start(const StartFrom& from);

std::uint64_t hash_of(const SceneStart& start);

}  // namespace weft::engine
