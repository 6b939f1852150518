#pragma once
/// The window of `weft view`, for other commands.

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "weft/scene/scene_reader.h"

namespace weft::engine::app {

struct ViewRequest {
  std::string scene;
  std::string size = "1280x720";
  std::vector<std::string> compare;  // integrators, none or two
  int threads = 0;                   // of each simulation; 0: the processors, but for one that draws
  std::int64_t frames = 0;           // pictures, then the window closes; 0: until somebody closes it
  std::filesystem::path report;
  Overrides overrides;
};

/// Shows a scene in a window until it is closed. Throws InputError, or GraphicsError where no window can be.
void view(const ViewRequest& request);

/// Whether somebody is there to see a window: a display, and a terminal as standard input.
bool has_spectator();

}  // namespace weft::engine::app
