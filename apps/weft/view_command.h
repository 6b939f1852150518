#pragma once
/// The window of `weft view`, for other commands.

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "weft/scene/scene_reader.h"

namespace weft::engine::app {

struct ViewRequest {
  std::string scene;  // or the folder of a run, or its .glb; empty: the gallery
  std::string size = "1280x720";
  std::vector<std::string> compare;  // integrators or fabrics, none or two
  int threads = 0;                   // of each simulation; 0: the processors, except one for drawing
  std::int64_t frames = 0;           // pictures until the window closes; 0: until the user closes it
  std::filesystem::path report;
  Overrides overrides;
};

/// Shows a scene or a run in a window until it is closed. Throws InputError, or GraphicsError without graphics.
void view(const ViewRequest& request);

/// Whether a user can see a window: a display, and a terminal as standard input.
bool has_spectator();

}  // namespace weft::engine::app
